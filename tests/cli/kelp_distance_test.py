#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Distances through the programs a user types: kelp-bake puts them into packs, kelp-dump extracts, checks
and compares them. The truth is a separable transform in plain Python.

  kelp_distance_test.py KELP_BAKE KELP_DUMP SOURCE [unittest's options]
"""

import array
import ast
import json
import math
import shutil
import struct
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

OUTSIDE, INSIDE = 36, 9  # squared; of all levels but the last
FAR = 1 << 30


def read_npy(path):
    """The shape, the type and the values of an array, in order."""
    data = Path(path).read_bytes()
    assert data[:8] == b"\x93NUMPY\x01\x00", path
    (size,) = struct.unpack_from("<H", data, 8)
    assert (10 + size) % 64 == 0
    header = ast.literal_eval(data[10 : 10 + size].decode("ascii"))
    assert not header["fortran_order"]
    values = array.array({"|u1": "B", "<f4": "f"}[header["descr"]])
    values.frombytes(data[10 + size :])
    assert len(values) == math.prod(header["shape"])
    return header["shape"], header["descr"], values


def squared_distances(marked, size):
    """From each voxel to the nearest marked one; x fastest."""
    best = [0 if m else FAR for m in marked]
    for axis, stride in ((0, 1), (1, size[0]), (2, size[0] * size[1])):
        n = size[axis]
        for start in range(len(best)):
            if start // stride % n:
                continue
            line = best[start : start + n * stride : stride]
            if min(line) == FAR:
                continue
            best[start : start + n * stride : stride] = [
                min(line[j] + (i - j) * (i - j) for j in range(max(0, i - 16), min(n, i + 17)))
                for i in range(n)]
    return best


def true_distances(occupancy, size, band):
    """Signed distances as `extract --npy` has them, by the definition in SPEC.md."""
    padded = [side + 2 for side in size]
    solid = bytearray(math.prod(padded))
    for z in range(size[2]):
        for y in range(size[1]):
            at = 1 + padded[0] * (y + 1 + padded[1] * (z + 1))
            row = size[0] * (y + size[1] * z)
            solid[at : at + size[0]] = bytes(occupancy[row : row + size[0]])
    to_solid = squared_distances(solid, padded)
    to_empty = squared_distances([not s for s in solid], padded)
    out = []
    for z in range(size[2]):
        for y in range(size[1]):
            for x in range(size[0]):
                at = x + 1 + padded[0] * (y + 1 + padded[1] * (z + 1))
                squared, limit, sign = (
                    (to_empty[at], band[1], -1) if solid[at] else (to_solid[at], band[0], 1))
                out.append(sign * (float32(math.sqrt(squared)) - 0.5 if squared <= limit else math.inf))
    return out


def float32(value):
    return struct.unpack("<f", struct.pack("<f", value))[0]


class Case(unittest.TestCase):
    def setUp(self):
        self.folder = Path(tempfile.mkdtemp())
        self.addCleanup(shutil.rmtree, self.folder)

    def run_program(self, *command, code=0):
        done = subprocess.run([str(c) for c in command], capture_output=True, text=True)
        self.assertEqual(done.returncode, code, done.stderr + done.stdout)
        return done

    def bake(self, source, *options, name="out.kelp"):
        pack = self.folder / name
        self.run_program(BAKE, source, "-o", pack, *options)
        return pack

    def info(self, pack):
        return json.loads(self.run_program(DUMP, "info", pack, "--format", "json").stdout)

    def extract(self, pack, level=0):
        folder = self.folder / ("arrays%d" % level)
        self.run_program(DUMP, "extract", pack, "--npy", folder, "--level", level)
        return folder


class Distance(Case):
    def write_ball(self, name="ball.obj", dent=1.0):
        """A ball of quads with a flat side, and a dent that leaves its extent."""
        rings, sides = 12, 18
        lines = []
        for i in range(rings + 1):
            for j in range(sides):
                a, b = math.pi * i / rings, 2 * math.pi * j / sides
                r = dent if (i, j) in ((6, 2), (7, 2), (6, 3)) else 1.0
                lines.append("v %.6f %.6f %.6f" % (r * math.sin(a) * math.cos(b),
                        min(r * math.cos(a), 0.3), 0.6 * r * math.sin(a) * math.sin(b)))
        for i in range(rings):
            for j in range(sides):
                k = (j + 1) % sides
                lines.append("f %d %d %d %d" % tuple(1 + v for v in (i * sides + j, i * sides + k,
                        (i + 1) * sides + k, (i + 1) * sides + j)))
        path = self.folder / name
        path.write_text("\n".join(lines) + "\n")
        return path

    def check_level(self, pack, part, level, band):
        folder = self.extract(pack, level)
        shape, kind, occupancy = read_npy(folder / (part + ".occupancy.npy"))
        self.assertEqual(kind, "|u1")
        other, kind, distance = read_npy(folder / (part + ".distance.npy"))
        self.assertEqual((other, kind), (shape, "<f4"))
        size = shape[::-1]
        expected = true_distances(occupancy, size, band)
        self.assertEqual(list(distance), [float32(d) for d in expected])
        # The gradient: differences of neighbors within the band, normalized.
        other, kind, gradient = read_npy(folder / (part + ".gradient.npy"))
        self.assertEqual((other, kind), (shape + (3,), "<f4"))
        strides = (1, size[0], size[0] * size[1])
        for at in range(0, len(expected), 37):
            wanted = [0.0, 0.0, 0.0]
            if math.isfinite(expected[at]):
                for axis in range(3):
                    place = at // strides[axis] % size[axis]
                    low = expected[at - strides[axis]] if place > 0 else math.inf
                    high = expected[at + strides[axis]] if place + 1 < size[axis] else math.inf
                    if math.isfinite(low) and math.isfinite(high):
                        wanted[axis] = (high - low) / 2
                    elif math.isfinite(high):
                        wanted[axis] = high - expected[at]
                    elif math.isfinite(low):
                        wanted[axis] = expected[at] - low
            length = math.sqrt(sum(v * v for v in wanted))
            for axis in range(3):
                self.assertAlmostEqual(gradient[3 * at + axis], wanted[axis] / length if length > 0 else 0, 5)

    def test_every_level_is_exact(self):
        pack = self.bake(self.write_ball(), "--resolution", 40)
        levels = self.info(pack)["parts"][0]["levels"]
        self.assertEqual(len(levels), 4)
        for level in range(4):
            self.check_level(pack, "ball", level, (225, 28) if level == 3 else (OUTSIDE, INSIDE))
        said = self.run_program(DUMP, "verify", "--deep", pack).stdout
        self.assertIn("sound (1 part, 4 levels, clearances, levels and distances recomputed)", said)
        said = self.run_program(DUMP, "verify", pack).stdout
        self.assertIn("--deep recomputes clearances, levels and distances as well", said)

    def test_levels_go_on_beyond_those_of_the_voxels(self):
        pack = self.bake(self.write_ball(), "--resolution", 40, "--levels", 1)
        part = self.info(pack)["parts"][0]
        self.assertEqual((len(part["levels"]), part["distances"]["levels"]), (1, 4))
        for level in range(4):
            self.check_level(pack, "ball", level, (225, 28) if level == 3 else (OUTSIDE, INSIDE))
        # They are solid where any of the eight voxels below is.
        for level in range(1, 4):
            fine_shape, _, fine = read_npy(self.folder / ("arrays%d" % (level - 1)) / "ball.occupancy.npy")
            shape, _, occupancy = read_npy(self.folder / ("arrays%d" % level) / "ball.occupancy.npy")
            expected = bytearray(math.prod(shape))
            for at, solid in enumerate(fine):
                z, y, x = (at // fine_shape[2] // fine_shape[1], at // fine_shape[2] % fine_shape[1],
                           at % fine_shape[2])
                expected[x // 2 + shape[2] * (y // 2 + shape[1] * (z // 2))] |= solid
            self.assertEqual(bytes(occupancy), bytes(expected))
        self.run_program(DUMP, "extract", pack, "--npy", self.folder / "x", "--level", 4, code=1)
        self.run_program(DUMP, "extract", pack, "--vox", self.folder / "x", "--level", 1, code=1)
        self.run_program(DUMP, "verify", "--deep", pack)

    def test_they_can_be_left_out(self):
        source = self.write_ball()
        full, bare = self.bake(source), self.bake(source, "--no-distance", name="bare.kelp")
        self.assertNotIn("distances", self.info(bare)["parts"][0])
        self.assertFalse(self.info(bare)["info"]["options"]["distance"])
        kinds = {chunk["kind"] for chunk in self.info(bare)["chunks"]}
        self.assertEqual({c["kind"] for c in self.info(full)["chunks"]} - kinds, {"DGRD", "DIST"})
        said = self.run_program(DUMP, "diff", full, bare, code=7).stdout
        self.assertIn("distances in A alone", said)
        folder = self.folder / "bare"
        said = self.run_program(DUMP, "extract", bare, "--npy", folder).stderr
        self.assertIn("no distances", said)
        self.assertEqual([p.name for p in folder.iterdir()], ["ball.occupancy.npy"])
        self.run_program(DUMP, "verify", "--deep", bare)

    def test_deep_verification_finds_what_contradicts_the_voxels(self):
        # The distances of one ball beside the voxels of another: the reader alone cannot tell.
        a = self.bake(self.write_ball("a.obj"), "--resolution", 32, name="a.kelp").read_bytes()
        b = self.bake(self.write_ball("b.obj", dent=0.7), "--resolution", 32, name="b.kelp").read_bytes()
        lie = self.folder / "lie.kelp"
        lie.write_bytes(mixed(a, b))
        self.run_program(DUMP, "verify", lie)
        said = self.run_program(DUMP, "verify", "--deep", lie, code=3)
        self.assertIn("509", said.stdout + said.stderr)
        self.assertIn("squared distance", said.stdout + said.stderr)
        said = self.run_program(DUMP, "diff", lie, self.folder / "a.kelp", code=7).stdout
        self.assertIn("at another distance, first at", said)


def mixed(voxels, distances):
    """A pack with the voxels of one and the distances of another of the same grids."""
    from xxh3 import xxh3_64

    def chunks(data):
        (count,) = struct.unpack_from("<I", data, 24)
        entries = [struct.unpack_from("<4sIIIQQQQ", data, 64 + 48 * i) for i in range(count)]
        return [(e, data[e[4] : e[4] + e[5]]) for e in entries]

    kept = [c for c in chunks(voxels) if c[0][0] not in (b"DGRD", b"DIST")]
    kept += [c for c in chunks(distances) if c[0][0] in (b"DGRD", b"DIST")]
    file = bytearray(64 + 48 * len(kept))
    for i, (entry, content) in enumerate(kept):
        file += bytes(-len(file) % 64)
        struct.pack_into("<4sIIIQQQQ", file, 64 + 48 * i, *entry[:4], len(file), *entry[5:])
        file += content
    file[:24] = voxels[:16] + struct.pack("<Q", len(file))
    struct.pack_into("<I", file, 24, len(kept))
    struct.pack_into("<Q", file, 56, xxh3_64(bytes(file[: 64 + 48 * len(kept)])))
    return bytes(file)


if __name__ == "__main__":
    BAKE, DUMP, SOURCE = (Path(p).resolve() for p in sys.argv[1:4])
    sys.path.insert(0, str(SOURCE / "tests/formats"))
    unittest.main(argv=sys.argv[:1] + sys.argv[4:])
