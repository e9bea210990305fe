# SPDX-License-Identifier: MIT
"""Faults: broken downloads, hostile packs and .vox files, a lost context. All end in words."""

import os
import urllib.parse

import claims
import vox


class Faults:
    def faults(self):
        plant = "src=packs/kelp_plant.kelp?"
        cases = [
            ("a file that is not there", plant + "status=404", ["404"]),
            ("a server that fails", plant + "status=500", ["500"]),
            ("a file of another kind", "src=page.css", ["cannot be shown"]),
            ("a damaged header", plant + "damage=70", ["cannot be shown"]),
            ("a damaged page", plant + "damage=150000", ["cannot be read"]),
            ("a download that breaks off", plant + "abort=100000", ["The download stopped"]),
            ("a download without ranges that breaks off", plant + "noranges&abort=100000",
             ["The download stopped"]),
            ("a size of 5 GB", plant + "claim=5000000000", ["at most"]),
            ("a size that is not the file's", plant + "claim=2000000000", ["cannot be shown",
                                                                           "cannot be read"]),
        ]
        for what, link, expected in cases:
            self.open(link[:4] + urllib.parse.quote(link[4:]))
            words = self.wait_words(*expected)
            self.check(f"{what} ends in words", any(e in words for e in expected), words)
        self.shot("words")
        heap = self.run("return v.sizes().heap")
        self.check("in little memory", heap <= 64 << 20, heap)
        self.open(plant.replace("?", "%3Fnoranges"))
        self.check("a server without ranges does", self.wait_fine(), self.words())

    def next_file(self, name="tentacle"):
        """Chooses another model on the same page, and whether that is shown without words."""
        size = os.path.getsize(f"{self.page}/packs/{name}.kelp")
        self.run(f"const m = document.getElementById('model'); m.value = 'packs/{name}.kelp';"
                 "m.dispatchEvent(new Event('change'))")
        self.until(f"return document.getElementById('view').view.description?.bytes === {size}", 90)
        return self.wait_fine() and self.words() == ""

    def claims(self):
        """Packs with right checksums that claim more than a page may hold, each after the other on one page:
        by an address, then dropped. In between and in the end the page shows another pack."""
        self.serve("sound.kelp", claims.solid().build())
        self.open("src=test/sound.kelp")
        self.wait_fine()
        self.check("a pack that is put together anew is shown", self.run("return v.description.parts.length")
                   == 2 and self.words() == "", self.words())
        for what, name, data, expected, memory in claims.claims():
            self.serve(name, data)
            self.run(f"e.src = null; e.setAttribute('src', 'test/{name}')")
            words = self.wait_words(expected)
            self.check(f"{what} is refused in words", expected in words, words)
            self.check("  and the page goes on", self.next_file(), self.words())
            self.drop(f"test/{name}", name)
            words = self.wait_words(expected)
            self.check("  dropped, too", expected in words, words)
            self.check("  and the page goes on", self.next_file("octopus"), self.words())
            heap = self.run("return v.sizes().heap")
            self.check("  in bounded memory", heap <= memory, heap)
        self.shot("after_claims")

    def hostile_vox(self):
        """.vox files that lie, or are too large for a page, each after the other on one page."""
        self.open()
        self.wait_fine()
        for what, name, data, expected in (
                ("that lies", "liar.vox", vox.liar(), "liar.vox"),
                ("of two cubes 100 million voxels apart", "far.vox", vox.apart(100000000), "makes no sense"),
                ("as long as the Earth is wide", "wide.vox", vox.apart(12000000), "8192"),
                ("8000 voxels each way", "large.vox", vox.apart(8000), "memory")):
            self.serve(name, data)
            self.drop(f"test/{name}", name)
            words = self.wait_words(expected)
            self.check(f"a .vox file {what} ends in words", name in words and expected in words, words)
            self.check("  without options of a command", " --" not in words and "(--" not in words, words)
        self.shot("words_vox")
        self.serve("tree.vox", vox.tree())
        self.drop("test/tree.vox", "tree.vox")
        baked = self.until("return document.getElementById('view').view.bytes !== null", 90)
        self.check("and the page bakes the next one", baked and self.wait_fine() and self.words() == "",
                   self.words())

    def loses(self):
        self.open()
        self.wait_fine()
        before = self.pixels()
        self.run("window.lose = v.canvas.getContext('webgl2').getExtension('WEBGL_lose_context');"
                 "lose.loseContext(); await s(500)")
        self.check("a lost context ends in words", "took the graphics card away" in self.words(),
                   self.words())
        self.shot("lost")
        self.run("lose.restoreContext(); await s(1000)")
        self.check("which go when it is back", self.words() == "" and self.wait_fine(), self.words())
        self.check("and the picture is as before", self.moved(before, self.pixels()) < 0.004)
        words = self.run("HTMLCanvasElement.prototype.getContext = () => null;"
                         "const k = document.createElement('kelp-view'); document.body.append(k);"
                         "await k.ready.catch(() => {}); return k.shadowRoot.querySelector('p').textContent")
        self.check("without WebGL 2 there are words", "WebGL 2" in words, words)
