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
    "dom.min_background_timeout_value": 4, "dom.w3c_touch_events.enabled": 1,
    "ui.prefersReducedMotion": 0, "layout.css.devPixelsPerPx": "1.0",
}

KEYS = {"ArrowLeft": "\ue012", "ArrowUp": "\ue013", "ArrowRight": "\ue014", "ArrowDown": "\ue015",
        "Tab": "\ue004", "Enter": "\ue007"}
THEME = "layout.css.prefers-color-scheme.content-override"


def free_port():
    with socket.socket() as probe:
        probe.bind(("127.0.0.1", 0))
        return probe.getsockname()[1]


class Firefox:
    name = "firefox"

    def __init__(self, size=(960, 640)):
        self.size = size
        self.profile, port = tempfile.mkdtemp(prefix="kelp_firefox_"), free_port()
        with open(self.profile + "/user.js", "w", encoding="ascii") as file:
            for key, value in {**PREFERENCES, "marionette.port": port}.items():
                file.write(f"user_pref({json.dumps(key)}, {json.dumps(value)});\n")
        self.process = subprocess.Popen(
            ["xvfb-run", "-a", "-s", "-screen 0 1280x1024x24", shutil.which("firefox-esr"), "--marionette",
             "--remote-allow-system-access", "--no-remote", "--profile", self.profile],
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
        steps = [self._move(points[0]), *([{"type": "pointerDown", "button": 0}] if pressed else []),
                 *map(self._move, points[1:]), *([{"type": "pointerUp", "button": 0}] if pressed
                                                 and not hold else [])]
        self._act({"type": "pointer", "id": "mouse", "parameters": {"pointerType": "mouse"},
                   "actions": steps})

    def release(self, x, y):
        self._act({"type": "pointer", "id": "mouse", "parameters": {"pointerType": "mouse"},
                   "actions": [{"type": "pointerUp", "button": 0}]})

    def key(self, key, shift=False):
        keys = ["\ue008"] * shift + [KEYS.get(key, key)]
        self._act({"type": "key", "id": "keys", "actions": [
            *({"type": "keyDown", "value": key} for key in keys),
            *({"type": "keyUp", "value": key} for key in reversed(keys))]})

    def touch(self, *paths, hold=False):
        """One finger along each path, all at once."""
        def steps(path):
            return [self._move(path[0]), {"type": "pointerDown", "button": 0}, *map(self._move, path[1:]),
                    *([] if hold else [{"type": "pointerUp", "button": 0}])]
        self._act(*({"type": "pointer", "id": f"finger {i}", "parameters": {"pointerType": "touch"},
                     "actions": steps(path)} for i, path in enumerate(paths)))

    def lift(self):
        self.call("WebDriver:ReleaseActions")

    @staticmethod
    def _move(point):
        return {"type": "pointerMove", "x": round(point[0]), "y": round(point[1]), "duration": 20}

    def _act(self, *actions):
        self.call("WebDriver:PerformActions", actions=list(actions))

    def _in_window(self, script, *words):
        """Runs it in the browser's window, around the page."""
        self.call("Marionette:SetContext", value="chrome")
        try:
            self.call("WebDriver:ExecuteScript", script=script, args=list(words))
        finally:
            self.call("Marionette:SetContext", value="content")

    def phone(self, theme):
        """A page of 390 x 844 pixels, dark or light."""
        self.call("WebDriver:SetWindowRect", width=1000, height=1000)
        self._in_window("Services.prefs.setIntPref(arguments[0], arguments[1]);"
                        "Object.assign(gBrowser.selectedBrowser.style, {flex: 'none', width: '390px', "
                        "height: '844px'})", THEME, ("dark", "light").index(theme))

    def desktop(self):
        self._in_window("Services.prefs.clearUserPref(arguments[0]);"
                        "gBrowser.selectedBrowser.removeAttribute('style')", THEME)
        self.call("WebDriver:SetWindowRect", width=self.size[0], height=self.size[1])

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
