#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Cages through the programs a user types: kelp-bake makes them, kelp-dump compares them with the voxels.

  kelp_cage_test.py KELP_BAKE KELP_DUMP SOURCE [unittest's options]
"""
import json
import os
import struct
import subprocess
import sys
import unittest

from kelp_bake_case import Case, box, lump

DUMP, SOURCE = (os.path.abspath(sys.argv.pop(1)) for _ in range(2))

ASSETS = os.environ.get("KELP_ASSETS") or os.path.join(SOURCE, "../shared/assets")
REAL = [("mesh/common3d/stanford-bunny.obj", 128), ("mesh/common3d/spot.obj", 64),
        ("gltf/aquarium/fish.glb", 96), ("gltf/draco_testdata/Fox/Fox.gltf", 96)]


def boxes(sizes_and_places):
    """Boxes at places along x."""
    lines = []
    for i, (obj, x) in enumerate(sizes_and_places):
        for word, *rest in map(str.split, obj.splitlines()):
            if word == "v":
                lines.append("v %g %s %s" % (float(rest[0]) + x, rest[1], rest[2]))
            else:
                lines.append(" ".join(["f", *(str(int(corner) + 8 * i) for corner in rest)]))
    return "\n".join(lines) + "\n"


def comb(teeth):
    """A bar with teeth as wide as the gaps between them."""
    return boxes([(box(2 * teeth - 1, 1, 1), 0)] + [(box(1, 6, 1), 2 * i) for i in range(teeth)])


class Cages(Case):
    def dump(self, *arguments):
        result = subprocess.run([DUMP, *arguments, self.path("out.kelp")], capture_output=True, timeout=300)
        self.assertEqual(result.returncode, 0, (result.stdout + result.stderr).decode())
        return result.stdout

    def baked(self, path, *options):
        """The cages of the pack's only part, and the bytes of its chunks by kind."""
        self.passes(path, "-o", "out.kelp", *options)
        self.dump("verify", "--deep")
        info = json.loads(self.dump("info", "--format", "json"))
        (part,) = info["parts"]
        self.assertEqual(part["bend"], "cage")
        self.assertEqual(part["cage"]["spline"], "sweep")
        return part["cage"], {chunk["kind"]: chunk["stored_bytes"] for chunk in info["chunks"]}

    def test_shapes_in_cells_of_all_sides(self):
        shapes = {"comb.obj": comb(9), "slab.obj": box(8, 32, 1), "lump.obj": lump(3)}
        for name, obj in shapes.items():
            path = self.write(name, obj)
            before = 1 << 32
            for cell in (2, 4, 8, 16):
                cage, _ = self.baked(path, "--resolution", "70", "--bend", "cage", "--cell", str(cell))
                self.assertEqual(cage["cell"], cell)
                self.assertEqual([one["level"] for one in cage["cages"]], list(range(len(cage["cages"]))))
                self.assertLess(cage["cages"][0]["nodes"], before, "finer cells have more nodes")
                before = cage["cages"][0]["nodes"]

    def test_the_teeth_of_a_comb_are_pieces(self):
        cage, _ = self.baked(self.write("comb.obj", comb(9)), "--resolution", "51",
                             "--bend", "cage", "--cell", "16")
        # In 16 columns of voxels stand 3, 3 and 3 of the teeth, 3 wide, and one alone.
        self.assertEqual(cage["cages"][0]["pieces"], 9)

    def test_a_slab_of_one_cell_has_eight_nodes(self):
        cage, _ = self.baked(self.write("cube.obj", box(1, 1, 1)), "--resolution", "8", "--bend", "cage")
        self.assertEqual([(one["cells"], one["nodes"], one["faces"]) for one in cage["cages"]], [(1, 8, 12)])

    def test_the_rig_of_a_pack_makes_the_same_cage(self):
        """Chunks are equal byte by byte; INFO apart, which says by which options they were made."""
        path = self.write("comb.obj", comb(5))
        for cell in (None, 2, 4, 8, 16):
            options = ["--cell", str(cell)] if cell else []
            self.baked(path, "--resolution", "40", "--rig", "sway", "--bend", "cage", *options)
            before, rig = self.chunks(), self.dump("rig")
            self.assertEqual(json.loads(rig)["cell"], cell or 8)
            written = self.write("again.rig.json", rig)
            for others in ([], ["--bend", "shear"], ["--cell", "2" if cell != 2 else "16"]):
                self.baked(path, "--resolution", "40", "--rig", written, *others)
                self.assertEqual(self.chunks(), before)
                self.assertEqual(self.dump("rig"), rig)

    def chunks(self):
        """The bytes of the pack's chunks as they are stored, by kind, level and part."""
        pack = self.read(self.path("out.kelp"))
        (count,) = struct.unpack_from("<I", pack, 24)
        chunks = {}
        for i in range(count):
            kind, _, a, b, offset, stored = struct.unpack_from("<4sIIIQQ", pack, 64 + 48 * i)
            chunks[kind, a, b] = pack[offset : offset + stored]
        del chunks[b"INFO", 0, 0]
        return chunks

    def test_cages_that_readers_would_refuse_are_refused_early(self):
        # Plates of 4 voxels: some 900,000 cells of 2.
        plates = self.write("plates.obj", boxes([(box(1, 60, 60), 2 * i) for i in range(30)]))
        rig = self.write("two.rig.json", {"kelp": 1, "bend": "cage", "cell": 2})
        for options, word in ((["--bend", "cage", "--cell", "2"], "--cell %d"),
                              (["--rig", rig], '"cell": %d')):
            result = self.bake(plates, "-o", "out.kelp", "--resolution", "240", *options)
            self.assertEqual(result.returncode, 5)
            self.assertIn(("cages of " + word % 2).encode(), result.stderr)
            self.assertIn((word % 4 + " fits").encode(), result.stderr)
        self.baked(plates, "--resolution", "240", "--bend", "cage", "--cell", "4")

    def test_real_files(self):
        if not os.path.isdir(ASSETS):
            self.skipTest("no assets in %s; set KELP_ASSETS" % ASSETS)
        for name, resolution in REAL:
            with self.subTest(name):
                path = os.path.join(ASSETS, name)
                cage, bytes_of = self.baked(path, "--resolution", str(resolution), "--rig", "none",
                                            "--bend", "cage")
                # Some 50 bytes are of the table, which weighs where a whole model has a thousand.
                self.assertLess(bytes_of["CAGE"] - 50, (bytes_of["BRCK"] + bytes_of["GRID"]) / 10)
                self.assertGreater(cage["cages"][0]["cells"], 40)

    def test_a_skin_has_one_anyway(self):
        fox = os.path.join(ASSETS, "gltf/draco_testdata/Fox/Fox.gltf")
        if not os.path.exists(fox):
            self.skipTest("no assets in %s; set KELP_ASSETS" % ASSETS)
        for options in ((), ("--bend", "cage")):
            self.passes(fox, "-o", "out.kelp", "--resolution", "48", "--cell", "8", *options)
            self.dump("verify", "--deep")
            body, *joints = json.loads(self.dump("info", "--format", "json"))["parts"]
            self.assertEqual((body["bend"], body["cage"]["cell"]), ("cage", 8))
            self.assertGreater(len(body["cage"]["follows"]), 10)
            self.assertEqual({joint["kind"] for joint in joints}, {"empty"})


if __name__ == "__main__":
    unittest.main()
