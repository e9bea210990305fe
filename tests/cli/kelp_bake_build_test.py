#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""kelp-bake -MD as make and ninja understand it, and --cache.

Usage: kelp_bake_build_test.py KELP_BAKE [unittest options]"""
import ctypes
import ctypes.util
import json
import os
import random
import shlex
import shutil
import struct
import subprocess
import time
import unittest

from kelp_bake_case import KELP_BAKE, PIXEL, Case, box, textured_box

# Names that build files have other uses for; some of them without KELP_ALL_TESTS.
ODD = ["a b", "$(d)", "#h", "e\\ f", "p%q", "w:x"]
if os.environ.get("KELP_ALL_TESTS"):
    ODD += ["plain", "d$x", "h#i", "b\\s", "t'u", "(v)", "a  b"]


class BuildFolder(Case):
    def textured(self, folder, name="box"):
        """A box whose material and picture lie beside it."""
        self.write(folder + "/%s.obj" % name, textured_box().replace("box.mtl", "the box.mtl"))
        self.write(folder + "/the box.mtl", "newmtl skin\nmap_Kd the $kin.tga\n")
        self.write(folder + "/the $kin.tga", PIXEL)


class BuildSteps(BuildFolder):
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
        self.write("c.toml", "resolution = 8")
        read = ["in/box.obj", "in/box.rig.json", "in/the $kin.tga", "in/the box.mtl"]
        self.passes("in/box.obj", "-o", "out.kelp", "-MD", "--resolution", "8")
        self.assertEqual(self.rule("out.kelp.d"), ("out.kelp", read))
        self.write(
            "m.json",
            {"include": "n.json", "assets": [
                 {"input": "in/box.obj", "output": "out.kelp", "palette": "colors.gpl", "write-deps": True}]})
        self.write("n.json", {"assets": ["1.obj"]})
        self.passes("--manifest", "m.json", "--config", "c.toml")
        self.assertEqual(self.rule("out.kelp.d"),
                         ("out.kelp", sorted(read + ["c.toml", "colors.gpl", "m.json", "n.json"])))

    def test_targets_and_phony_targets(self):
        """-MT and -MP as compilers have them."""
        self.textured("in")
        self.write("c.toml", "resolution = 8")
        self.passes("in/box.obj", "-o", "out.kelp", "-MD", "-MP", "-MT", "$(packs)/out.kelp other",
                    "--config", "c.toml")
        self.assertEqual(
            self.read("out.kelp.d").decode(),
            "$(packs)/out.kelp other: \\\n  in/box.obj \\\n  in/the\\ $$kin.tga \\\n  in/the\\ box.mtl \\\n"
            "  c.toml\n\nin/the\\ $$kin.tga:\n\nin/the\\ box.mtl:\n\nc.toml:\n")
        self.write(
            "m.json", {"output": "o", "defaults": {"resolution": 8, "write-deps": True, "deps-phony": True},
                       "assets": [{"input": "in/box.obj", "deps-target": "it"}, "1.obj"]})
        self.passes("--manifest", "m.json")
        self.assertTrue(self.read("o/box.kelp.d").startswith(b"it: "))
        self.assertTrue(self.read("o/1.kelp.d").endswith(b"\n\nm.json:\n"))
        for arguments, says in ((["-MP"], "--deps-phony"),
                                (["-MT", "x"], "--deps-target"),
                                (["-MD", "-MT", ""], "--deps-target: is empty")):
            self.fails(1, "1.obj", "-o", "x.kelp", *arguments, says=[says])
        self.fails(1, "--manifest", "m.json", "-MT", "x", says=["-MT"])
        self.write("m.json", {"defaults": {"write-deps": True, "deps-target": "x"}, "assets": ["1.obj"]})
        self.fails(3, "--manifest", "m.json", says=["m.json:1:50: ", "deps-target"])

    @unittest.skipUnless(shutil.which("make") and shutil.which("ninja"),
                         "make or ninja is not installed: apt-get install make ninja-build")
    def test_a_file_that_is_gone_stops_no_build_with_phony_targets(self):
        self.textured("in")
        command = "%s in/box.obj -o out.kelp --resolution 4 -MD" % shlex.quote(KELP_BAKE)
        for phony in ("", " -MP"):
            self.write("in/the box.mtl", "newmtl skin\nmap_Kd the $kin.tga\n")
            self.write(
                "Makefile", "all: out.kelp\n-include out.kelp.d\nout.kelp:\n\t%s\n" % (command + phony))
            self.write("build.ninja", "rule bake\n  command = %s\n  depfile = out.kelp.d\n"
                                      "build out.kelp: bake in/box.obj\n" % (command + phony))
            for builder in ("make", "ninja"):
                self.write("in/the $kin.tga", PIXEL)
                self.assertEqual(subprocess.run([builder], cwd=self.folder, capture_output=True).returncode,
                                 0, builder + phony)
                self.write("in/the box.mtl", "newmtl skin\n")
                os.remove(self.path("in/the $kin.tga"))
                result = subprocess.run([builder], cwd=self.folder, capture_output=True)
                self.assertEqual(result.returncode == 0, builder == "ninja" or bool(phony), result.stderr)
                self.write("in/the box.mtl", "newmtl skin\nmap_Kd the $kin.tga\n")
                if os.path.exists(self.path("out.kelp.d")):
                    os.remove(self.path("out.kelp.d"))

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

    def test_a_pack_that_is_up_to_date_gets_its_rule(self):
        self.textured("in")
        self.write("c.toml", "levels = 1")
        for name in ("A.json", "B.json"):
            self.write(name, {"output": "o", "defaults": {"resolution": 8, "levels": 1, "write-deps": True},
                              "assets": ["in/box.obj"]})
        self.passes("--manifest", "A.json")
        read = ["in/box.obj", "in/the $kin.tga", "in/the box.mtl"]
        self.assertEqual(self.rule("o/box.kelp.d"), ("o/box.kelp", sorted(read + ["A.json"])))
        pack = self.read("o/box.kelp")
        self.assertIn("up to date", self.passes("--manifest", "B.json", "--config", "c.toml"))
        self.assertEqual(self.rule("o/box.kelp.d"), ("o/box.kelp", sorted(read + ["B.json", "c.toml"])))
        os.remove(self.path("o/box.kelp.d"))
        self.assertIn("1 up to date", self.passes("--manifest", "A.json"))
        self.assertEqual(self.rule("o/box.kelp.d"), ("o/box.kelp", sorted(read + ["A.json"])))
        self.assertEqual(self.read("o/box.kelp"), pack)
        # Its time is a build's affair alone.
        os.utime(self.path("o/box.kelp"), (7, 7))
        self.assertIn(
            "1 up to date",
            self.passes("@" + self.write("l.txt", "in/box.obj --resolution 8 --levels 1"), "-o", "o"))
        self.assertEqual(os.stat(self.path("o/box.kelp")).st_mtime, 7)
        self.passes("--manifest", "A.json")
        self.assertGreater(os.stat(self.path("o/box.kelp")).st_mtime, 7)

    @unittest.skipUnless(shutil.which("make"), "make is not installed: apt-get install make")
    def test_make_asks_once_for_a_manifest_that_is_newer(self):
        self.write(
            "A.json", {"output": "o", "defaults": {"resolution": 8, "write-deps": True}, "assets": ["1.obj"]})
        self.write("Makefile", ".PHONY: all\nall: o/1.kelp\n-include o/1.kelp.d\no/1.kelp:\n"
                               "\t%s --manifest A.json\n" % shlex.quote(KELP_BAKE))

        def make():
            result = subprocess.run(["make"], cwd=self.folder, capture_output=True)
            self.assertEqual(result.returncode, 0, result.stderr)
            return b"Nothing to be done" not in result.stdout, b"up to date" in result.stderr

        self.assertEqual(make()[0], True)
        self.assertEqual(make()[0], False)
        status = os.stat(self.path("o/1.kelp"))
        time.sleep(0.02)  # file times may be a clock tick apart
        os.utime(self.path("A.json"))
        self.assertEqual(make(), (True, True))
        self.assertEqual(os.stat(self.path("o/1.kelp")).st_ino, status.st_ino)
        self.assertEqual(make()[0], False)

    def escaped_target(self, odd):
        """As make wants it, written by hand: what the program writes is what is tested."""
        by_hand = {"a b": "a\\ b", "d$x": "d$$x", "$(d)": "$$(d)", "h#i": "h\\#i", "#h": "\\#h",
                   "e\\ f": "e\\\\\\ f", "a  b": "a\\ \\ b", "w:x": "w\\:x"}
        return by_hand.get(odd, odd) + ".kelp"


class Caches(BuildFolder):
    def cached(self, *arguments, notice=False):
        """Whether a bake came from the cache. Its pack, report and rule must be those of a bake without."""
        result = self.bake(*arguments, "-o", "c.kelp", "--report", "c.json", "-MF", "c.d", "--cache", "cache")
        self.assertEqual(result.returncode, 0, result.stderr.decode())
        self.passes(*arguments, "-o", "n.kelp", "--report", "n.json", "-MF", "n.d")
        self.assertEqual(self.read("c.kelp"), self.read("n.kelp"))
        self.assertEqual(self.read("c.d").replace(b"c.kelp", b"n.kelp"), self.read("n.d"), "the rule")
        with_cache, without = json.loads(self.read("c.json")), json.loads(self.read("n.json"))
        came = with_cache["cached"]
        self.assertEqual(b"from the cache" in result.stderr, came)
        for json_of in (with_cache, without):
            for member in ("seconds", "stages", "output", "cached", "estimated_bytes"):
                del json_of[member]
            json_of["files"].sort(key=lambda file: file["name"])
        self.assertEqual(with_cache, without)
        return came

    def once(self, *arguments):
        """Not there, and there from then on."""
        self.assertFalse(self.cached(*arguments), arguments)
        self.assertTrue(self.cached(*arguments), arguments)

    def entries(self, kind=".kelp-pack"):
        return sorted(os.path.join(where, name) for where, _, names in os.walk(self.path("cache"))
                      for name in names if name.endswith(kind))

    def test_hits_and_misses(self):
        self.textured("in")
        bake = ["in/box.obj", "--resolution", "8"]
        self.once(*bake)
        self.once(*bake[:1], "--resolution", "9")
        self.once(*bake, "--up", "+z")
        self.once(*bake, "--rig", "sway")
        box = ["1.obj", "--resolution", "8"]
        self.once(*box)
        self.write("1.rig.json", {"kelp": 1})
        self.once(*box, "--rig", "sway")  # its report tells of a rig that is not read
        os.remove(self.path("1.rig.json"))
        self.once(*box, "--rig", "sway")
        self.assertTrue(self.cached(*bake, "--threads", "1", "--max-memory", "1G"))
        self.once("in/box.obj", "--voxel-size", "0.25")
        # By content, not by name or time, of every file.
        shutil.copytree(self.path("in"), self.path("elsewhere/in"))
        self.assertTrue(self.cached("elsewhere/in/box.obj", "--resolution", "8"))
        os.rename(self.path("elsewhere/in/box.obj"), self.path("elsewhere/in/other.obj"))
        self.once("elsewhere/in/other.obj", "--resolution", "8")  # a pack names its source
        self.write("in/the $kin.tga", PIXEL[:-3] + b"\xff\0\0")
        self.once(*bake)
        self.write("in/the $kin.tga", PIXEL)
        self.assertTrue(self.cached(*bake), "back to what it was")
        self.write("in/the box.mtl", "newmtl skin\nmap_Kd other.tga\n")
        self.once(*bake)
        self.write("in/other.tga", PIXEL)
        self.once(*bake)
        # What was not there and is now, and is gone again.
        self.write("in/box.rig.json", {"kelp": 1, "axis": "+x"})
        self.once(*bake)
        self.write("in/box.rig.json", {"kelp": 1, "axis": "+z"})
        self.once(*bake)
        os.remove(self.path("in/box.rig.json"))
        self.assertTrue(self.cached(*bake))
        self.write("colors.gpl", "GIMP Palette\n255 0 0 red\n0 0 255 blue\n")
        self.once(*bake, "--palette", "colors.gpl")
        self.write("colors.gpl", "GIMP Palette\n255 0 0 red\n0 255 255 blue\n")
        self.once(*bake, "--palette", "colors.gpl")
        self.write("r.rig.json", {"kelp": 1})
        self.once(*bake, "--rig", "r.rig.json")
        self.write("r.rig.json", {"kelp": 1, "axis": "+x"})
        self.once(*bake, "--rig", "r.rig.json")

    def test_damaged_entries_are_baked_anew(self):
        chance = random.Random(2)
        bake = ["1.obj", "--resolution", "8"]
        self.once(*bake)
        for entry in self.entries() + self.entries(".kelp-names"):
            whole = self.read(entry)
            for step in range(18):
                at = chance.randrange(len(whole))
                if step % 3:
                    damaged = whole[:at] + bytes([whole[at] ^ 1 << chance.randrange(8)]) + whole[at + 1:]
                else:
                    damaged = (whole[:at], whole + b"x", b"")[step % 9 // 3]
                self.write(entry, damaged)
                self.passes(*bake, "-o", "c.kelp", "--cache", "cache")
                self.assertEqual(self.read("c.kelp"), self.read("n.kelp"))
                self.assertIn("from the cache", self.passes(*bake, "-o", "c.kelp", "--cache", "cache"))
                self.assertEqual(self.read("c.kelp"), self.read("n.kelp"))
                whole = self.read(entry)
            os.remove(entry)
            self.once(*bake)

    def test_entries_that_hold_something_else_are_baked_anew(self):
        library = ctypes.util.find_library("xxhash")
        if not library:
            self.skipTest("libxxhash is absent: apt-get install libxxhash0")
        class Hash(ctypes.Structure):
            _fields_ = [("low", ctypes.c_uint64), ("high", ctypes.c_uint64)]
        xxh3 = ctypes.CDLL(library).XXH3_128bits
        xxh3.restype, xxh3.argtypes = Hash, [ctypes.c_char_p, ctypes.c_size_t]
        bake = ["1.obj", "--resolution", "8"]
        self.once(*bake)
        entry, = self.entries()
        head, rest = self.read(entry).split(b"\n", 1)
        _, _, report_bytes, pack_bytes, _ = head.split(b" ")
        pack = rest[int(report_bytes):]
        for report in (b"not json", b"[]", b'{"notices": []}', b'{"input": 5, "notices": []}',
                       b'{"input": "1.obj", "notices": 3}', b'{"input": "1.obj", "notices": [7]}',
                       b'{"input": "1.obj", "notices": [], "x": ' + b"[" * 200000 + b"]" * 200000 + b"}",
                       b'{"input": "1.obj", "notices": [], '
                       + b",".join(b'"%d": 0' % i for i in range(200000)) + b"}"):
            hashed = xxh3(report + pack, len(report + pack))
            self.write(entry, b"kelp-cache 1 %d %d %016x%016x\n"
                              % (len(report), len(pack), hashed.high, hashed.low) + report + pack)
            self.once(*bake)

    def test_many_at_once(self):
        chance = random.Random(5)
        for turn in range(4):
            bakes = [
                subprocess.Popen(
                    [KELP_BAKE, "%d.obj" % (i % 3 + 1), "-o", "out%d.kelp" % i, "--resolution", "12",
                     "--threads", "1", "--cache", "cache", *(["--cache-size", "3000"] if turn % 2 else [])],
                    cwd=self.folder, stderr=subprocess.PIPE) for i in range(12)]
            if turn == 2:
                chance.choice(bakes).kill()
            for process in bakes:
                text = process.communicate(timeout=120)[1]
                self.assertIn(process.returncode, (0, -9), text)
            for i in range(3):
                self.passes("%d.obj" % (i + 1), "-o", "single.kelp", "--resolution", "12")
                for same in range(i, 12, 3):
                    if bakes[same].returncode == 0:
                        self.assertEqual(self.read("out%d.kelp" % same), self.read("single.kelp"))

    def test_its_size_is_bounded(self):
        self.write("cache/mine.txt", "x" * 100000)
        for resolution in range(8, 30):
            self.passes("1.obj", "-o", "c.kelp", "--resolution", str(resolution), "--cache", "cache",
                        "--cache-size", "20K")
            self.assertLessEqual(
                sum(os.path.getsize(entry) for entry in self.entries() + self.entries(".kelp-names")),
                20 << 10)
        self.assertTrue(os.path.exists(self.path("cache/mine.txt")), "what is not the cache's own stays")
        self.assertTrue(self.cached("1.obj", "--resolution", "29"), "the last is still there")
        self.assertFalse(self.cached("1.obj", "--resolution", "8"))

    def test_a_cache_that_can_not_be_used(self):
        self.fails(2, "1.obj", "-o", "c.kelp", "--cache", "2.obj", says=["--cache 2.obj"])
        self.fails(
            1, "1.obj", "-o", "c.kelp", "--cache", "cache", "--cache-size", "lots", says=["--cache-size"])
        if os.geteuid() != 0:
            os.makedirs(self.path("cache"))
            os.chmod(self.path("cache"), 0o500)
            self.assertIn("could not be kept", self.passes("1.obj", "-o", "c.kelp", "--cache", "cache"))
        self.write("blocked/x", "")
        self.passes("1.obj", "-o", "c.kelp", "--resolution", "8", "--cache", "cache")
        for entry in self.entries() + self.entries(".kelp-names"):
            folder = os.path.dirname(entry)
            if os.path.isdir(folder):
                shutil.rmtree(folder)
            with open(folder, "w"):
                pass
        text = self.passes("1.obj", "-o", "c.kelp", "--resolution", "8", "--cache", "cache")
        self.assertIn("warning: --cache cache: the pack could not be kept there", text)

    def test_its_folder_is_no_output(self):
        self.write(
            "m.json", {"assets": [{"input": "1.obj", "output": "x.kelp"}, {"input": "2.obj", "report": "r"}]})
        self.write("c.toml", 'cache = "x.kelp"\nresolution = 8')
        for cache in ("x.kelp", "x.kelp/", "./x.kelp/below/it", self.path("x.kelp")):
            self.fails(1, "1.obj", "-o", "x.kelp", "--cache", cache, says=["-o x.kelp", "--cache " + cache])
            self.fails(1, "1.obj", "-o", "y.kelp", "--report", "x.kelp", "--cache", cache,
                       says=["--report x.kelp", "--cache " + cache])
            self.fails(3, "--manifest", "m.json", "--cache", cache,
                       says=["m.json:1:", "-o x.kelp", "--cache " + cache])
        self.fails(1, "1.obj", "-o", "x.kelp", "--config", "c.toml", says=["--cache x.kelp"])
        self.fails(3, "--manifest", "m.json", "--cache", "r", says=["m.json:1:", "--report r", "--cache r"])
        self.fails(1, "--manifest", "m.json", "--report", "all", "--cache", "all",
                   says=["--report all", "--cache all"])
        # Beside it, or in it, is as good as anywhere.
        self.passes("1.obj", "-o", "x.kelp", "--resolution", "8", "--cache", "x.kelp.d", "--report", "x.json")
        self.passes("--manifest", "m.json", "-o", "x.kelp.d", "--resolution", "8", "--cache", "x.kelp.d")

    def test_batches_use_it(self):
        self.write("m.json", {"defaults": {"resolution": 8}, "assets": ["1.obj", "2.obj"]})

        def status(*more):
            report = self.batch_report("--manifest", "m.json", "--cache", "cache", *more)
            return [asset["status"] for asset in report["assets"]]

        self.assertEqual(status(), ["baked", "baked"])
        self.assertEqual(status(), ["current", "current"])
        os.remove(self.path("1.kelp"))
        self.assertEqual(status(), ["cached", "current"])
        self.assertEqual(status("-o", "other"), ["cached", "cached"])
        self.assertEqual(self.read("other/2.kelp"), self.read("2.kelp"))

    def batch_report(self, *arguments):
        self.passes(*arguments, "--report", "report.json")
        return json.loads(self.read("report.json"))


if __name__ == "__main__":
    unittest.main()
