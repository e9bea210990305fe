# SPDX-License-Identifier: MIT
"""Shared by the tests of kelp-bake as a build step: a folder of small models, and a kelp-bake that runs in
it."""
import json
import os
import subprocess
import sys
import tempfile
import unittest

from limited import sanitized

KELP_BAKE = os.path.abspath(sys.argv.pop(1))
SANITIZED = sanitized(KELP_BAKE)  # takes five times as long


def box(x, y, z):
    corners = [(a, b, c) for c in (0, z) for b in (0, y) for a in (0, x)]
    faces = ["1 3 4 2", "5 6 8 7", "1 2 6 5", "3 7 8 4", "1 5 7 3", "2 4 8 6"]
    return "".join("v %g %g %g\n" % c for c in corners) + "".join("f %s\n" % f for f in faces)


def lump(n, place=lambda *corner: corner):
    """A box whose sides have n x n quads: enough to keep a bake busy. `place` moves its corners, which run
    from 0 to n."""
    corners, faces = {}, []
    for axis in range(3):
        for side in (0, n):
            for i in range(n):
                for j in range(n):
                    quad = []
                    for di, dj in ((0, 0), (1, 0), (1, 1), (0, 1)):
                        p = [0, 0, 0]
                        p[axis], p[(axis + 1) % 3], p[(axis + 2) % 3] = side, i + di, j + dj
                        quad.append(corners.setdefault(tuple(p), len(corners) + 1))
                    faces.append("f %d %d %d %d" % tuple(quad if side else quad[::-1]))
    return "\n".join(["v %r %r %r" % place(*p) for p in corners] + faces) + "\n"


def textured_box():
    head = "mtllib box.mtl\nusemtl skin\nvt 0 0\nvt 1 0\nvt 1 1\n"
    return head + box(1, 1, 1).replace("f 1 3 4 2\n", "f 1/1 3/2 4/3\nf 1/1 4/3 2/2\n")


# A TGA of one red pixel.
PIXEL = bytes([0, 0, 2, 0, 0, 0, 0, 0, 0, 0, 0, 0, 1, 0, 1, 0, 24, 0, 0, 0, 255])


class Case(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = folder.name
        for i in range(1, 5):
            self.write("%d.obj" % i, box(1, i, 1))

    def path(self, name):
        return os.path.join(self.folder, name)

    def write(self, name, content):
        os.makedirs(os.path.dirname(self.path(name)), exist_ok=True)
        if isinstance(content, (dict, list)):
            content = json.dumps(content)
        with open(self.path(name), "wb") as file:
            file.write(content if isinstance(content, bytes) else content.encode())
        return self.path(name)

    def read(self, name):
        with open(self.path(name), "rb") as file:
            return file.read()

    def bake(self, *arguments, **more):
        return subprocess.run(
            [KELP_BAKE, *arguments], capture_output=True, timeout=120, cwd=self.folder, **more)

    def passes(self, *arguments):
        result = self.bake(*arguments)
        self.assertEqual(result.returncode, 0, result.stderr.decode())
        return result.stderr.decode()

    def fails(self, code, *arguments, says=()):
        """Before anything is baked or made."""
        before = sorted(os.walk(self.folder))
        result = self.bake(*arguments)
        text = result.stderr.decode()
        self.assertEqual(result.returncode, code, text)
        for word in says:
            self.assertIn(word, text)
        self.assertIn(";", text, "names no remedy")
        self.assertEqual(result.stdout, b"")
        self.assertEqual(sorted(os.walk(self.folder)), before)
