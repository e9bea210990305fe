#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""kelp-bake as a shell sees it: exit codes, one-line errors, outputs that stay whole.

Usage: kelp_bake_test.py KELP_BAKE [unittest options]"""
import json
import os
import re
import resource
import signal
import struct
import subprocess
import tempfile
import unittest

from kelp_bake_case import KELP_BAKE, SANITIZED, box, lump

CUBE = """v 0 0 0
v 1 0 0
v 1 2 0
v 0 2 0
v 0 0 1
v 1 0 1
v 1 2 1
v 0 2 1
f 1 4 3 2
f 5 6 7 8
f 1 2 6 5
f 4 8 7 3
f 1 5 8 4
f 2 3 7 6
"""


def wavy_obj(n):
    """A closed lump of 12 n^2 triangles."""
    def place(*corner):
        x, y, z = (2 * c / n - 1 for c in corner)
        scale = 1 + 0.2 * ((x * 7) % 1) / (1 + x * x + y * y + z * z)
        return x * scale, y * scale, z * scale

    return lump(n, place)


class KelpBake(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.TemporaryDirectory()
        self.addCleanup(self.folder.cleanup)
        self.cube = self.write("cube.obj", CUBE)
        self.out = self.path("out.kelp")

    def path(self, name):
        return os.path.join(self.folder.name, name)

    def write(self, name, content):
        with open(self.path(name), "wb") as file:
            file.write(content if isinstance(content, bytes) else content.encode())
        return self.path(name)

    def bake(self, *arguments):
        return subprocess.run([KELP_BAKE, *arguments], capture_output=True, timeout=120)

    def read(self, path):
        with open(path, "rb") as file:
            return file.read()

    def fails(self, code, *arguments, says=()):
        """Fails with the code, and one line on stderr that names a remedy and holds all of `says`. Keeps an
        existing output and leaves nothing else."""
        self.write("out.kelp", b"the pack that was there")
        before = sorted(os.listdir(self.folder.name))
        result = self.bake(*arguments)
        text = result.stderr.decode()
        self.assertEqual(result.returncode, code, text)
        self.assertEqual(result.stdout, b"")
        # The memory that it needs may be printed before.
        text = re.sub(r"^kelp-bake: .*: baking needs about [0-9.]+ .iB of memory\n", "", text)
        self.assertTrue(
            text.startswith("kelp-bake: ") and text.count("\n") == 1 and text.endswith("\n"), text)
        self.assertIn(";", text, "names no remedy: " + text)
        for word in says:
            self.assertIn(word, text)
        self.assertEqual(self.read(self.out), b"the pack that was there")
        self.assertEqual(sorted(os.listdir(self.folder.name)), before)

    def test_bakes_a_cube(self):
        result = self.bake(self.cube, "-o", self.out, "--report", self.path("report.json"), "-MD")
        text = result.stderr.decode()
        self.assertEqual(result.returncode, 0, text)
        self.assertEqual(result.stdout, b"")
        self.assertIn("128 (default; --resolution N to change)", text)
        self.assertIn("64 x 128 x 64", text)
        self.assertNotIn("\x1b", text, "color or a bar although stderr is no terminal")
        self.assertEqual(
            sorted(os.listdir(self.folder.name)), ["cube.obj", "out.kelp", "out.kelp.d", "report.json"])
        report = json.loads(self.read(self.path("report.json")))
        self.assertEqual(report["parts"][0]["size"], [64, 128, 64])
        self.assertEqual(report["parts"][0]["solid_voxels"], 64 * 128 * 64)
        self.assertTrue(report["parts"][0]["closed"])
        self.assertEqual(report["pack_bytes"], os.path.getsize(self.out))
        rule = self.read(self.path("out.kelp.d")).decode()
        self.assertTrue(rule.startswith(self.out + ":"))
        self.assertIn("cube.obj", rule)

    def test_names_that_are_no_text_or_long(self):
        for name in (b"\xfe.obj", b"a\xc3", b"\xed\xa0\x80", ("\u7532" * 60).encode(), b"\xc2\x9b31m",
                     b"a\tb", b"x" * 240):
            with open(os.path.join(os.fsencode(self.folder.name), name + b".obj"), "wb") as file:
                file.write(CUBE.encode())
            result = subprocess.run(
                [KELP_BAKE, os.path.join(os.fsencode(self.folder.name), name + b".obj"), "-o",
                 os.path.join(os.fsencode(self.folder.name), name[:80] + b".kelp"), "--resolution", "4"],
                capture_output=True)
            self.assertEqual(result.returncode, 0, result.stderr)
        result = self.bake(self.cube, "-o", self.path("x" * 256))
        self.assertEqual(result.returncode, 2)
        self.assertNotIn(b"baking needs", result.stderr, "found only after the work")
        self.assertEqual(self.bake(self.cube, "-o", self.path("x" * 250), "--resolution", "4").returncode, 0)

    def test_voxel_models_keep_their_voxels(self):
        def chunk(name, content):
            return name + struct.pack("<2i", len(content), 0) + content
        apart = b"".join((chunk(b"SIZE", struct.pack("<3i", 3, 2, 4)),
                          chunk(b"XYZI", struct.pack("<i", 2) + b"\x00\x00\x00\x07\x02\x01\x03\xff"),
                          chunk(b"nTRN", struct.pack("<7i", 0, 0, 1, -1, -1, 1, 0)),
                          chunk(b"nGRP", struct.pack("<5i", 1, 0, 2, 2, 4)),
                          chunk(b"nTRN", struct.pack("<7i", 2, 0, 3, -1, -1, 1, 0)),
                          chunk(b"nSHP", struct.pack("<5i", 3, 0, 1, 0, 0)),
                          chunk(b"nTRN", struct.pack("<8i", 4, 0, 3, -1, -1, 1, 1, 2) + b"_t"
                                         + struct.pack("<i", 14) + b"4000 4000 4000")))
        near = apart.replace(b"4000 4000 4000", b"0004 0000 0000")
        head = b"VOX " + struct.pack("<i", 150) + b"MAIN" + struct.pack("<2i", 0, len(near))
        model = self.write("model.vox", head + near)
        result = self.bake(model, "-o", self.out, "--unit", "cm", "--report", self.path("report.json"))
        text = result.stderr.decode()
        self.assertEqual(result.returncode, 0, text)
        self.assertIn("the file's own voxels", text)
        self.assertIn("voxels of 0.01 m", text)
        report = json.loads(self.read(self.path("report.json")))
        self.assertEqual(report["parts"][0]["size"], [7, 4, 2])
        self.assertEqual(report["parts"][0]["solid_voxels"], 4)
        self.assertEqual(report["palette_entries"], 256)
        self.assertEqual(
            self.bake(model, "-o", self.out, "--parts", "nodes", "--voxel-size", "0.5").returncode, 0)
        self.assertEqual(self.bake(model, "-o", self.out, "--frame", "0").returncode, 0)
        result = self.bake(model, "-o", self.out, "--resolution", "64")
        self.assertEqual(result.returncode, 0)
        self.assertIn("the file's own voxels", result.stderr.decode())
        self.assertIn("--resolution 64 is not used", result.stderr.decode())
        self.fails(1, model, "-o", self.out, "--frame", "1", says=["--frame 1", "no animation"])
        self.fails(1, model, "-o", self.out, "--frame", "one", says=["--frame one"])
        self.fails(1, self.cube, "-o", self.out, "--frame", "0", says=["only MagicaVoxel files have frames"])
        self.fails(1, model, "-o", self.out, "--parts", "nodes", "--rig", "sway", says=["--parts nodes"])
        self.fails(1, model, "-o", self.out, "--at", "walk:1", says=["--at"])
        far = self.write("far.vox", head + apart)
        self.fails(4, far, "-o", self.out, "--max-memory", "1G", says=["GiB of memory"])
        self.assertEqual(
            self.bake(far, "-o", self.out, "--max-memory", "1G", "--parts", "nodes").returncode, 0)

    def test_many_colors_of_one_material_are_colors(self):
        lines = CUBE.splitlines()
        painted = [line + line[1:].replace("2", "1") if line.startswith("v") else line for line in lines]
        model = self.write("painted.obj", "\n".join(painted) + "\n")
        result = self.bake(model, "-o", self.out, "--resolution", "32", "--report", self.path("report.json"))
        text = result.stderr.decode()
        self.assertEqual(result.returncode, 0, text)
        self.assertIn("1 material,", text)
        self.assertIn("more than 256 colors: the palette is off by", text)
        report = json.loads(self.read(self.path("report.json")))
        self.assertEqual((report["materials"], report["palette_entries"]), (1, 256))

    def test_same_input_same_bytes(self):
        model = self.write("lump.obj", wavy_obj(20))
        packs = []
        for threads in (1, 2, 4):
            result = self.bake(
                model, "-o", self.out, "--threads", str(threads), "--resolution", "60", "--rig", "sway")
            self.assertEqual(result.returncode, 0, result.stderr)
            packs.append(self.read(self.out))
        self.assertEqual(packs[0], packs[1])
        self.assertEqual(packs[0], packs[2])
        os.mkdir(self.path("elsewhere"))
        os.rename(model, self.path("elsewhere/lump.obj"))
        self.bake(self.path("elsewhere/lump.obj"), "-o", self.out, "--resolution", "60", "--rig", "sway")
        self.assertEqual(packs[0], self.read(self.out), "the pack depends on where its source lay")

    def test_help_and_version(self):
        result = self.bake("--help")
        self.assertEqual(result.returncode, 0)
        self.assertIn(b"Examples:", result.stdout)
        self.assertEqual(result.stderr, b"")
        self.assertRegex(self.bake("--version").stdout,
                         rb"^kelp-bake \d+\.\d+\.\d+ \(format \d+\.\d+, OpenVDB \d+\..*, "
                         rb"Draco \d+\..*, Highway (yes|no), \w+ \d+\..*\)\n"
                         rb"Bakes are (contained by .*|not contained: .*)\.\n$")

    def test_usage(self):
        self.fails(1, "--resolution", "128", says=["--help"])
        self.fails(1, self.cube, says=["--output is required"])
        self.fails(1, self.cube, "-o", self.out, "--resolution", "8", "--voxel-size", "1",
                   says=["--resolution", "--voxel-size"])
        self.fails(1, self.cube, "-o", self.out, "--up", "", says=["--up: is empty"])
        self.fails(1, self.cube, "-o", self.out, "--nonsense", says=["--nonsense"])
        self.fails(1, self.cube, "-o", self.out, "--parts", "all", says=["--parts all", "nodes"])
        self.fails(1, self.cube, "-o", self.out, "--parts", "nodes", says=["OBJ", "--parts nodes"])
        for moment in ("Walk", "Walk:", ":1", "Walk:-1", "Walk:nan", "Walk:1s"):
            self.fails(1, self.cube, "-o", self.out, "--at", moment, says=["--at " + moment, "Walk:0.3"])
        self.fails(1, self.cube, "-o", self.out, "--at", "Walk:0.3", says=["OBJ", "--at"])
        self.fails(1, self.cube, "-o", self.out, "--resolution", "0", says=["--resolution 0", "8192"])
        self.fails(3, self.write("vast.obj", "v 0 0 0\nv 1e30 0 0\nv 0 1e30 0\nf 1 2 3\n"), "-o", self.out,
                   says=["vast.obj", "scale"])
        self.fails(1, self.cube, "-o", self.out, "--voxel-size", "1e-7", says=["8192"])
        self.fails(1, self.cube, "-o", self.out, "--up", "z up", says=["--up z up", "+z"])
        self.fails(1, self.cube, "-o", self.out, "--unit", "furlong", says=["--unit furlong", "mm"])
        self.fails(1, self.cube, "-o", self.out, "--pad", "2.5", says=["--pad 2.5"])
        self.fails(1, self.cube, "-o", self.out, "--pad", "5000", says=["--pad 5000", "1024"])
        self.fails(1, self.cube, "-o", self.out, "--levels", "0", says=["--levels"])
        self.fails(1, self.cube, "-o", self.out, "--fill", "half", says=["half"])
        self.fails(1, self.cube, "-o", self.out, "--axis", "up", says=["up"])
        self.fails(1, self.cube, "-o", self.out, "--bend", "twist",
                   says=["--bend twist", "shear, sweep or cage"])
        for cell in ("0", "1", "3", "32", "-8", "2147483648", "eight"):
            self.fails(1, self.cube, "-o", self.out, "--bend", "cage", "--cell", cell,
                       says=["--cell " + cell])
        for size in ("lots", "0", "-1", "nan", "inf", "-4G", "1e300G", "4X", "NaNG"):
            self.fails(1, self.cube, "-o", self.out, "--max-memory", size, says=["--max-memory " + size])
        for number in (
                "many", "nan", "-5", "1e9", "99999999999999999999", "2147483648", "128.5", "0x80"):
            self.fails(1, self.cube, "-o", self.out, "--resolution", number, says=["--resolution " + number])
        for number in ("0", "-1", "nan", "inf", "1e-300", "1e999"):
            self.fails(1, self.cube, "-o", self.out, "--voxel-size", number, says=["--voxel-size"])

    def test_options_that_are_gone_name_what_to_use(self):
        for words, instead in ((["--manifest", "m.json"], "samples/farm"),
                               (["@models.txt", "-o", self.out], "samples/farm"),
                               (["@models.txt"], "samples/farm"),
                               (["--manifest=m.json", "--plan"], "samples/farm"),
                               ([self.cube, "-o", self.out, "--shard", "1/2"], "samples/farm"),
                               ([self.cube, "-o", self.out, "--cache", "c"], "-MD"),
                               ([self.cube, "-o", self.out, "--cache-size=1G"], "-MD"),
                               ([self.cube, "-o", self.out, "--force"], "is gone"),
                               ([self.cube, "-o", self.out, "--config", "c.toml"], "command line"),
                               (["--print-config"], "--help")):
            self.fails(1, *words, says=["is gone", instead])
        done = self.bake(self.cube, "-o", self.out, "--resolution", "4", "-MD", "-MT", "--force")
        self.assertEqual(done.returncode, 0, done.stderr)
        self.write("@odd.obj", CUBE)
        self.assertEqual(subprocess.run([KELP_BAKE, "./@odd.obj", "-o", "out.kelp", "--resolution", "4"],
                                        cwd=self.folder.name, capture_output=True).returncode, 0)

    def test_files_that_have_no_name_or_are_pipes(self):
        os.mkfifo(self.path("pipe.obj"))
        self.fails(2, self.path("pipe.obj"), "-o", self.out, says=["write it to a file first"])
        self.fails(2, self.cube, "-o", self.out, "--rig", self.path("pipe.obj"),
                   says=["write it to a file first"])
        for words in (["-", "-o", self.out], [self.cube, "-o", "-"],
                      [self.cube, "-o", self.out, "--report", "-"], [self.cube, "-o", self.out, "-MF", "-"]):
            self.fails(1, *words, says=[" -: is no file"])

    def test_how_parts_bend(self):
        def baked(*arguments):
            result = self.bake(self.cube, "-o", self.out, "--resolution", "16", "--report",
                               self.path("report.json"), *arguments)
            self.assertEqual(result.returncode, 0, result.stderr.decode())
            part = json.loads(self.read(self.path("report.json")))["parts"][0]
            return part["bend"], round(part["roll"], 4)

        self.assertEqual(baked(), ("shear", 0))
        self.assertEqual(baked("--bend", "sweep"), ("sweep", 0))
        self.assertEqual(baked("--bend", "sweep", "--rig", "sway"), ("sweep", 0))
        rig = self.write("r.rig.json", '{"kelp": 1, "bend": "sweep", "roll": 30}')
        self.assertEqual(baked("--rig", rig), ("sweep", 30))
        self.assertEqual(baked("--rig", rig, "--bend", "shear"), ("sweep", 30), "the rig says it")
        rig = self.write("r.rig.json", '{"kelp": 1, "bend": "shear"}')
        self.assertEqual(baked("--rig", rig, "--bend", "sweep"), ("shear", 0), "the rig says it")
        self.assertEqual(baked("--bend", "cage"), ("cage", 0))
        self.assertEqual(baked("--bend", "cage", "--cell", "2", "--rig", "sway"), ("cage", 0))
        self.assertEqual(baked("--rig", rig, "--bend", "cage"), ("shear", 0), "the rig says it")
        rig = self.write("r.rig.json", '{"kelp": 1, "bend": "cage", "roll": 30}')
        self.assertEqual(baked("--rig", rig, "--bend", "shear"), ("cage", 30), "the rig says it")
        self.fails(1, self.cube, "-o", self.out, "--cell", "4", says=["--cell 4", "--bend cage"])
        self.fails(1, self.cube, "-o", self.out, "--bend", "cage", "--cell", "2", "--resolution", "513",
                   says=["513 voxels", "256 cells of --cell 2", "--cell 4 fits"])
        needle = self.write("needle.obj", box(1, 100, 1))
        self.fails(1, needle, "-o", self.out, "--bend", "cage", "--resolution", "4097",
                   says=["--cell 8", "--resolution of at most 4096"])
        # The cube is half as wide as it is tall.
        turns = '{"kelp": 1, "bend": "sweep", "knots": [{"at": 0}, {"at": 1, "tangent": [9, -9, 0]}]}'
        self.fails(3, self.cube, "-o", self.out, "--rig", self.write("r.rig.json", turns),
                   says=["knot 0", "r.rig.json", "may not fold"])
        folds = ('{"kelp": 1, "clips": {"nod": {"waves": ['
                 '{"knot": 1, "tangent": [0, 1.5, 0], "period": 2}]}}}')
        self.fails(3, self.cube, "-o", self.out, "--bend", "sweep", "--rig", self.write("r.rig.json", folds),
                   says=["clip 'nod'", "knot 0", "may not fold"])
        self.fails(3, self.cube, "-o", self.out, "--rig",
                   self.write("r.rig.json", '{"kelp": 1, "roll": 30}'), says=["/roll", "sweep"])

    def test_nothing_that_is_read_is_overwritten(self):
        material = self.write("cube.mtl", "newmtl red\nKd 1 0 0\n")
        cube = self.write("cube.obj", "mtllib cube.mtl\nusemtl red\n" + CUBE)
        rig = self.write("cube.rig.json", '{"kelp": 1}')
        os.symlink(material, self.path("link"))
        os.link(material, self.path("hard.mtl"))
        os.mkdir(self.path("sub"))
        before = {path: self.read(path) for path in (cube, material, rig)}
        for victim in (
                cube, material, rig, self.path("link"), self.path("hard.mtl"), self.path("sub/../cube.mtl")):
            self.fails(1, cube, "-o", victim, "--resolution", "8", says=["-o " + victim, "cube."])
            self.fails(1, cube, "-o", self.out, "--resolution", "8", "--report", victim,
                       says=["--report " + victim, "cube."])
            self.fails(
                1, cube, "-o", self.out, "--resolution", "8", "-MF", victim, says=["-MF " + victim, "cube."])
            self.assertEqual({path: self.read(path) for path in before}, before)
        other = self.write("other.json", '{"kelp": 1}')
        self.fails(1, cube, "-o", self.out, "--rig", other, "--report", other, says=["--report " + other])
        self.assertEqual(self.read(other), b'{"kelp": 1}')

    def test_no_output_is_another(self):
        os.symlink("fresh.json", self.path("link"))
        fresh = self.path("fresh.json")
        self.fails(1, self.cube, "-o", self.out, "--report", self.out, says=["--report", "-o"])
        self.fails(1, self.cube, "-o", self.out, "-MF", self.out, says=["-MF", "-o"])
        self.fails(1, self.cube, "-o", self.out, "-MD", "--report", self.out + ".d", says=["-MF", "--report"])
        self.fails(1, self.cube, "-o", self.out, "--report", fresh, "-MF", self.path("./fresh.json"),
                   says=["-MF", "--report"])
        self.fails(1, self.cube, "-o", self.out, "--report", fresh, "-MF", self.path("link"),
                   says=["-MF", "--report"])
        result = self.bake(
            self.cube, "-o", self.out, "--resolution", "8", "--report", "/dev/null", "-MF", "/dev/null")
        self.assertEqual(result.returncode, 0, result.stderr)

    def test_files(self):
        self.fails(2, self.path("absent.obj"), "-o", self.out, says=["absent.obj"])
        self.fails(
            2, self.cube, "-o", os.path.join(self.cube, "out.kelp"), says=["out.kelp", "Not a directory"])
        self.fails(
            2, self.cube, "-o", self.path("no/such/folder/out.kelp"), says=["No such file or directory"])
        self.fails(2, self.cube, "-o", self.folder.name, says=["is a folder"])
        self.fails(2, self.cube, "-o", "/dev/full", says=["/dev/full"])
        self.fails(2, self.cube, "-o", "/proc/out.kelp", says=["/proc/out.kelp"])
        self.fails(
            2, self.cube, "-o", self.out, "--rig", self.path("absent.rig.json"), says=["absent.rig.json"])

    def test_reports_and_rules_are_checked_before_the_bake(self):
        for option in ("--report", "-MF"):
            self.fails(2, self.cube, "-o", self.out, option, self.path("none/x"),
                       says=["none/x", "No such file or directory"])
            self.fails(2, self.cube, "-o", self.out, option, self.folder.name, says=["is a folder"])

    def test_invalid_input(self):
        self.fails(3, self.write("empty.obj", ""), "-o", self.out, says=["empty.obj", "is empty"])
        self.fails(3, self.write("empty.glb", ""), "-o", self.out, says=["empty.glb", "is empty"])
        self.fails(3, self.write("empty.vdb", ""), "-o", self.out, says=["empty.vdb", "is empty"])
        self.fails(5, self.write("points.obj", "v 0 0 0\nv 1 0 0\n"), "-o", self.out, says=["points.obj"])
        self.fails(
            3, self.write("cut.glb", b"glTF" + struct.pack("<II", 2, 100)), "-o", self.out, says=["cut.glb"])
        self.fails(3, self.write("not.vdb", b"no volume at all"), "-o", self.out, says=["not.vdb"])
        result = self.bake(self.write("model.blend", "BLENDER"), "-o", self.out)
        self.assertIn(result.returncode, (1, 3, 5), result.stderr)
        self.assertIn(b"model.blend", result.stderr)
        turning = {"kelp": 1, "knots": [{"at": 0, "tangent": [0, -3, 0]}, {"at": 1}]}
        self.fails(3, self.cube, "-o", self.out, "--rig", self.write("turning.rig.json", json.dumps(turning)),
                   says=["cube"])
        self.fails(3, self.cube, "-o", self.out, "--rig", self.write("broken.rig.json", "{"),
                   says=["broken.rig.json"])
        wild = {"kelp": 1, "clips": {"wild": {"waves": [{"knot": 1, "offset": [0, 5, 0], "period": 1}]}}}
        self.fails(3, self.cube, "-o", self.out, "--rig", self.write("wild.rig.json", json.dumps(wild)),
                   says=["wild"])

    def test_memory_is_refused_before_the_work(self):
        self.fails(4, self.cube, "-o", self.out, "--resolution", "2048", "--max-memory", "64M",
                   says=["GiB", "64.0 MiB", "--max-memory"])

    def test_the_resolution_that_is_said_to_fit_fits(self):
        refused = self.bake(
            self.cube, "-o", self.out, "--resolution", "4000", "--max-memory", "60M").stderr.decode()
        advised = int(re.search(r"--resolution (\d+) would fit", refused).group(1))
        for more in (advised + 1, advised + advised // 20, advised + advised // 10):
            self.fails(4, self.cube, "-o", self.out, "--resolution", str(more), "--max-memory", "60M",
                       says=["--resolution %d would fit" % advised])
        fits = self.bake(self.cube, "-o", self.out, "--resolution", str(advised), "--max-memory", "60M",
                         "--report", self.path("report.json"))
        self.assertEqual(fits.returncode, 0, fits.stderr)
        if SANITIZED:
            return  # it keeps memory of its own
        report = json.loads(self.read(self.path("report.json")))
        peak = max(stage["peak_bytes"] for stage in report["stages"])
        self.assertLess(peak, report["estimated_bytes"], report)
        self.assertLess(report["estimated_bytes"], 2 * peak, report)
        lines = fits.stderr.decode().splitlines()
        self.assertRegex(lines[0], r"^kelp-bake: cube.obj: baking needs about [0-9.]+ MiB of memory$")

    def test_the_voxels_that_are_said_to_fit_fit(self):
        refused = self.bake(
            self.cube, "-o", self.out, "--voxel-size", "0.00001", "--unit", "cm", "--max-memory", "60M")
        self.assertEqual(refused.returncode, 4, refused.stderr)
        advised = re.search(r"--voxel-size (\S+) would fit", refused.stderr.decode()).group(1)
        self.fails(4, self.cube, "-o", self.out, "--voxel-size", str(0.98 * float(advised)), "--unit", "cm",
                   "--max-memory", "60M", says=["--voxel-size"])
        fits = self.bake(
            self.cube, "-o", self.out, "--voxel-size", advised, "--unit", "cm", "--max-memory", "60M")
        self.assertEqual(fits.returncode, 0, fits.stderr)
        self.fails(4, self.cube, "-o", self.out, "--resolution", "128", "--max-memory", "1M",
                   says=["1.0 MiB", "no resolution would fit"])

    def test_padding_that_is_too_large_is_named(self):
        wide = [self.cube, "-o", self.out, "--resolution", "16", "--max-memory", "48M", "--pad"]
        refused = self.bake(*wide, "1000").stderr.decode()
        self.assertIn("--pad 0 would fit", refused)
        self.assertEqual(self.bake(*wide, "0").returncode, 0)
        self.fails(4, self.cube, "-o", self.out, "--resolution", "2000", "--max-memory", "48M", "--pad",
                   "1000", says=["with --pad 0 --resolution "])

    def test_faces_from_both_sides_enclose_nothing(self):
        """Each quad once more, turned: it is cut along its other diagonal, and no triangle is there twice."""
        lines = CUBE.splitlines()
        turned = ["f " + " ".join(reversed(line.split()[1:])) for line in lines if line.startswith("f ")]
        both = self.write("both.obj", "\n".join(lines + turned))
        result = self.bake(both, "-o", self.out, "--report", self.path("r.json"), "--resolution", "16")
        self.assertIn(b"1 of 1 component closed, 1 encloses nothing (faces from both sides)", result.stderr)
        component, = json.loads(self.read(self.path("r.json")))["parts"][0]["components"]
        self.assertIn("closed, but encloses nothing", component["why"])

    def test_a_link_stays_a_link(self):
        os.symlink("real.kelp", self.path("link.kelp"))
        self.assertEqual(
            self.bake(self.cube, "-o", self.path("link.kelp"), "--resolution", "16").returncode, 0)
        self.assertTrue(os.path.islink(self.path("link.kelp")))
        self.assertTrue(os.path.isfile(self.path("real.kelp")))

    def test_a_replaced_pack_keeps_its_mode(self):
        for mode in (0o600, 0o640, 0o664):
            self.write("out.kelp", b"the pack that was there")
            os.chmod(self.out, mode)
            self.assertEqual(self.bake(self.cube, "-o", self.out, "--resolution", "8").returncode, 0)
            self.assertEqual(os.stat(self.out).st_mode & 0o777, mode)
        os.remove(self.out)
        umask = os.umask(0o022)
        self.assertEqual(self.bake(self.cube, "-o", self.out, "--resolution", "8").returncode, 0)
        os.umask(umask)
        self.assertEqual(os.stat(self.out).st_mode & 0o777, 0o644)

    def test_a_limit_on_the_size_of_files_leaves_nothing_behind(self):
        model = self.write("lump.obj", wavy_obj(20))
        self.write("out.kelp", b"the pack that was there")
        before = sorted(os.listdir(self.folder.name))
        limited = lambda: resource.setrlimit(resource.RLIMIT_FSIZE, (2048, 2048))
        result = subprocess.run([KELP_BAKE, model, "-o", self.out, "--resolution", "60"], capture_output=True,
                                timeout=120, preexec_fn=limited)
        self.assertEqual(result.returncode, 2, result.stderr)
        self.assertIn(b"out.kelp: cannot be written: File too large", result.stderr)
        self.assertEqual(self.read(self.out), b"the pack that was there")
        self.assertEqual(sorted(os.listdir(self.folder.name)), before)

    def test_hangups_that_are_ignored_stay_ignored(self):
        model = self.write("lump.obj", wavy_obj(60))
        ignore = lambda: signal.signal(signal.SIGHUP, signal.SIG_IGN)
        process = subprocess.Popen(
            [KELP_BAKE, model, "-o", self.out, "--resolution", "60" if SANITIZED else "200", "--progress",
             "json"], stderr=subprocess.PIPE, preexec_fn=ignore)
        process.stderr.readline()
        process.send_signal(signal.SIGHUP)
        _, rest = process.communicate(timeout=120)
        self.assertEqual(process.returncode, 0, rest)


if __name__ == "__main__":
    unittest.main()
