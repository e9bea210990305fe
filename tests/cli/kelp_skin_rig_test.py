# SPDX-License-Identifier: MIT
"""Usage: kelp_skin_rig_test.py KELP_BAKE KELP_DUMP

The way of an artist with a skin: kelp-bake, kelp-dump rig, a change, kelp-bake --rig."""

import base64
import json
import math
import os
import struct
import subprocess
import sys
import tempfile
import unittest

BAKE, DUMP = (os.path.abspath(program) for program in sys.argv[1:3])
del sys.argv[1:3]
JOINTS, RINGS, CORNERS, HEIGHT, RADIUS = 6, 25, 8, 6.0, 0.6


class Gltf:
    """The accessors of a file, in one buffer."""

    def __init__(self):
        self.data, self.views, self.accessors = b"", [], []

    def add(self, kind, component, numbers, **more):
        width = {"SCALAR": 1, "VEC3": 3, "VEC4": 4, "MAT4": 16}[kind]
        packed = struct.pack("<%d%s" % (len(numbers), {5126: "f", 5123: "H"}[component]), *numbers)
        self.views.append({"buffer": 0, "byteOffset": len(self.data), "byteLength": len(packed)})
        self.data += packed + b"\0" * (-len(packed) % 4)
        self.accessors.append({"bufferView": len(self.views) - 1, "componentType": component, "type": kind,
                               "count": len(numbers) // width, **more})
        return len(self.accessors) - 1

    def buffer(self):
        return {"byteLength": len(self.data), "uri": "data:application/octet-stream;base64," +
                base64.b64encode(self.data).decode()}


def tube(turn=0.3):
    """A tube with a joint in each of its stretches, which curls."""
    gltf, points, joints, weights, faces = Gltf(), [], [], [], []
    stretch = HEIGHT / JOINTS

    def vertex(x, y, z):
        points.extend((x, y, z))
        at = min(max(y / stretch - 0.5, 0), JOINTS - 1)
        low = min(int(at), JOINTS - 2)
        joints.extend((low, low + 1, 0, 0))
        weights.extend((1 - (at - low), at - low, 0, 0))

    for ring in range(RINGS):
        for k in range(CORNERS):
            angle = 2 * math.pi * k / CORNERS
            vertex(RADIUS * math.cos(angle), HEIGHT * ring / (RINGS - 1), RADIUS * math.sin(angle))
    vertex(0, 0, 0)
    vertex(0, HEIGHT, 0)
    for k in range(CORNERS):
        after, top = (k + 1) % CORNERS, (RINGS - 1) * CORNERS
        for low in range(0, top, CORNERS):
            high = low + CORNERS
            faces += [low + k, high + k, low + after, low + after, high + k, high + after]
        faces += [RINGS * CORNERS, k, after, RINGS * CORNERS + 1, top + after, top + k]
    attributes = {"POSITION": gltf.add("VEC3", 5126, points, min=[-RADIUS, 0, -RADIUS],
                                       max=[RADIUS, HEIGHT, RADIUS]),
                  "JOINTS_0": gltf.add("VEC4", 5123, joints), "WEIGHTS_0": gltf.add("VEC4", 5126, weights)}
    indices = gltf.add("SCALAR", 5123, faces)
    bind = [number for j in range(JOINTS)
            for number in (1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, -j * stretch, 0, 1)]
    matrices = gltf.add("MAT4", 5126, bind)
    times = gltf.add("SCALAR", 5126, [0, 1, 2], min=[0], max=[2])
    turns = gltf.add("VEC4", 5126, [0, 0, 0, 1, 0, 0, math.sin(turn / 2), math.cos(turn / 2), 0, 0, 0, 1])
    nodes = [{"mesh": 0, "skin": 0}] + [
        {"name": "bone%d" % j, "translation": [0, stretch if j else 0, 0],
         **({"children": [j + 2]} if j + 1 < JOINTS else {})} for j in range(JOINTS)]
    return json.dumps({
        "asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0, 1]}], "nodes": nodes,
        "meshes": [{"primitives": [{"attributes": attributes, "indices": indices}]}],
        "skins": [{"joints": list(range(1, JOINTS + 1)), "inverseBindMatrices": matrices}],
        "animations": [{"name": "curl", "samplers": [{"input": times, "output": turns}],
                        "channels": [{"sampler": 0, "target": {"node": j + 1, "path": "rotation"}}
                                     for j in range(1, JOINTS)]}],
        "accessors": gltf.accessors, "bufferViews": gltf.views,
        "buffers": [gltf.buffer()]})


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

    def dump(self, *options, fails=0):
        result = subprocess.run([DUMP, "rig", self.path("out.kelp"), *options], capture_output=True,
                                text=True)
        self.assertEqual(result.returncode, fails, result.stderr)
        self.said = result.stderr
        return result.stdout

    def bake_with(self, *parts, **more):
        self.write("mine.rig.json", json.dumps({"kelp": 1, "skin": {"parts": list(parts)}}))
        return self.bake("--rig", self.path("mine.rig.json"), **more)

    def groups(self):
        """The parts that the pack names."""
        return json.loads(self.dump())["skin"]["parts"]

    def names(self):
        return sorted(part["name"] for part in self.report["parts"])

    def test_the_rig_that_was_made_bakes_as_before(self):
        before = self.bake()
        text = self.dump()
        self.write("tube.rig.json", text)
        after = self.bake()  # it is beside the input
        self.assertEqual(self.dump(), text)
        for what in "parts", "clips":
            self.assertEqual([one["name"] for one in after[what]], [one["name"] for one in before[what]])
        self.assertIn("tube.rig.json", after["parts"][0]["rig"])
        for old, new in zip(before["clips"], after["clips"]):
            self.assertLessEqual(new["fit"]["mean"], 1.1 * old["fit"]["mean"] + 0.01)
        subprocess.run([DUMP, "verify", "--deep", self.path("out.kelp")], check=True, capture_output=True)
        # --rig names another.
        self.bake("--rig", "skin")
        self.assertEqual(self.report["parts"][0]["rig"], "skin")

    def test_a_change_does_what_it_says(self):
        names = ["bone%d" % j for j in range(JOINTS)]
        for parts in (
                [{"joints": names, "knots": 5}],
                [{"joints": names, "knots": 12}],
                [{"joints": names[:2]}, {"joints": names[2:], "knots": 6}],
                [{"joints": names[:3], "pieces": 2}, {"joints": names[3:]}],
                [{"joints": [name]} for name in names]):
            report = self.bake_with(*parts)
            self.assertEqual(sorted(self.groups(), key=str), sorted(parts, key=str))
            self.assertEqual(sum(part["bend"] == "sweep" for part in report["parts"]),
                             sum("knots" in part for part in parts))
            self.assertFalse([notice for notice in report["notices"] if "/skin/" in notice])
        self.bake_with({"joints": ["bone3"]})
        self.assertEqual(self.names(), ["bone3"])
        self.bake_with({"joints": ["bone0"]}, {"joints": ["bone3"]})
        self.assertEqual(self.names(), ["bone0", "bone3"])

    def test_what_cannot_be_is_refused(self):
        for parts, said in (
                ([{"joints": ["bone7"]}], "/skin/parts/0/joints/0: the file's skin has no joint 'bone7'"),
                ([{"joints": ["bone0"]}, {"joints": ["bone0"]}], "/skin/parts/1/joints/0: the joint 'bone0'"),
                ([{"joints": ["bone2", "bone1"], "knots": 5}], "the joint 'bone1' is not below 'bone2'"),
                ([{"joints": ["bone0"], "pieces": 0}], "/skin/parts/0/pieces: 0 is out of range"),
                ([{"joints": ["bone0", "bone1"], "knots": 99}], "/skin/parts/0/knots: 99 is out of range")):
            self.assertIn(said, self.bake_with(*parts, fails=3))
        self.assertFalse(os.path.exists(self.path("out.kelp")))
        # No skin.
        self.write("box.obj", "v 0 0 0\nv 1 0 0\nv 1 2 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 1 4 3\n")
        self.assertIn("divides a skin", self.bake_with({"joints": ["bone0"]}, source="box.obj", fails=3))
        plain = json.loads(tube())
        del plain["skins"], plain["nodes"][0]["skin"]
        self.write("plain.gltf", json.dumps(plain))
        self.assertIn("has no mesh that bends by joints",
                      self.bake_with({"joints": ["bone0"]}, source="plain.gltf", fails=3))
        plain["nodes"][0]["extras"] = {"kelp": {"kelp": 1, "skin": {"parts": [{"joints": ["bone0"]}]}}}
        self.write("extras.gltf", json.dumps(plain))
        self.assertIn("only a rig file", self.bake(source="extras.gltf", fails=3))
        self.assertIn("--at bakes one moment",
                      self.bake("--rig", self.path("mine.rig.json"), "--at", "curl:1", fails=1))

    def test_a_part_has_a_rig_of_its_own_as_before(self):
        self.bake_with({"joints": ["bone0"]}, {"joints": ["bone2", "bone5"], "knots": 6})
        part = json.loads(self.dump("--part", "bone2"))
        self.assertEqual(len(part["knots"]), 6)
        self.assertNotIn("skin", part)

    def test_what_folds_is_told(self):
        self.write("tube.gltf", tube(2.2))
        report = self.bake_with({"joints": ["bone0"]},
                                {"joints": ["bone%d" % j for j in range(1, JOINTS)], "knots": 12})
        told = [notice for notice in report["notices"] if "/skin/parts/1" in notice]
        self.assertEqual(len(told), 1, report["notices"])
        self.assertIn("clip 'curl'", told[0])
        self.assertEqual(self.names(), ["bone%d" % j for j in range(JOINTS)])


if __name__ == "__main__":
    unittest.main()
