# SPDX-License-Identifier: MIT
"""The common part of the page's tests: a browser, a server, and the page between them."""

import base64
import os
import time

from chromium import Chromium
from firefox import Firefox
from server import Server

VIEW = ("const e = document.getElementById('view'), v = await e.ready;"
        "const s = (t) => new Promise(d => setTimeout(d, t));")


class Harness:
    def __init__(self, browser, page, out, programs, camera):
        self.out, self.programs, self.camera = out, programs, camera
        os.makedirs(out + "/served", exist_ok=True)
        self.page = page
        self.server = Server(page, test_folder=out + "/served").begin()
        self.browser = {"chromium": Chromium, "firefox": Firefox}[browser]((800, 600))
        self.failed = 0
        self.coarse()

    def serve(self, name, data):
        """Puts a file below /test/."""
        with open(f"{self.out}/served/{name}", "wb") as file:
            file.write(data)

    def coarse(self):
        """Fewer pixels in Chromium: SwiftShader takes up to a second for a frame on two busy cores."""
        if self.browser.name == "chromium":
            self.browser.resize(800, 600, 0.4)

    def check(self, what, passed, detail=""):
        self.failed += not passed
        print(f"  {'ok  ' if passed else 'FAIL'} {what}{': ' + str(detail) if detail != '' else ''}",
              flush=True)

    def run(self, body):
        return self.browser.run(VIEW + body)

    def open(self, link=""):
        self.browser.open(self.server.address + (f"#{link}" if link else ""))
        self.until("return document.readyState === 'complete'")

    def until(self, body, seconds=60):
        """Runs it until it is true. What it was last."""
        end = time.monotonic() + seconds
        while True:
            try:
                value = self.browser.run(body)
            except RuntimeError:  # the page is being exchanged
                value = None
            if value or time.monotonic() > end:
                return value
            time.sleep(0.2)

    def wait_open(self):
        return self.until("return Boolean(document.getElementById('view')?.view?.description)")

    def wait_fine(self):
        """Without a clip, as fine as it gets."""
        self.wait_open()
        return self.run("v.play(null); const n = v.frames;"
                        "for (let i = 0; i < 1200 && !(v.isFine && v.frames > n + 2); ++i) {"
                        "v.invalidate(); await s(50); } return v.isFine")

    def words(self):
        return self.browser.run("return "
                                "document.getElementById('view').shadowRoot.querySelector('p').textContent")

    def wait_words(self, *any_of):
        self.until("const w = document.getElementById('view')?.shadowRoot?.querySelector('p').textContent "
                   "?? '';"
                   f"return {list(any_of)!r}.some(x => w.includes(x))", 30)
        return self.words()

    def pixels(self):
        return base64.b64decode(self.run(
            "const {bytes} = v.pixels(); let t = '';"
            "for (let i = 0; i < bytes.length; i += 8192) t += String.fromCharCode(...bytes.subarray(i, i "
            "+ 8192));"
            "return btoa(t)"))

    def moved(self, before, after):
        """The share of the covered pixels that one picture covers and the other does not."""
        a, b = before[3::4], after[3::4]
        return sum((x > 127) != (y > 127) for x, y in zip(a, b)) / max(sum(x > 127 for x in a), 1)

    def shot(self, name):
        self.browser.screenshot(f"{self.out}/{self.browser.name}_{name}.png")

    def drop(self, address, name):
        self.run(f"const d = new DataTransfer(); d.items.add(new File([await (await "
                 f"fetch('{address}')).blob()], "
                 f"'{name}')); dispatchEvent(new DragEvent('drop', {{dataTransfer: d, cancelable: true}}))")
