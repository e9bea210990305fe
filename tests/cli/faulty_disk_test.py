#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Every call on a file fails once. kelp-bake and kelp-dump answer with exit code 2 and a line that names the
file; or the call did not matter, and the result is whole. An old output stays as it was, and no temporary
file is left.

Usage: faulty_disk_test.py KELP_BAKE|none KELP_DUMP LIBRARY GOLDEN_PACK"""
import errno
import json
import os
import shutil
import subprocess
import sys
import tempfile
import unittest

LIBRARY = sys.argv.pop(3)  # or several, as LD_PRELOAD has them
KELP_BAKE, KELP_DUMP, GOLDEN = (path if path == "none" else os.path.abspath(path) for path in sys.argv[1:4])
KINDS = {"open": errno.EACCES, "read": errno.EIO, "write": errno.ENOSPC, "fsync": errno.EIO,
         "close": errno.ENOSPC, "rename": errno.EIO}
OLD = b"the old one"
# Calls of a kind that are tried, spread over all there are.
AT_MOST = 24 if os.environ.get("KELP_ALL_TESTS") else 4

CUBE = "".join("v %d %d %d\n" % (i & 1, i >> 1 & 1, i >> 2) for i in range(8)) + "".join(
    "f " + " ".join(str(i + 1) for i in quad) + "\n"
    for quad in ((0, 2, 3, 1), (4, 5, 7, 6), (0, 1, 5, 4), (2, 6, 7, 3), (0, 4, 6, 2), (1, 3, 7, 5)))
# A TGA of one red pixel.
PIXEL = bytes([0, 0, 2, 0, 0, 0, 0, 0, 0, 0, 0, 0, 1, 0, 1, 0, 24, 0, 0, 0, 255])


class FaultyDisk(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory(prefix="kelp_faulty_")
        self.addCleanup(folder.cleanup)
        self.folder = os.path.join(folder.name, "disk")
        self.counts = os.path.join(folder.name, "counts")

    def run_in_fresh_folder(self, inputs, outputs, command, fault=""):
        shutil.rmtree(self.folder, ignore_errors=True)
        os.makedirs(self.folder)
        for name, content in inputs.items():
            with open(os.path.join(self.folder, name), "wb") as file:
                file.write(content)
        for name in outputs:
            if name not in inputs:
                os.makedirs(os.path.dirname(os.path.join(self.folder, name)), exist_ok=True)
                with open(os.path.join(self.folder, name), "wb") as file:
                    file.write(OLD)
        environment = dict(os.environ, LD_PRELOAD=LIBRARY, KELP_FAULTY_FOLDER=self.folder,
                           KELP_FAULTY_COUNTS=self.counts, KELP_FAULT=fault)
        result = subprocess.run(command, cwd=self.folder, env=environment, capture_output=True, timeout=60)
        found = {}
        for name in (os.path.relpath(os.path.join(folder, name), self.folder)
                     for folder, _, names in os.walk(self.folder) for name in names):
            with open(os.path.join(self.folder, name), "rb") as file:
                found[name] = file.read()
            if found[name].startswith(b" BDV"):
                found[name] = found[name][:21] + found[name][57:]  # each has an identifier of its own
            if name.endswith(".json") and found[name] != OLD and name not in inputs:
                found[name] = sorted(json.loads(found[name]))  # times and memory differ
        return result, found

    def tries_every_fault(self, inputs, outputs, command, kinds):
        result, whole = self.run_in_fresh_folder(inputs, outputs, command)
        self.assertEqual(result.returncode, 0, result.stderr.decode())
        self.assertEqual(sorted(whole), sorted({*inputs, *outputs}))
        with open(self.counts, encoding="utf-8") as file:
            counts = {kind: int(count) for kind, count in (line.split() for line in file)}
        for kind in kinds:
            self.assertGreater(counts[kind], 0, f"{command}: no {kind} was seen")
        refused = 0
        for kind, error in KINDS.items():
            tried = min(counts[kind], AT_MOST)
            for number in (1 + i * (counts[kind] - 1) // max(tried - 1, 1) for i in range(tried)):
                what = f"{os.path.basename(command[0])} {command[1]}, {kind} {number} of {counts[kind]} fails"
                result, found = self.run_in_fresh_folder(inputs, outputs, command, f"{kind} {number} {error}")
                text = (result.stderr + result.stdout).decode()  # verify reports what it cannot read
                self.assertEqual(sorted(found), sorted(whole), what + ": " + text)
                if result.returncode == 0:
                    self.assertEqual(found, whole, what)
                    continue
                refused += 1
                self.assertEqual(result.returncode, 2, what + ": " + text)
                self.assertRegex(text, r"; |\. (Check|Copy) ", what + ": names no remedy")
                self.assertTrue(any(name in text for name in whole), what + ": names no file: " + text)
                for name in outputs:
                    # Several outputs are replaced one after the other: each is the old or the new one.
                    self.assertIn(found[name], (inputs.get(name, OLD), whole[name]), what)
        self.assertGreater(refused, len(kinds))
        for kind in ("read", "write"):
            result, found = self.run_in_fresh_folder(inputs, outputs, command, f"{kind} short")
            self.assertEqual(result.returncode, 0, f"{command}, short {kind}s: {result.stderr.decode()}")
            self.assertEqual(found, whole, f"{command}, short {kind}s")

    @unittest.skipIf(KELP_BAKE == "none", "no kelp-bake in this build")
    def test_bake(self):
        inputs = {"box.obj": b"mtllib box.mtl\nusemtl skin\n" + CUBE.encode(),
                  "box.mtl": b"newmtl skin\nmap_Kd red.tga\n", "red.tga": PIXEL}
        self.tries_every_fault(
            inputs, ["box.kelp"],
            [KELP_BAKE, "box.obj", "-o", "box.kelp", "--resolution", "8", "--progress", "none"],
            ["open", "read", "write", "fsync", "close", "rename"])

    @unittest.skipIf(KELP_BAKE == "none", "no kelp-bake in this build")
    def test_bake_with_report_and_rules(self):
        inputs = {"box.obj": CUBE.encode(),
                  "box.rig.json": b'{"kelp": 1, "axis": "+y", "knots": [{"at": 0}, {"at": 1}]}'}
        self.tries_every_fault(inputs, ["box.kelp", "box.json", "box.d"],
                               [KELP_BAKE, "box.obj", "-o", "box.kelp", "--resolution", "8", "--progress",
                                "none", "--report", "box.json", "-MD", "-MF", "box.d"], ["write", "rename"])

    def golden(self):
        with open(GOLDEN, "rb") as file:
            return file.read()

    def test_dump_reads(self):
        for words in (["info"], ["verify"], ["rig", "--part", "0"]):
            self.tries_every_fault(
                {"a.kelp": self.golden()}, [], [KELP_DUMP, *words, "a.kelp"], ["open", "read"])
        self.tries_every_fault({"a.kelp": self.golden(), "b.kelp": self.golden()}, [],
                               [KELP_DUMP, "diff", "a.kelp", "b.kelp"], ["open", "read"])

    def test_dump_writes(self):
        self.tries_every_fault({"a.kelp": self.golden()},
                               ["a.vox"],
                               [KELP_DUMP, "extract", "a.kelp", "--vox", "a.vox"],
                               ["open", "read", "write", "rename"])
        self.tries_every_fault({"a.kelp": self.golden()},
                               ["a.png"],
                               [KELP_DUMP, "slice", "a.kelp", "-o", "a.png"],
                               ["open", "read", "write", "rename"])

    @unittest.skipUnless(os.path.exists(KELP_DUMP + "-vdb"), "no kelp-dump-vdb in this build")
    def test_dump_writes_by_libraries(self):
        for name in ("vdb", "nvdb"):
            self.tries_every_fault({"a.kelp": self.golden()},
                                   ["a." + name],
                                   [KELP_DUMP, "extract", "a.kelp", "--" + name, "a." + name],
                                   ["open", "read", "write", "rename"])

    def test_dump_writes_proxies(self):
        version = subprocess.run([KELP_DUMP, "--version"], capture_output=True, check=True).stdout
        if b"proxy" not in version:
            self.skipTest("no OpenMesh in this build")
        command = [KELP_DUMP, "extract", "a.kelp", "--proxy", "a.obj"]
        _, found = self.run_in_fresh_folder({"a.kelp": self.golden()}, [], command)
        proxies = sorted(set(found) - {"a.kelp"})
        self.assertGreater(len(proxies), 1)  # one for each part
        self.tries_every_fault(
            {"a.kelp": self.golden()}, proxies, command, ["open", "read", "write", "rename"])


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1] + sys.argv[4:])
