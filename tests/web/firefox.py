# SPDX-License-Identifier: MIT
"""Drives Firefox by Marionette, on an X server without a screen: JavaScript, mouse, keys, screenshots."""

import base64
import json
import os
import shutil
import socket
import subprocess
import tempfile
import time

PREFERENCES = {
    "webgl.force-enabled": True, "webgl.disabled": False, "gfx.webrender.software": True,
    "datareporting.policy.dataSubmissionEnabled": False, "app.update.enabled": False,
    "browser.shell.checkDefaultBrowser": False, "toolkit.telemetry.enabled": False,
    "network.captive-portal-service.enabled": False, "network.connectivity-service.enabled": False,
    "dom.min_background_timeout_value": 4, "ui.prefersReducedMotion": 0, "layout.css.devPixelsPerPx": "1.0",
}


def free_port():
    with socket.socket() as probe:
        probe.bind(("127.0.0.1", 0))
        return probe.getsockname()[1]


class Firefox:
    name = "firefox"

    def __init__(self, size=(960, 640)):
        self.profile, port = tempfile.mkdtemp(prefix="kelp_firefox_"), free_port()
        with open(self.profile + "/user.js", "w", encoding="ascii") as file:
            for key, value in {**PREFERENCES, "marionette.port": port}.items():
                file.write(f"user_pref({json.dumps(key)}, {json.dumps(value)});\n")
        self.process = subprocess.Popen(
            ["xvfb-run", "-a", "-s", "-screen 0 1280x1024x24", shutil.which("firefox-esr"), "--marionette",
             "--no-remote", "--profile", self.profile],
            stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, start_new_session=True)
        self.socket, self.number, self.received, self.events = self._connect(port), 0, b"", []
        self._message()  # says who it is
        self.call("WebDriver:NewSession", capabilities={"alwaysMatch": {}})
        self.call("WebDriver:SetTimeouts", script=300000, pageLoad=60000)
        self.call("WebDriver:SetWindowRect", width=size[0], height=size[1])

    def _connect(self, port):
        end = time.monotonic() + 90
        while time.monotonic() < end:
            try:
                return socket.create_connection(("127.0.0.1", port), timeout=310)
            except OSError:
                time.sleep(0.2)
        raise RuntimeError("Firefox did not start")

    def _message(self):
        while b":" not in self.received:
            self._more()
        length, self.received = self.received.split(b":", 1)
        while len(self.received) < int(length):
            self._more()
        message, self.received = self.received[:int(length)], self.received[int(length):]
        return json.loads(message)

    def _more(self):
        piece = self.socket.recv(1 << 20)
        if not piece:
            raise RuntimeError("Firefox ended")
        self.received += piece

    def call(self, command, **parameters):
        self.number += 1
        data = json.dumps([0, self.number, command, parameters]).encode()
        self.socket.sendall(str(len(data)).encode() + b":" + data)
        while True:
            _, number, error, result = self._message()
            if number == self.number:
                if error:
                    raise RuntimeError(f"{command}: {error['message']}")
                return result

    def open(self, address):
        self.call("WebDriver:Navigate", url="about:blank")
        self.call("WebDriver:Navigate", url=address)

    def run(self, body):
        """The value of a body of an async function, in the page."""
        script = ("const done = arguments[0]; (async () => {" + body + "})()"
                  ".then(v => done({value: v}), e => done({error: String(e) + e.stack}));")
        answer = self.call("WebDriver:ExecuteAsyncScript", script=script, args=[], newSandbox=False,
                           sandbox=None)["value"]
        if "error" in answer:
            raise RuntimeError(answer["error"])
        return answer.get("value")

    def screenshot(self, path):
        picture = self.call("WebDriver:TakeScreenshot", full=False)["value"]
        with open(path, "wb") as file:
            file.write(base64.b64decode(picture))

    def mouse(self, points, pressed=True, hold=False):
        """Moves along the points, in CSS pixels of the page; pressed from the first to the last."""
        def move(point):
            return {"type": "pointerMove", "x": round(point[0]), "y": round(point[1]), "duration": 20}
        steps = [move(points[0]), *([{"type": "pointerDown", "button": 0}] if pressed else []),
                 *map(move, points[1:]), *([{"type": "pointerUp", "button": 0}] if pressed
                                           and not hold else [])]
        self._act({"type": "pointer", "id": "mouse", "parameters": {"pointerType": "mouse"},
                   "actions": steps})

    def release(self, x, y):
        self._act({"type": "pointer", "id": "mouse", "parameters": {"pointerType": "mouse"},
                   "actions": [{"type": "pointerUp", "button": 0}]})

    def key(self, key):
        key = {"ArrowLeft": "\ue012", "ArrowRight": "\ue014", "ArrowUp": "\ue013"}.get(key, key)
        self._act({"type": "key", "id": "keys",
                   "actions": [{"type": "keyDown", "value": key}, {"type": "keyUp", "value": key}]})

    def _act(self, action):
        self.call("WebDriver:PerformActions", actions=[action])

    def close(self):
        try:
            self.call("Marionette:Quit", flags=["eForceQuit"])
        except (OSError, RuntimeError):
            pass
        try:
            self.process.wait(20)
        except subprocess.TimeoutExpired:
            os.killpg(self.process.pid, 15)
        shutil.rmtree(self.profile, ignore_errors=True)
