# SPDX-License-Identifier: MIT
"""The page without a mouse: by keyboard, by touch, at phone size, in dark and light."""

import time

FOCUS = ["view", "model", "file", "clip", "knot", "x", "y", "z", "breeze", "reset", "link", "save"]


class Hands:
    def camera_now(self):
        return self.run("return {...v.camera, playing: v.playing, clip: v.clip}")

    def keys(self):
        self.open()
        self.wait_fine()
        found = []
        while len(found) < 2 * len(FOCUS) and (not found or found[-1][0] != FOCUS[-1]):
            self.browser.key("Tab")
            found.append(self.run("const a = document.activeElement, i = a.shadowRoot?.activeElement ?? a;"
                                  "const o = getComputedStyle(i.closest('.button') ?? i);"
                                  "return [a.id, o.outlineStyle !== 'none' && "
                                  "parseFloat(o.outlineWidth) > 0]"))
        self.check("the Tab key goes through all of the page",
                   # Firefox stops at the panel, too, where it scrolls
                   [name for name, _ in found if name != "panel"] == FOCUS, found)
        self.check("and one sees where it is", all(seen for _, seen in found), found)
        self.keys_of_canvas()
        self.keys_of_panel()

    def keys_of_canvas(self):
        front = "v.camera = {yaw: 30, pitch: 15, zoom: 1, pan: [0, 0]};"
        for key, shift, yaw, pitch, zoom, pan in (
                ("ArrowLeft", False, -10, 0, 1, (0, 0)), ("ArrowRight", False, 10, 0, 1, (0, 0)),
                ("ArrowUp", False, 0, 10, 1, (0, 0)), ("ArrowDown", False, 0, -10, 1, (0, 0)),
                ("ArrowLeft", True, 0, 0, 1, (-1, 0)), ("ArrowRight", True, 0, 0, 1, (1, 0)),
                ("ArrowUp", True, 0, 0, 1, (0, 1)), ("ArrowDown", True, 0, 0, 1, (0, -1)),
                ("+", False, 0, 0, 1.2, (0, 0)), ("-", False, 0, 0, 1 / 1.2, (0, 0))):
            self.run("v.canvas.focus();" + front)
            self.browser.key(key, shift)
            now = self.camera_now()
            good = (abs(now["yaw"] - 30 - yaw) < 1e-3 and abs(now["pitch"] - 15 - pitch) < 1e-3 and
                    abs(now["zoom"] - zoom) < 1e-3 and
                    all((a > 0.005) - (a < -0.005) == b for a, b in zip(now["pan"], pan)))
            self.check(f"{'Shift and ' if shift else ''}{key} moves the camera as README.md says", good, now)
        self.browser.key("0")
        now = self.camera_now()
        self.check("0 looks from the front again", now["yaw"] == 30 and now["zoom"] == 1 and
                   now["pan"] == [0, 0], now)
        states = []
        for _ in range(3):
            self.browser.key(" ")
            time.sleep(0.2)
            states.append(self.camera_now()["playing"])
        self.check("space plays, pauses and plays", states == [True, False, True], states)
        self.run("v.play(null)")
        self.wait_fine()
        rest, most = self.pixels(), 0
        self.browser.key("b")
        for _ in range(10):
            time.sleep(0.1)
            most = max(most, self.moved(rest, self.pixels()))
        self.check("b is a breeze", most > 0.02, f"{most:.3f}")
        taken = self.run("return ['+', 'ArrowLeft', '0'].map(key => !v.canvas.dispatchEvent("
                         "new KeyboardEvent('keydown', {key, ctrlKey: true, cancelable: true})))")
        self.check("the browser's own keys are left to it", taken == [False] * 3, taken)

    def keys_of_panel(self):
        self.run("v.canvas.focus(); v.pose(null); document.getElementById('x').focus()")
        for _ in range(20):
            self.browser.key("ArrowRight")
        pose = self.run("return v.pose()")
        self.check("arrows move a slider, and the tangent", len(pose) == 1 and
                   abs(pose[0]["tangent"][0] - 0.2) < 0.011, pose)
        self.run("document.getElementById('reset').focus()")
        self.browser.key("Enter")
        self.check("Enter presses a button", self.run("return v.pose().length") == 0)
        self.run("document.getElementById('clip').focus()")
        self.browser.key("ArrowDown")
        self.browser.key("Enter")
        time.sleep(0.3)
        self.check("arrows choose a clip", self.camera_now()["clip"] == "sway", self.camera_now())
        self.run("v.play(null)")

    def phone(self):
        """Sizes, themes and touch."""
        for theme in ("dark", "light"):
            self.browser.phone(theme)
            self.open()
            self.check(f"at phone size, {theme}", self.wait_fine(), self.run("return v.sizes()"))
            self.shot("phone_" + theme)
            ground = self.run("return getComputedStyle(document.body).backgroundColor")
            levels = [int(word) for word in ground.strip("rgba()").split(",")[:3]]
            self.check("  the page follows", max(levels) < 64 if theme == "dark" else min(levels) > 192,
                       ground)
        sizes = self.run("const b = v.canvas.getBoundingClientRect(); return [innerWidth, "
                         "document.documentElement.scrollWidth, b.width, b.height / innerHeight]")
        self.check("nothing is wider than the screen", sizes[:3] == [390] * 3 and sizes[3] > 0.45, sizes)
        small = self.run("return [...document.querySelectorAll('button, select, .button, input[type=range]')]"
                         ".filter(x => x.offsetParent).map(x => x.closest('label') ?? x)"
                         ".map(x => [x.textContent.trim().slice(0, 9), x.getBoundingClientRect()])"
                         ".filter(([, r]) => r.height < 40 || r.left < 0 || r.right > innerWidth)")
        self.check("what one touches is large enough", small == [], small)
        self.touch()
        self.browser.desktop()
        self.coarse()

    def touch(self):
        rest = self.pixels()
        x, y, width, height = self.run("const b = v.canvas.getBoundingClientRect();"
                                       "window.kinds = []; v.canvas.addEventListener('pointerdown', "
                                       "(e) => kinds.push(e.pointerType));"
                                       "return [b.x, b.y, b.width, b.height]")
        on_model = (x + width / 2, y + height * 0.7)
        self.browser.touch([(on_model[0] + 8 * i, on_model[1]) for i in range(11)], hold=True)
        time.sleep(1)
        bent = self.moved(rest, self.pixels())
        self.shot("touched")
        self.browser.lift()
        self.check("it bends under a finger", bent > 0.1, f"{bent:.2f}")
        yaw = self.run("return v.camera.yaw")
        self.browser.touch([(x + 30 + 10 * i, y + 40) for i in range(6)])
        turned = yaw - self.run("return v.camera.yaw")
        self.check("a finger beside it turns the camera", abs(turned - 20) < 4, turned)
        self.browser.touch([(60, y + 40)] * 11, [(120 + 6 * i, y + 40) for i in range(11)])
        zoom = self.run("return v.camera.zoom")
        self.check("two fingers zoom", zoom > 1.5, zoom)
        kinds = self.run("return kinds")
        self.check("and these were fingers", kinds == ["touch"] * 4, kinds)
        top = self.run("return [scrollY, visualViewport.scale]")
        self.check("the page stays where it is", top == [0, 1], top)
