# SPDX-License-Identifier: MIT
"""Drives Chromium by the DevTools protocol, over a pipe: JavaScript in a page, mouse, keys, screenshots."""

import base64
import json
import os
import select
import shutil
import subprocess
import tempfile
import time

FLAGS = ["--headless=new", "--no-sandbox", "--disable-gpu-sandbox", "--use-angle=swiftshader",
         "--enable-unsafe-swiftshader", "--disable-dev-shm-usage", "--no-first-run", "--hide-scrollbars",
         "--enable-precise-memory-info", "--js-flags=--expose-gc", "--remote-debugging-pipe"]

CODES = {"Tab": 9, "Enter": 13, "ArrowLeft": 37, "ArrowUp": 38, "ArrowRight": 39, "ArrowDown": 40}


class Chromium:
    name = "chromium"

    def __init__(self, size=(960, 640), flags=(), program=None):
        self.size = size
        self.profile = tempfile.mkdtemp(prefix="kelp_chromium_")
        to_browser, self.to = os.pipe()
        self.back, from_browser = os.pipe()
        words = [program or shutil.which("chromium"), *FLAGS, *flags, f"--user-data-dir={self.profile}",
                 f"--window-size={size[0]},{size[1]}", "about:blank"]
        # Chromium reads from descriptor 3 and writes to 4.
        self.process = subprocess.Popen(
            ["sh", "-c", f'exec "$@" 3<&{to_browser} 4>&{from_browser}', "sh", *words],
            stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, pass_fds=(to_browser, from_browser))
        os.close(to_browser)
        os.close(from_browser)
        self.received, self.number, self.session, self.events = b"", 0, None, []
        target = self.call("Target.createTarget", url="about:blank")["targetId"]
        self.session = self.call("Target.attachToTarget", targetId=target, flatten=True)["sessionId"]
        for domain in ("Page", "Runtime", "DOM", "Log"):
            self.call(domain + ".enable")
        self.resize(*size)

    def _receive(self, timeout):
        end = time.monotonic() + timeout
        while b"\0" not in self.received:
            if not select.select([self.back], [], [], max(end - time.monotonic(), 0))[0]:
                raise RuntimeError("Chromium does not answer")
            piece = os.read(self.back, 1 << 20)
            if not piece:
                raise RuntimeError("Chromium ended")
            self.received += piece
        message, self.received = self.received.split(b"\0", 1)
        return json.loads(message)

    def call(self, method, timeout=300, **parameters):
        self.number += 1
        message = {"id": self.number, "method": method, "params": parameters}
        if self.session:
            message["sessionId"] = self.session
        data = json.dumps(message).encode() + b"\0"
        while data:
            data = data[os.write(self.to, data):]
        end = time.monotonic() + timeout
        while True:
            answer = self._receive(max(end - time.monotonic(), 0))
            if answer.get("id") == self.number:
                if "error" in answer:
                    raise RuntimeError(f"{method}: {answer['error']['message']}")
                return answer["result"]
            if answer.get("method") in ("Runtime.exceptionThrown", "Log.entryAdded",
                                        "Runtime.consoleAPICalled"):
                self.events.append(answer)

    def resize(self, width, height, scale=1.0, mobile=False):
        """scale: pixels to a CSS pixel."""
        self.call("Emulation.setDeviceMetricsOverride", width=width, height=height, deviceScaleFactor=scale,
                  mobile=mobile)

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
            self.call("Input.dispatchMouseEvent", type="mouseMoved", x=x, y=y, button="left"
                      if pressed else "none",
                      buttons=1 if pressed else 0)
        if pressed and not hold:
            self.release(x, y)

    def release(self, x, y):
        self.call("Input.dispatchMouseEvent", type="mouseReleased", x=x, y=y, button="left", clickCount=1)

    def key(self, key, shift=False):
        text = {"Enter": "\r"}.get(key, key if len(key) == 1 else "")
        for kind in ("keyDown", "keyUp"):
            self.call("Input.dispatchKeyEvent", type=kind, key=key, modifiers=8 * shift,
                      windowsVirtualKeyCode=CODES.get(key, 0), **({"text": text} if text and kind == "keyDown"
                                                                  else {}))

    def touch(self, *paths, hold=False):
        """One finger along each path, all at once."""
        for i, places in enumerate(zip(*paths)):
            self.call("Input.dispatchTouchEvent", type="touchMove" if i else "touchStart",
                      touchPoints=[{"x": x, "y": y, "id": finger} for finger, (x, y) in enumerate(places)])
        if not hold:
            self.lift()

    def lift(self):
        self.call("Input.dispatchTouchEvent", type="touchEnd", touchPoints=[])

    def phone(self, theme):
        """A page of 390 x 844 pixels, dark or light."""
        self.resize(390, 844, 1, mobile=True)
        self.call("Emulation.setTouchEmulationEnabled", enabled=True, maxTouchPoints=2)
        self.call("Emulation.setEmulatedMedia", features=[{"name": "prefers-color-scheme", "value": theme}])

    def desktop(self):
        self.call("Emulation.setTouchEmulationEnabled", enabled=False)
        self.call("Emulation.setEmulatedMedia", features=[])
        self.resize(*self.size)

    def files(self, selector, paths):
        root = self.call("DOM.getDocument")["root"]["nodeId"]
        node = self.call("DOM.querySelector", nodeId=root, selector=selector)["nodeId"]
        self.call("DOM.setFileInputFiles", nodeId=node, files=paths)

    def close(self):
        self.process.terminate()
        self.process.wait(20)
        shutil.rmtree(self.profile, ignore_errors=True)
