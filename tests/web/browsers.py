# SPDX-License-Identifier: MIT
"""Tests the page of samples/web in a real browser. tests/ports.sh web calls it.

    browsers.py chromium|firefox PAGE_FOLDER OUT_FOLDER PROGRAMS_FOLDER KELP_CAMERA

Screenshots go to OUT_FOLDER. PROGRAMS_FOLDER has kelp-bake and kelp-render.
"""

import base64
import os
import subprocess
import sys
import time

sys.dont_write_bytecode = True
from faults import Faults
from hands import Hands
from harness import Harness
from pictures import compare, read_png
import vox

SIZE = (320, 400)  # of the canvas, in pixels


class Tests(Harness, Hands, Faults):
    # --- what is tested ------------------------------------------------------------------------------
    def shows(self):
        if self.browser.name == "chromium":
            self.browser.resize(800, 600)
        self.open()
        self.check("the plant is shown, as fine as it gets", self.wait_fine(), self.run("return v.sizes()"))
        self.check("without words", self.words() == "", self.words())
        self.shot("plant")
        self.coarse()
        sent = self.server.sent["kelp_plant.kelp"]
        whole = os.path.getsize(self.page + "/packs/kelp_plant.kelp")
        self.check("no more than the voxels was fetched", sent < whole, f"{sent} of {whole} bytes")

    def equals_render(self):
        width, height = SIZE
        pack, picture = self.page + "/packs/kelp_plant.kelp", self.out + "/reference.png"
        subprocess.run([self.programs + "/kelp-render", pack, "-o", picture, "--size", f"{width}x{height}",
                        "--samples", "1", "--shadows", "off", "--background", "none"], check=True)
        matrices = subprocess.run([self.camera, pack, "30", "15", str(width / height)], check=True,
                                  capture_output=True, text=True).stdout
        if self.browser.name == "chromium":
            self.browser.resize(800, 600)
        self.open()
        self.wait_open()
        self.run(f"Object.assign(v.canvas.style, {{width: '{width}px', height: '{height}px'}});"
                 f"const m = {matrices}; v.matrices(m.to_eye, m.to_clip);")
        self.wait_fine()
        mine = self.run("const t = performance.now(); for (let i = 0; i < 10; ++i) v.pixels();"
                        "return (performance.now() - t) / 10")
        said = subprocess.run([self.programs + "/kelp-render", pack, "-o", self.out + "/timed.png", "--size",
                               f"{width}x{height}", "--samples", "1", "--shadows", "off", "--method", "kelp"],
                              check=True, capture_output=True, text=True).stdout
        print(f"       this picture takes {mine:.1f} ms here; {said.strip()}")
        hits, one_sided, other, strange = compare(self.pixels(), width, height, read_png(picture))
        self.shot("as_kelp_render")
        self.coarse()
        # The bounds of tests/gl/picture_test.cpp; rays that graze a voxel may differ.
        self.check("the picture is kelp-render's", hits > 3000 and one_sided <= 1 + hits / 500 and
                   strange <= 1 + hits / 200 and other <= hits / 50,
                   f"of {hits} pixels {one_sided} covered by one, {other} other colors, "
                   f"{strange} that no neighbor has")

    def bends(self):
        self.open()
        self.wait_fine()
        rest = self.pixels()
        box = self.run("const b = v.canvas.getBoundingClientRect(); return [b.x, b.y, b.width, b.height]")
        x, y = box[0] + box[2] / 2, box[1] + box[3] * 0.4
        place = self.run(f"for (let d = 0; d < 80; ++d) for (const q of [d, -d]) if (v.pick({x - box[0]} + "
                         f"q, "
                         f"{y - box[1]})) return q; return null")
        self.check("the pointer meets the plant", place is not None)
        points = [(x + place + 6 * i, y) for i in range(20)]
        self.browser.mouse(points, hold=True)
        time.sleep(1.5)
        bent = self.pixels()
        self.shot("bent")
        self.check("it bends under the pointer", self.moved(rest, bent) > 0.2,
                   f"{self.moved(rest, bent):.2f}")
        self.browser.release(*points[-1])
        self.browser.mouse([(5, 5)], pressed=False)
        back = 1
        for _ in range(40):
            time.sleep(0.5)
            back = self.moved(rest, self.pixels())
            if back < 0.004:
                break
        self.check("and swings back", back < 0.004, f"{back:.4f}")
        frames = self.run("let n; for (let i = 0; i < 20; ++i) { n = v.frames; await s(1000); if (v.frames "
                          "=== n) break; }"
                          "return v.frames - n")
        self.check("then nothing is drawn any more", frames == 0, frames)

    def poses(self):
        rest = self.pixels()
        self.run("const x = document.getElementById('x'); x.value = 1.2; x.dispatchEvent(new Event('input'))")
        pose = self.run("await s(300); return v.pose()")
        self.check("a slider moves a tangent", len(pose) == 1 and abs(pose[0]["tangent"][0] - 1.2) < 1e-6,
                   pose)
        self.check("and the plant with it", self.moved(rest, self.pixels()) > 0.02)
        self.shot("tangent")
        self.run("document.getElementById('reset').click()")
        time.sleep(0.5)
        self.check("it can be reset", self.moved(rest, self.pixels()) < 0.004)
        self.run("v.play('sway'); await s(700)")
        self.check("clips play", self.run("return v.playing && v.time > 0.2"))
        self.check("and move it", self.moved(rest, self.pixels()) > 0.02)
        hit = self.run("v.play(null); const c = v.canvas; return v.pick(c.clientWidth / 2, c.clientHeight "
                       "* 0.75)")
        self.check("pick says what is there", hit and hit["part"] == 0 and len(hit["voxel"]) == 3, hit)
        faults = self.run("const f = []; for (const g of [() => v.play('no'), () => v.pose({knot: 99, "
                          "tangent: "
                          "[0, 1, 0]}), () => v.pose({knot: 1, tangent: [NaN, 1, 0]})]) try { g(); } "
                          "catch (e) { f.push(e.name); } return f")
        self.check("mistakes are KelpErrors", faults == ["KelpError"] * 3, faults)

    def moves_joints(self):
        """The octopus: one cage that follows its joints."""
        self.open("src=packs/octopus.kelp")
        self.wait_open()
        found = self.run("""
            Object.assign(v.canvas.style, {width: '96px', height: '120px'});
            const frame = async () => {
              const n = v.frames;
              for (v.invalidate(); v.frames < n + 2; await s(20)) v.invalidate();
            };
            v.play(null); await frame();
            const f = [], none = v.nodes(), n = v.description.joints.length;
            const moved = (x, i = 12) => {
              const m = [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1];
              m[i] += x;
              return m;
            };
            const all = (matrix) => v.description.joints.map(() => matrix);
            const shift = () => {  // least and most along x, most along y and z
              const by = v.nodes().map((x, i) => x - none[i]), x = by.filter((_, i) => i % 3 === 0);
              return [Math.min(...x), Math.max(...x), Math.max(...by.map((d, i) => i % 3 ? Math.abs(d) : 0))];
            };
            v.setJoints(all(moved(0.1))); await frame();
            const joints = shift();
            for (const wrong of [() => v.setJoints(all(moved(0)).slice(1)), () => v.setJoints(all([1])),
                                 () => v.setJoints(all(moved(NaN))), () => v.setJoints(all(moved(1, 3))),
                                 () => v.nodes(999), () => v.setNodes(0, [1, 2, 3])])
              try { wrong(); } catch (e) { f.push(`${e.name}: ${e.message}`); }
            await frame();
            const kept = shift();
            v.setJoints(null); await frame();
            const back = shift();
            v.setNodes(0, none.map((x, i) => i % 3 ? x : x + 5)); await frame();
            const nodes = shift();
            v.pose(null); await frame();
            return {joints, kept, back, nodes, reset: shift(), f, n, count: none.length};""")
        least, most, aside = found["joints"]
        self.check("setJoints moves the nodes", found["n"] > 8 and found["count"] > 300 and least > 3 and
                   most - least < 0.01 and aside < 0.01, found["joints"])
        self.check("mistakes with them are KelpErrors that say what is wrong",
                   len(found["f"]) == 6 and all(text.startswith("KelpError: ") and len(text) > 25
                                                for text in found["f"]), found["f"])
        self.check("and change nothing", found["kept"] == found["joints"], found["kept"])
        self.check("null gives them back", max(map(abs, found["back"])) < 0.001, found["back"])
        self.check("nodes go where they are put",
                   max(abs(a - b) for a, b in zip(found["nodes"], (5, 5, 0))) < 0.001, found["nodes"])
        self.check("until the pose is reset", max(map(abs, found["reset"])) < 0.001, found["reset"])

    def links(self):
        self.open("src=packs/tentacle.kelp&clip=curl&time=2.5&yaw=75&pitch=5&zoom=1.3&pan=0.1,0"
                  "&t=0:6:0.5,0.8,0")
        self.wait_open()
        time.sleep(1.5)
        kept = self.run("return {...v.camera, clip: v.clip, time: v.time, pose: v.pose(), link: "
                        "location.hash}")
        self.check("a link keeps file, clip, camera and pose", kept["clip"] == "curl"
                   and kept["time"] == 2.5 and
                   kept["yaw"] == 75 and kept["pan"] == [0.1, 0] and kept["pose"][0]["knot"] == 6, kept)
        self.shot("link")
        for part in ("tentacle.kelp", "clip=curl", "yaw=75", "t=0"):
            self.check(f"the address says {part}", part in kept["link"])

    def drops(self):
        self.open()
        self.wait_fine()
        self.drop("packs/octopus.kelp", "octopus.kelp")
        self.until("return document.getElementById('view').view.description.parts.length > 1")
        self.check("a dropped pack is shown and plays", self.run("await s(500); return v.playing"))
        self.shot("octopus")
        self.serve("tree.vox", vox.tree())
        self.drop("test/tree.vox", "tree.vox")
        baked = self.until("return document.getElementById('view').view.bytes !== null", 90)
        self.check("a dropped .vox file is baked", baked, self.words())
        if not baked:
            return
        self.run("await s(500)")
        self.shot("tree")
        mine = base64.b64decode(self.run("return btoa(String.fromCharCode(...v.bytes))"))
        pack = self.out + "/tree.kelp"
        subprocess.run([self.programs + "/kelp-bake", self.out + "/served/tree.vox", "-o", pack, "--rig",
                        "sway"],
                       check=True, capture_output=True)
        with open(pack, "rb") as file:
            self.check("to the bytes of kelp-bake", file.read() == mine, f"{len(mine)} bytes")
        self.check("and sways", self.run("return v.playing && v.clip === 'sway'"))
        saved = self.run("let n = null; HTMLAnchorElement.prototype.click = function() { n = "
                         "this.download; };"
                         "document.getElementById('save').click(); await s(300); return n")
        self.check("it can be saved", saved == "tree.kelp", saved)

    def streams(self):
        """At 1 Mbit/s. What the GPU takes for the first picture is told apart: SwiftShader compiles."""
        self.open("src=packs/kelp_plant.kelp%3Frate%3D1")
        self.until("return Boolean(document.getElementById('view')?.ready)")
        self.run("v.addEventListener('picture', () => { v.canvas.getContext('webgl2').readPixels(0, 0, 1, "
                 "1, 6408, "
                 "5121, new Uint8Array(4)); performance.mark('seen'); })")
        self.until("return performance.getEntriesByName('picture').length > 0", 20)
        self.shot("first_picture")
        self.wait_fine()
        marks = self.run("return Object.fromEntries(performance.getEntriesByType('mark').map(m => "
                         "[m.name, m.startTime]))")
        drawn, seen, last = (marks[mark] - marks["ready"] for mark in ("picture", "seen", "fine"))
        self.check("at 1 Mbit/s the first picture comes within 1 s of the module", drawn < 1000,
                   f"module {marks['ready']:.0f} ms; after it, first picture drawn {drawn:.0f} ms, "
                   f"finished by the GPU {seen:.0f} ms, last {last:.0f} ms")

    def paces(self):
        """Slow frames have fewer pixels while the model moves; what stands still has all of them."""
        if self.browser.name == "chromium":
            self.browser.resize(800, 600)
        self.open()
        self.wait_fine()
        whole = self.run("return v.canvas.width")
        self.run("window.slow = () => { const end = performance.now() + 130; while (performance.now() < end);"
                 "window.asked = requestAnimationFrame(slow); }; slow(); v.play('sway')")
        least = self.until(f"const w = document.getElementById('view').view.canvas.width;"
                           f"return w < {0.4 * whole} ? w : 0", 60)
        self.check("slow frames have fewer pixels", least, f"{least} of {whole}")
        self.run("cancelAnimationFrame(asked); v.play(null)")
        back = self.until(f"return document.getElementById('view').view.canvas.width === {whole}", 20)
        self.check("and all of them when it stands still", back)
        self.coarse()

    def stays_small(self):
        """2,000 frames in Chromium, whose heap can be measured."""
        if self.browser.name != "chromium":
            return
        self.open()
        self.wait_fine()
        self.run("Object.assign(v.canvas.style, {width: '96px', height: '120px'}); v.play('sway')")

        def heap():
            self.browser.call("HeapProfiler.collectGarbage")
            used = self.browser.call("Runtime.getHeapUsage")
            return used["usedSize"], self.run("return v.sizes().heap"), self.run("return v.frames")
        frames = "const n = v.frames; while (v.frames < n + {}) await s(20);"
        self.run(frames.format(200))
        before = heap()
        self.run(frames.format(2000))
        after = heap()
        self.check("2,000 frames take no memory", after[0] - before[0] < 200000 and after[1] == before[1] and
                   after[2] >= before[2] + 2000, f"JavaScript {before[0]} -> {after[0]}, module "
                                                 f"{before[1]} -> {after[1]}")

    def all(self):
        names = ["shows", "equals_render", "bends", "poses", "keys", "moves_joints", "links", "drops",
                 "faults", "claims", "hostile_vox", "loses", "streams", "phone", "paces", "stays_small"]
        for name in os.environ.get("KELP_WEB_TESTS", "").split() or names:
            try:
                getattr(self, name)()
            except Exception as error:  # the others go on, and the browser is closed
                self.check(name, False, repr(error))
        errors = [event for event in self.browser.events if event["method"] == "Runtime.exceptionThrown"]
        self.check("nothing was thrown past the page", not errors, errors or "")
        self.browser.close()
        return self.failed


if __name__ == "__main__":
    print(sys.argv[1] + ":", flush=True)
    sys.exit(1 if Tests(*sys.argv[1:]).all() else 0)
