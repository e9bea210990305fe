# SPDX-License-Identifier: MIT
"""Usage: kelp_skin_rig_test.py KELP_BAKE KELP_DUMP

The way of an artist with a skin: kelp-bake, kelp-dump rig, a change, kelp-bake --rig. Joints are parts."""

import json
import os
import subprocess
import sys
import tempfile
import unittest

from skinned_tube import JOINTS, tube

BAKE, DUMP = (os.path.abspath(program) for program in sys.argv[1:3])
del sys.argv[1:3]
NOD = {"clips": {"nod": {"keys": [{"time": 0, "rotation": [0, 0, 0, 1]},
                                  {"time": 1, "rotation": [0, 0, 0.6, 0.8]}]}}}


class SkinRig(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = folder.name
        self.write("tube.gltf", tube())

    def path(self, name):
        return os.path.join(self.folder, name)

    def write(self, name, content):
        with open(self.path(name), "w") as file:
            file.write(content)

    def bake(self, *options, source="tube.gltf", fails=0):
        result = subprocess.run([BAKE, self.path(source), "-o", self.path("out.kelp"), "--resolution", "64",
                                 "--report", self.path("report.json"), "--progress", "none", *options],
                                capture_output=True, text=True)
        self.assertEqual(result.returncode, fails, result.stderr)
        if fails:
            return result.stderr
        with open(self.path("report.json")) as file:
            self.report = json.load(file)
        return self.report

    def bake_with(self, rig, **more):
        self.write("mine.rig.json", json.dumps(rig))
        return self.bake("--rig", self.path("mine.rig.json"), **more)

    def dump(self, *options, fails=0):
        result = subprocess.run([DUMP, "rig", self.path("out.kelp"), *options], capture_output=True,
                                text=True)
        self.assertEqual(result.returncode, fails, result.stderr)
        return result.stderr if fails else result.stdout

    def names(self):
        return [part["name"] for part in self.report["parts"]]

    def test_a_joint_has_a_rig_of_its_own(self):
        self.bake()
        before = self.names()
        for j in range(JOINTS):
            self.assertIn("bone%d" % j, before)
        self.assertIn("a skin moves its parts", self.dump(fails=3))
        alone = {name: self.dump("--part", name) for name in before}
        self.assertIn("curl", json.loads(alone["bone3"])["clips"])
        self.bake_with({"kelp": 1, "parts": {"bone3": NOD}})
        self.assertEqual(self.names(), before)
        for name in before:
            if name != "bone3":
                self.assertEqual(self.dump("--part", name), alone[name])
        text = self.dump()
        printed = json.loads(text)["parts"]
        self.assertEqual(list(printed), ["bone3"])
        self.assertEqual(list(printed["bone3"]["clips"]), ["nod"])
        # It bakes to the same again, also beside the input.
        moved = {name: self.dump("--part", name) for name in before}
        self.write("tube.rig.json", text)
        self.bake()
        self.assertEqual(self.dump(), text)
        for name in before:
            self.assertEqual(self.dump("--part", name), moved[name])
        subprocess.run([DUMP, "verify", "--deep", self.path("out.kelp")], check=True, capture_output=True)

    def test_a_skin_that_no_animation_moves(self):
        still = json.loads(tube())
        del still["animations"]
        self.write("still.gltf", json.dumps(still))
        self.bake(source="still.gltf")
        self.assertEqual(self.names(), ["still"])
        self.bake_with({"kelp": 1, "parts": {"bone3": NOD}}, source="still.gltf")
        self.assertIn("bone3", self.names())
        self.assertEqual([clip["name"] for clip in self.report["clips"]], ["nod"])

    def test_what_divided_skins_is_refused(self):
        division = {"parts": [{"joints": ["bone0"]}]}
        for rig, place in (({"kelp": 1, "skin": division}, "/skin: "),
                           ({"kelp": 1, "skin": division, "parts": {"bone0": {}}}, "/skin: "),
                           ({"kelp": 1, "parts": {"bone0": {"skin": division}}}, "/parts/bone0/skin: ")):
            said = self.bake_with(rig, fails=3)
            self.assertIn(place, said)
            self.assertIn('under "parts"', said)
        self.assertIn("'bone9'", self.bake_with({"kelp": 1, "parts": {"bone9": {}}}, fails=3))
        plain = json.loads(tube())
        plain["nodes"][0]["extras"] = {"kelp": {"kelp": 1, "skin": division}}
        self.write("extras.gltf", json.dumps(plain))
        self.assertIn('under "parts"', self.bake(source="extras.gltf", fails=3))
        self.assertFalse(os.path.exists(self.path("out.kelp")))


if __name__ == "__main__":
    unittest.main()
