#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Volumes as a user bakes them.

Usage: kelp_bake_volumes_test.py KELP_BAKE MAKE_VOLUMES SOURCE_FOLDER [unittest options]

MAKE_VOLUMES writes the volumes. Those of the assets are baked too (skipped where they are absent)."""
import json
import os
import struct
import subprocess
import sys
import tempfile
import unittest

KELP_BAKE = os.path.abspath(sys.argv.pop(1))
MAKE_VOLUMES = os.path.abspath(sys.argv.pop(1))
SOURCES = sys.argv.pop(1)
ASSETS = os.environ.get("KELP_ASSETS") or os.path.join(SOURCES, "..", "shared", "assets")
KINDS = (".vdb", ".nvdb")


def ball(radius):
    """The voxels of a ball of make_volumes: their centers are inside the surface, or the density there is at
    least a value."""
    n = int(radius) + 1
    return sum(x * x + y * y + z * z <= radius * radius
               for x in range(-n, n + 1) for y in range(-n, n + 1) for z in range(-n, n + 1))


def contents(pack):
    """The chunks of a pack but for INFO, which records the options: formats/SPEC.md, section 3.2."""
    count, = struct.unpack_from("<I", pack, 24)
    entries = [struct.unpack_from("<4sIIIQQQQ", pack, 64 + 48 * i) for i in range(count)]
    return [entry[:4] + (pack[entry[4]:entry[4] + entry[5]],) for entry in entries if entry[0] != b"INFO"]


class Volumes(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.made = tempfile.TemporaryDirectory()
        cls.addClassCleanup(cls.made.cleanup)
        subprocess.run([MAKE_VOLUMES, cls.made.name], check=True, timeout=60)

    def setUp(self):
        self.folder = tempfile.TemporaryDirectory()
        self.addCleanup(self.folder.cleanup)

    def path(self, name):
        return os.path.join(self.folder.name, name)

    def write(self, name, content):
        with open(self.path(name), "wb") as file:
            file.write(content if isinstance(content, bytes) else content.encode())
        return self.path(name)

    def run_bake(self, path, *arguments):
        return subprocess.run(
            [KELP_BAKE, path, "-o", self.path("out.kelp"), "--progress", "none", *arguments],
            capture_output=True, timeout=120)

    def bakes(self, path, *arguments):
        """The part, as the report has it, and what was said; the pack's chunks are left in self.pack."""
        result = self.run_bake(path, *arguments, "--report", self.path("report.json"))
        text = result.stderr.decode()
        self.assertEqual(result.returncode, 0, text)
        with open(self.path("out.kelp"), "rb") as file:
            self.pack = contents(file.read())
        with open(self.path("report.json")) as file:
            return json.load(file)["parts"][0], text

    def refused(self, code, path, *arguments, says=()):
        result = self.run_bake(path, *arguments)
        text = result.stderr.decode()
        self.assertEqual(result.returncode, code, text)
        self.assertTrue(text.startswith("kelp-bake: ") and text.count("\n") == 1 and ";" in text, text)
        for words in says:
            self.assertIn(words, text)
        return text

    def test_which_grid(self):
        for kind in KINDS:
            several, unclear = (os.path.join(self.made.name, stem + kind) for stem in ("several", "unclear"))
            text = self.refused(1, unclear, says=["--grid", "0: 'smoke' (float, fog volume, ",
                                                  "1: 'mist' (float, fog volume, "])
            self.assertNotIn("Cd", text)
            self.assertNotIn("temperature", text)
            part, text = self.bakes(several)
            self.assertEqual(part["fill"], "fog that glows")
            self.assertEqual(part["size"], [17, 17, 17])
            self.assertIn("baked grid 'density' (float, fog volume, ", text)
            self.assertIn("another: 0: 'surface' (float, level set, ", text)
            self.assertIn(", 3: 'embers' (float, unknown class, ", text)
            part, _ = self.bakes(several, "--grid", "surface")
            self.assertEqual(part["solid_voxels"], ball(6.2))
            by_name = self.pack
            self.bakes(several, "--grid", "0")
            self.assertEqual(self.pack, by_name)
            part, text = self.bakes(several, "--grid", "density")
            self.assertEqual(part["fill"], "fog that glows")
            self.assertEqual(part["size"], [17, 17, 17])
            self.assertIn("glows of grid 'temperature'", text)
            self.refused(1, several, "--grid", "smoke", says=["--grid smoke", "no such grid", "'surface'"])
            self.refused(1, several, "--grid", "6", says=["--grid 6", "no such grid"])
            self.refused(5, several, "--grid", "Cd", says=["'Cd'", "vectors"])

    def test_what_numbers_mean(self):
        for kind in KINDS:
            fog, solid = (os.path.join(self.made.name, stem + kind) for stem in ("fog", "solid"))
            part, _ = self.bakes(fog)
            self.assertEqual((part["fill"], part["solid_voxels"]), ("fog", 0))
            plain = self.pack
            part, _ = self.bakes(fog, "--bend", "sweep")
            self.assertEqual(part["bend"], "shear")
            rig = self.write("swept.rig.json", '{"kelp": 1, "bend": "sweep"}')
            part, _ = self.bakes(fog, "--rig", rig)
            self.assertEqual((part["bend"], part["fill"]), ("sweep", "fog"))
            rig = self.write("sides.rig.json", '{"kelp": 1, "axis": "+y", "sides": {"-x-z": {}}}')
            self.refused(5, fog, "--rig", rig, says=["/sides", "is fog", "take \"sides\" out"])
            part, _ = self.bakes(solid, "--bend", "sweep")
            self.assertEqual(part["bend"], "sweep")
            self.bakes(fog, "--volume", "fog", "--density", "1")
            self.assertEqual(self.pack, plain)
            self.bakes(fog, "--density", "2.5")
            self.assertNotEqual(self.pack, plain)
            part, _ = self.bakes(fog, "--isovalue", "3.2")
            self.assertEqual(part["solid_voxels"], ball(5))
            part, text = self.bakes(fog, "--volume", "solid")
            self.assertIn("half its greatest value", text)
            self.assertEqual(part["solid_voxels"], ball(4.1))
            part, _ = self.bakes(solid)
            self.assertEqual(part["solid_voxels"], ball(6.2))
            part, _ = self.bakes(solid, "--isovalue", "-1.2")
            self.assertEqual(part["solid_voxels"], ball(5))
            part, _ = self.bakes(solid, "--resolution", "40")
            self.assertEqual(part["size"], [40, 40, 40])
            self.refused(1, solid, "--volume", "fog", says=["distances"])
            self.refused(1, solid, "--density", "2", says=["--density", "only fog"])
            self.refused(1, fog, "--isovalue", "1", "--volume", "fog", says=["fog has no surface"])
            self.refused(1, fog, "--isovalue", "1", "--density", "2", says=["only fog"])
            self.refused(3, fog, "--isovalue", "0", says=["solid outside"])
            self.refused(3, solid, "--isovalue", "-50", says=["nothing is inside"])
            for number in ("half", "nan", "inf", "1,5", ""):
                self.refused(1, fog, "--isovalue=" + number if number else "--isovalue", says=["--isovalue"])
            for number in ("0", "-1", "nan", "x"):
                self.refused(1, fog, "--density=" + number, says=["--density"])
            self.refused(1, fog, "--volume", "mist", says=["--volume mist", "solid"])

    def test_colors(self):
        for kind in KINDS:
            several = os.path.join(self.made.name, "several" + kind)
            packs = {}
            for name, arguments in (("Cd", []),
                                    ("Cd again", ["--color-grid", "Cd"]),
                                    ("by index", ["--color-grid", "4"]),
                                    ("paint", ["--color-grid", "paint"])):
                self.bakes(several, "--grid", "surface", *arguments)
                packs[name] = self.pack
            self.assertEqual(packs["Cd"], packs["Cd again"])
            self.assertEqual(packs["Cd"], packs["by index"])
            self.assertNotEqual(packs["Cd"], packs["paint"])
            self.refused(1, several, "--grid", "surface", "--color-grid", "density", says=["no colors"])
            self.refused(1, several, "--grid", "surface", "--color-grid", "none",
                         says=["--color-grid none", "no such grid"])
            self.refused(1, several, "--grid", "density", "--color-grid", "Cd", says=["fog has no color"])

    def test_heat(self):
        ramp = self.write("ramp.gpl", "GIMP Palette\nName: fire\n#\n0 0 0 cold\n255 64 0 hot\n")
        for kind in KINDS:
            stems = ("several", "glow", "fog")
            several, glow, fog = (os.path.join(self.made.name, stem + kind) for stem in stems)
            part, _ = self.bakes(glow)
            self.assertEqual(part["fill"], "fog that glows")
            black_body = self.pack
            part, text = self.bakes(glow, "--heat-grid", "none")
            self.assertEqual(part["fill"], "fog")
            self.assertNotIn("glows", text)
            self.bakes(glow, "--ramp", ramp)
            self.assertNotEqual(self.pack, black_body)
            part, text = self.bakes(several, "--grid", "1", "--heat-grid", "embers")
            self.assertIn("glows of grid 'embers'", text)
            by_name = self.pack
            self.bakes(several, "--grid", "1", "--heat-grid", "3")
            self.assertEqual(self.pack, by_name)
            self.refused(1, several, "--grid", "density", "--heat-grid", "fire",
                         says=["--heat-grid fire", "no such grid"])
            self.refused(1, several, "--grid", "density", "--heat-grid", "Cd", says=["no numbers"])
            self.refused(1, several, "--grid", "surface", "--heat-grid", "embers", says=["only fog glows"])
            self.refused(1, fog, "--ramp", ramp, says=["--ramp", "--heat-grid"])
            self.refused(1, glow, "--ramp", ramp, "--heat-grid", "none", says=["--ramp", "--heat-grid"])
            self.refused(1, glow, "--ramp", ramp, "--grid", "density", "--isovalue", "2",
                         says=["--ramp", "only fog glows"])
            self.refused(2, glow, "--ramp", self.path("absent.gpl"), says=["absent.gpl"])
            self.refused(3, glow, "--ramp", self.write("no.gpl", "no palette"), says=["no.gpl"])

    def test_a_nvdb_is_the_vdb_that_it_was_made_of(self):
        for stem, arguments in (("fog", []),
                                ("glow", []),
                                ("solid", []),
                                ("several", ["--grid", "surface"]),
                                ("several", ["--grid", "density", "--resolution", "30"])):
            parts = [self.bakes(os.path.join(self.made.name, stem + kind), *arguments)[0] for kind in KINDS]
            self.assertEqual(parts[0], parts[1])

    def test_raw_and_binvox(self):
        values = bytes(min(255, 20 * max(abs(x - 4), abs(y - 4), abs(z - 4))) for z in range(9)
                       for y in range(9) for x in range(9))
        scan = self.write("scan.raw", values)
        ramp = self.write("ramp.gpl", "GIMP Palette\n0 0 0\n255 64 0\n")
        self.refused(2, scan, says=["scan.raw"])
        self.write("scan.raw.json", '{"size": [9, 9, 9], "type": "u8"}')
        part, _ = self.bakes(scan)
        self.assertEqual((part["fill"], part["size"]), ("fog", [9, 9, 9]))
        self.bakes(scan, "--density", "3", "--volume", "fog")
        for number in ("0", "-1"):
            self.refused(1, scan, "--density=" + number, says=["--density", "above 0"])
        self.refused(1, scan, "--isovalue", "60", "--density", "3", says=["--density", "only fog"])
        part, text = self.bakes(scan, "--volume", "solid")
        self.assertIn("is solid from 40 on, half its greatest value", text)
        self.assertEqual(part["solid_voxels"], 9 ** 3 - 3 ** 3)
        part, _ = self.bakes(scan, "--isovalue", "60")
        self.assertEqual(part["solid_voxels"], 9 ** 3 - 5 ** 3)
        part, _ = self.bakes(scan, "--volume", "solid", "--isovalue", "80")
        self.assertEqual(part["solid_voxels"], 9 ** 3 - 7 ** 3)
        for option, value in (("--grid", "0"),
                              ("--color-grid", "Cd"),
                              ("--heat-grid", "heat"),
                              ("--heat-grid", "none"),
                              ("--ramp", ramp)):
            self.refused(
                1, scan, option, value, says=[option, "only .vdb and .nvdb files have several grids"])
        self.refused(1, scan, "--frame", "0", says=["only MagicaVoxel files have frames"])

        made = self.write(
            "made.binvox",
            b"#binvox 1\ndim 4 4 4\ntranslate 0 0 0\nscale 1\ndata\n" + b"\x01\x10\x00\x20\x01\x10")
        part, _ = self.bakes(made)
        self.assertEqual((part["solid_voxels"], part["size"]), (32, [4, 4, 4]))
        for option, value in (("--volume", "solid"), ("--isovalue", "1"), ("--density", "2")):
            self.refused(
                1, made, option, value, says=[option, "only .vdb, .nvdb and .raw files hold densities"])
        self.refused(1, os.path.join(self.made.name, "fog.vdb"), "--frame", "0",
                     says=["only MagicaVoxel files have frames"])
        self.refused(1, os.path.join(self.made.name, "fog.vdb"), "--parts", "nodes", says=["--parts nodes"])
        self.refused(1, os.path.join(self.made.name, "fog.vdb"), "--at", "walk:1", says=["--at"])

    def test_every_asset(self):
        if not os.path.isdir(ASSETS):
            self.skipTest(f"assets are absent ({ASSETS}): set KELP_ASSETS")
        empty = {"openusd_smoke_000001.vdb": ["all its grids are empty", "'obstacles' (int32"]}
        seen = 0
        for kind in ("vdb", "vox"):
            for folder, _, names in sorted(os.walk(os.path.join(ASSETS, kind))):
                for name in sorted(names):
                    path = os.path.join(folder, name)
                    if not name.endswith("." + kind):
                        continue
                    seen += 1
                    if name in empty:
                        self.refused(5, path, says=empty[name])
                        continue
                    part, text = self.bakes(path)
                    self.assertTrue(part["fill"].startswith("fog") or part["surface_voxels"] > 0, text)
        self.assertGreaterEqual(seen, 9)


if __name__ == "__main__":
    unittest.main()
