#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""kelp-bake -MD as make and ninja understand it.

Usage: kelp_bake_build_test.py KELP_BAKE [unittest options]"""
import os
import shlex
import shutil
import struct
import subprocess
import unittest

from kelp_bake_case import KELP_BAKE, PIXEL, Case, box, textured_box

# Names that build files have other uses for; some of them without KELP_ALL_TESTS.
ODD = ["a b", "$(d)", "#h", "e\\ f", "p%q", "w:x"]
if os.environ.get("KELP_ALL_TESTS"):
    ODD += ["plain", "d$x", "h#i", "b\\s", "t'u", "(v)", "a  b"]


class BuildSteps(Case):
    def textured(self, folder, name="box"):
        """A box whose material and picture lie beside it."""
        self.write(folder + "/%s.obj" % name, textured_box().replace("box.mtl", "the box.mtl"))
        self.write(folder + "/the box.mtl", "newmtl skin\nmap_Kd the $kin.tga\n")
        self.write(folder + "/the $kin.tga", PIXEL)

    def rule(self, name):
        """The names in a rule, as written but without its escapes."""
        text = self.read(name).decode().replace("\\\n", "").replace("$$", "$")
        for c in " #:":
            text = text.replace("\\" + c, chr(1 + " #:".index(c)))
        target, files = text.split(":", 1)
        plain = lambda word: word.replace("\1", " ").replace("\2", "#").replace("\3", ":")
        return plain(target), sorted(plain(word) for word in files.split())

    def test_every_file_that_is_read_is_named(self):
        self.textured("in")
        self.write("in/box.rig.json", {"kelp": 1})
        self.write("colors.gpl", "GIMP Palette\n255 0 0 red\n")
        read = ["in/box.obj", "in/box.rig.json", "in/the $kin.tga", "in/the box.mtl"]
        self.passes("in/box.obj", "-o", "out.kelp", "-MD", "--resolution", "8")
        self.assertEqual(self.rule("out.kelp.d"), ("out.kelp", read))
        self.passes("in/box.obj", "-o", "out.kelp", "-MD", "--resolution", "8", "--palette", "colors.gpl")
        self.assertEqual(self.rule("out.kelp.d"), ("out.kelp", sorted(read + ["colors.gpl"])))

    def test_targets_and_phony_targets(self):
        """-MT and -MP as compilers have them."""
        self.textured("in")
        self.passes("in/box.obj", "-o", "out.kelp", "-MD", "-MP", "-MT", "$(packs)/out.kelp other",
                    "--resolution", "8")
        self.assertEqual(
            self.read("out.kelp.d").decode(),
            "$(packs)/out.kelp other: \\\n  in/box.obj \\\n  in/the\\ $$kin.tga \\\n  in/the\\ box.mtl\n"
            "\nin/the\\ $$kin.tga:\n\nin/the\\ box.mtl:\n")
        for arguments, says in ((["-MP"], "--deps-phony"),
                                (["-MT", "x"], "--deps-target"),
                                (["-MD", "-MT", ""], "--deps-target: is empty")):
            self.fails(1, "1.obj", "-o", "x.kelp", *arguments, says=[says])

    def test_buffers_and_pictures_of_gltf(self):
        points = bytes.fromhex("0000000000000000000000000000803f00000000000000000000"
                               "00000000803f0000000000000000000000000000803f")
        uvs = bytes(32)
        faces = bytes([0, 2, 1, 0, 1, 3, 1, 2, 3, 0, 3, 2])
        self.write("in/b u.bin", points + uvs + faces)
        self.write("in/skin.tga", PIXEL)
        self.write("in/m.gltf",
                   {"asset": {"version": "2.0"}, "scenes": [{"nodes": [0]}], "nodes": [{"mesh": 0}],
                    "buffers": [{"uri": "b%20u.bin", "byteLength": 92}],
                    "bufferViews": [{"buffer": 0, "byteLength": 48},
                                    {"buffer": 0, "byteOffset": 48, "byteLength": 32},
                                    {"buffer": 0, "byteOffset": 80, "byteLength": 12}],
                    "images": [{"uri": "skin.tga"}], "textures": [{"source": 0}],
                    "materials": [{"pbrMetallicRoughness": {"baseColorTexture": {"index": 0}}}],
                    "accessors": [{"bufferView": 0, "componentType": 5126, "count": 4, "type": "VEC3",
                                   "min": [0, 0, 0], "max": [1, 1, 1]},
                                  {"bufferView": 1, "componentType": 5126, "count": 4, "type": "VEC2"},
                                  {"bufferView": 2, "componentType": 5121, "count": 12, "type": "SCALAR"}],
                    "meshes": [{"primitives": [{"attributes": {"POSITION": 0, "TEXCOORD_0": 1}, "indices": 2,
                                                "material": 0}]}]})
        result = self.bake("in/m.gltf", "-o", "out.kelp", "-MD", "--resolution", "8")
        self.assertEqual(result.returncode, 0, result.stderr.decode())
        self.assertEqual(self.rule("out.kelp.d"), ("out.kelp", ["in/b u.bin", "in/m.gltf", "in/skin.tga"]))

    def test_a_name_with_a_line_break_is_in_no_rule(self):
        self.write("m.gltf", {"asset": {"version": "2.0"}, "nodes": [{"mesh": 0}],
                              "buffers": [{"uri": "x%0ASHELL=./evil", "byteLength": 36}],
                              "bufferViews": [{"buffer": 0, "byteLength": 36}],
                              "accessors": [{"bufferView": 0, "componentType": 5126, "count": 3,
                                             "type": "VEC3", "min": [0, 0, 0], "max": [0, 0, 0]}],
                              "meshes": [{"primitives": [{"attributes": {"POSITION": 0}}]}]})
        os.rename(self.write("1.obj", box(1, 1, 1)), self.path("1\n2.obj"))
        for model in ("1\n2.obj", "2.obj"):
            result = self.bake(
                model, "-o", "out\r.kelp" if model == "2.obj" else "out.kelp", "-MD", "--resolution", "4")
            self.assertEqual(result.returncode, 2, result.stderr)
            self.assertIn(b"has a line break in its name", result.stderr)
            self.assertTrue(
                all(line.startswith(b"kelp-bake: ") for line in result.stderr.splitlines()), result.stderr)
            self.assertEqual([name for name in os.listdir(self.folder) if "kelp" in name], [])
        self.write("x\nSHELL=./evil", struct.pack("<9f", 0, 0, 0, 1, 0, 0, 0, 1, 1))
        result = self.bake("m.gltf", "-o", "out.kelp", "-MD", "--resolution", "4")
        self.assertEqual(result.returncode, 2, result.stderr)
        self.assertEqual([name for name in os.listdir(self.folder) if "kelp" in name], [])

    def check_builds(self, build, folder, output):
        """Builds once, then not at all, then whenever a file is touched, then not at all."""
        self.assertTrue(build(), output)
        self.assertFalse(build(), output)
        for name in os.listdir(self.path(folder)):
            os.utime(self.path(os.path.join(folder, name)))
            self.assertTrue(build(), (output, name))
            self.assertFalse(build(), (output, name))

    @unittest.skipUnless(shutil.which("ninja"), "ninja is not installed: apt-get install ninja-build")
    def test_ninja(self):
        for odd in ODD:
            if "'" in odd:
                continue  # has no way to be in a rule that ninja reads
            self.textured(odd, odd)
            output = odd + ".kelp"
            escape = lambda name: name.replace("$", "$$").replace(" ", "$ ").replace(":", "$:")
            model = "%s/%s.obj" % (odd, odd)
            words = (KELP_BAKE, model, "-o", output, "--resolution", "4", "-MD")
            command = " ".join(shlex.quote(word) for word in words).replace("$", "$$")
            self.write("build.ninja",
                       "rule bake\n  command = %s\n  depfile = %s\nbuild %s: bake %s\n"
                       % (command, output.replace("$", "$$") + ".d", escape(output), escape(model)))

            def build():
                result = subprocess.run(["ninja"], cwd=self.folder, capture_output=True)
                self.assertEqual(result.returncode, 0, result.stdout + result.stderr)
                return b"no work to do" not in result.stdout

            self.check_builds(build, odd, output)

    @unittest.skipUnless(shutil.which("make"), "make is not installed: apt-get install make")
    def test_make(self):
        for odd in ODD:
            if "%" in odd:
                continue  # has no way to be a target of make
            self.textured(odd, odd)
            output = odd + ".kelp"
            target = self.escaped_target(odd)
            words = (KELP_BAKE, "%s/%s.obj" % (odd, odd), "-o", output, "--resolution", "4", "-MF", "deps.d")
            command = " ".join(shlex.quote(word) for word in words).replace("$", "$$")
            self.write(
                "Makefile", ".PHONY: all\nall: %s\n-include deps.d\n%s:\n\t%s\n" % (target, target, command))
            if os.path.exists(self.path("deps.d")):
                os.remove(self.path("deps.d"))

            def build():
                result = subprocess.run(["make"], cwd=self.folder, capture_output=True)
                self.assertEqual(result.returncode, 0, result.stdout + result.stderr)
                return b"Nothing to be done" not in result.stdout

            self.check_builds(build, odd, output)

    def escaped_target(self, odd):
        """As make wants it, written by hand: what the program writes is what is tested."""
        by_hand = {"a b": "a\\ b", "d$x": "d$$x", "$(d)": "$$(d)", "h#i": "h\\#i", "#h": "\\#h",
                   "e\\ f": "e\\\\\\ f", "a  b": "a\\ \\ b", "w:x": "w\\:x"}
        return by_hand.get(odd, odd) + ".kelp"


if __name__ == "__main__":
    unittest.main()
