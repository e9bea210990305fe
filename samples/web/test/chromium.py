# SPDX-License-Identifier: MIT
"""Drives Chromium by the DevTools protocol: one page, JavaScript in it, mouse, touch, keys, screenshots."""

import base64
import json
import shutil
import subprocess
import tempfile
import time

from websockets.sync.client import connect

FLAGS = ["--headless=new", "--no-sandbox", "--disable-gpu-sandbox", "--use-angle=swiftshader",
         "--enable-unsafe-swiftshader", "--disable-dev-shm-usage", "--no-first-run", "--hide-scrollbars",
         "--enable-precise-memory-info", "--js-flags=--expose-gc", "--remote-debugging-port=0"]


class Chromium:
    name = "chromium"

    def __init__(self, size=(960, 640), flags=(), program=None):
        self.profile = tempfile.mkdtemp(prefix="kelp_chromium_")
        self.process = subprocess.Popen(
            [program or shutil.which("chromium"), *FLAGS, *flags, f"--user-data-dir={self.profile}",
             f"--window-size={size[0]},{size[1]}", "about:blank"],
            stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        self.socket, self.number, self.events = connect(self._target(), max_size=1 << 28), 0, []
        for domain in ("Page", "Runtime", "DOM", "Log"):
            self.call(domain + ".enable")

    def _target(self):
        import urllib.request
        end = time.monotonic() + 60
        while time.monotonic() < end:
            try:
                with open(self.profile + "/DevToolsActivePort", encoding="ascii") as file:
                    port = file.readline().strip()
                with urllib.request.urlopen(f"http://127.0.0.1:{port}/json") as answer:
                    pages = [t for t in json.load(answer) if t["type"] == "page"]
                if pages:
                    return pages[0]["webSocketDebuggerUrl"]
            except (OSError, ValueError):
                pass
            time.sleep(0.1)
        raise RuntimeError("Chromium did not start")

    def call(self, method, timeout=300, **parameters):
        self.number += 1
        self.socket.send(json.dumps({"id": self.number, "method": method, "params": parameters}))
        end = time.monotonic() + timeout
        while True:
            message = json.loads(self.socket.recv(timeout=max(end - time.monotonic(), 0.1)))
            if message.get("id") == self.number:
                if "error" in message:
                    raise RuntimeError(f"{method}: {message['error']['message']}")
                return message["result"]
            if message.get("method") in ("Runtime.exceptionThrown", "Log.entryAdded", "Runtime.consoleAPICalled"):
                self.events.append(message)

    def open(self, address):
        self.call("Page.navigate", url="about:blank")
        self.call("Page.navigate", url=address)

    def run(self, body):
        """The value of a body of an async function, in the page."""
        answer = self.call("Runtime.evaluate", expression=f"(async () => {{ {body} }})()",
                           awaitPromise=True, returnByValue=True, userGesture=True)
        if "exceptionDetails" in answer:
            details = answer["exceptionDetails"]
            raise RuntimeError(details.get("exception", {}).get("description", details["text"]))
        return answer["result"].get("value")

    def screenshot(self, path):
        picture = self.call("Page.captureScreenshot", format="png")
        with open(path, "wb") as file:
            file.write(base64.b64decode(picture["data"]))

    def mouse(self, points, pressed=True, hold=False):
        """Moves along the points, in CSS pixels of the page; pressed from the first to the last."""
        (x, y), rest = points[0], points[1:]
        self.call("Input.dispatchMouseEvent", type="mouseMoved", x=x, y=y)
        if pressed:
            self.call("Input.dispatchMouseEvent", type="mousePressed", x=x, y=y, button="left", clickCount=1)
        for x, y in rest:
            self.call("Input.dispatchMouseEvent", type="mouseMoved", x=x, y=y, button="left" if pressed else "none",
                      buttons=1 if pressed else 0)
        if pressed and not hold:
            self.release(x, y)

    def release(self, x, y):
        self.call("Input.dispatchMouseEvent", type="mouseReleased", x=x, y=y, button="left", clickCount=1)

    def key(self, key):
        for kind in ("keyDown", "keyUp"):
            self.call("Input.dispatchKeyEvent", type=kind, key=key,
                      **({"text": key} if len(key) == 1 and kind == "keyDown" else {}))

    def files(self, selector, paths):
        root = self.call("DOM.getDocument")["root"]["nodeId"]
        node = self.call("DOM.querySelector", nodeId=root, selector=selector)["nodeId"]
        self.call("DOM.setFileInputFiles", nodeId=node, files=paths)

    def close(self):
        self.process.terminate()
        self.process.wait(20)
        shutil.rmtree(self.profile, ignore_errors=True)
