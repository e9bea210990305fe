# SPDX-License-Identifier: MIT
"""Usage: kelp_part_rigs_test.py KELP_BAKE KELP_DUMP

Rigs of parts by name: what kelp-dump rig prints, kelp-bake reads, also after the model has changed. Models of
many parts are made here: MagicaVoxel files, glTF nodes, a skin."""

import json
import math
import os
import struct
import subprocess
import sys
import tempfile
import unittest

from skinned_tube import Gltf, tube

BAKE, DUMP = (os.path.abspath(program) for program in sys.argv[1:3])
del sys.argv[1:3]

HERO = ["body", "head", "arm_l", "arm_r", "leg_l", "leg_r"]
# As other programs name: words, quotes, slashes, letters of other languages, one name twice.
STRANGE = ["Left Arm", "a/b~c", 'the "big" one', "Ärmel", "wheel", "wheel"]


def chunk(name, content=b"", children=b""):
    return name + struct.pack("<II", len(content), len(children)) + content + children


def text(value):
    return struct.pack("<I", len(value.encode())) + value.encode()


def fields(**values):
    return struct.pack("<I", len(values)) + b"".join(text(key) + text(value)
                                                     for key, value in values.items())


def vox(names, color=1, turns=()):
    """A MagicaVoxel file of posts side by side, each with a name; `turns`: the bytes _r of some."""
    models, nodes = b"", b""
    group = struct.pack("<I", len(names))
    for i, name in enumerate(names):
        x, y, z = 3 + i % 2, 3, 10 + i
        voxels = [bytes((a, b, c, color)) for a in range(x) for b in range(y) for c in range(z)]
        models += chunk(b"SIZE", struct.pack("<III", x, y, z))
        models += chunk(b"XYZI", struct.pack("<I", len(voxels)) + b"".join(voxels))
        frame = {"_t": "%d 0 %d" % (30 * i, z // 2)}
        if i < len(turns):
            frame["_r"] = str(turns[i])
        nodes += chunk(b"nTRN", struct.pack("<I", 2 + 2 * i) + fields(_name=name) +
                       struct.pack("<Iiii", 3 + 2 * i, -1, 0, 1) + fields(**frame))
        nodes += chunk(b"nSHP", struct.pack("<I", 3 + 2 * i) + fields() + struct.pack("<II", 1, i) +
                       fields())
        group += struct.pack("<I", 2 + 2 * i)
    top = chunk(b"nTRN", struct.pack("<I", 0) + fields() + struct.pack("<Iiii", 1, -1, 0, 1) + fields())
    top += chunk(b"nGRP", struct.pack("<I", 1) + fields() + group)
    return b"VOX " + struct.pack("<I", 150) + chunk(b"MAIN", b"", models + top + nodes)


def machine(height=2.0, hangs=True):
    """Boxes below each other and below an empty that turns; animations turn, move and scale them."""
    gltf = Gltf()
    points = [(a * 0.2, b * height, c * 0.3) for a in (0, 1) for b in (0, 1) for c in (0, 1)]
    corners = [0, 1, 3, 0, 3, 2, 4, 6, 7, 4, 7, 5, 0, 4, 5, 0, 5, 1, 2, 3, 7, 2, 7, 6, 0, 2, 6, 0, 6, 4, 1, 5,
               7, 1, 7, 3]
    place = gltf.add("VEC3", 5126, [v for p in points for v in p], min=[0, 0, 0], max=[0.2, height, 0.3])
    mesh = {"primitives": [{"attributes": {"POSITION": place}, "indices": gltf.add("SCALAR", 5123, corners)}]}
    times = gltf.add("SCALAR", 5126, [0, 0.4, 0.9, 1.7], min=[0], max=[1.7])
    turns = gltf.add("VEC4", 5126, [n for k in range(4) for n in
                                    (0.2 * math.sin(k), 0.1, math.sin(0.7 * k) * 0.9,
                                     math.sqrt(1 - 0.01 - 0.04 * math.sin(k) ** 2 -
                                               (math.sin(0.7 * k) * 0.9) ** 2))])
    steps = gltf.add("VEC3", 5126, [0, 0, 0, 0.1, 1 / 3, 0, 0.7, 0, 0.3, 0, 0, 0])
    sizes = gltf.add("VEC3", 5126, [1, 1, 1, 1.1, 0.7, 1.3, 1, 2, 1, 1, 1, 1])
    half = math.sqrt(0.5)
    nodes = [
        {"name": "base", "mesh": 0, "children": [1, 3, 5]},
        {"name": "swing", "translation": [1, 0, 0], "children": [2]},  # moves, has no mesh
        {"name": "blade", "mesh": 0, "rotation": [0, 0, half, half], "scale": [1, 2, 1]},
        {"name": "arm", "mesh": 0, "rotation": [0.6, 0, 0, 0.8], "translation": [-1, 0, 0], "children": [4]},
        {"name": "arm", "mesh": 0, "translation": [0, 2, 0], "rotation": [half, 0, 0, half]},
        {"name": "tail", "mesh": 0, "translation": [0, 0, 2], "extras": {"kelp": {
            "kelp": 1, "axis": "-x", "parent_at": 0.5 if hangs else -1,
            "knots": [{"at": 0}, {"at": 0.5}, {"at": 1}],
            "clips": {"wag": {"waves": [{"knot": 2, "offset": [0, 0, 0.05], "period": 2}]}},
            "sockets": {"tip": {"at": 1, "rotation": [0, half, 0, half]}}}}}]
    channels = [(1, "rotation", turns), (1, "translation", steps), (3, "rotation", turns),
                (4, "scale", sizes), (4, "rotation", turns), (0, "translation", steps)]
    return json.dumps({
        "asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0]}], "nodes": nodes,
        "meshes": [mesh],
        "animations": [{"name": "work", "samplers": [{"input": times, "output": out}
                                                     for _, _, out in channels],
                        "channels": [{"sampler": i, "target": {"node": node, "path": path}}
                                     for i, (node, path, _) in enumerate(channels)]}],
        "accessors": gltf.accessors, "bufferViews": gltf.views, "buffers": [gltf.buffer()]}).encode()


class PartRigs(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = folder.name

    def path(self, name):
        return os.path.join(self.folder, name)

    def write(self, name, content):
        with open(self.path(name), "wb") as file:
            file.write(content if isinstance(content, bytes) else content.encode())
        return self.path(name)

    def bake(self, source, *options, fails=0):
        result = subprocess.run([BAKE, self.path(source), "-o", self.path("out.kelp"), "--progress", "none",
                                 "--report", self.path("report.json"), *options], capture_output=True,
                                text=True)
        self.assertEqual(result.returncode, fails, result.stderr)
        return result.stderr

    def dump(self, *options, fails=0):
        result = subprocess.run([DUMP, "rig", self.path("out.kelp"), *options], capture_output=True,
                                text=True)
        self.assertEqual(result.returncode, fails, result.stderr)
        return result.stderr if fails else result.stdout

    def parts(self):
        return json.loads(self.dump())["parts"]

    def report_parts(self):
        with open(self.path("report.json")) as file:
            return {part["name"]: part for part in json.load(file)["parts"]}

    def refused(self, source, rig, *says, options=("--parts", "nodes"), code=3):
        said = self.bake(source, "--rig", self.write("bad.rig.json", rig), *options, fails=code)
        for word in says:
            self.assertIn(word, said)

    def edited(self, parts):
        """Other values in each part: what a hand would do, whatever the axis is."""
        for i, rig in enumerate(parts.values()):
            across = [0.0, 0.0, 0.0]
            across["xyz".index(rig["axis"][1]) - 1] = 0.01 * (i + 1)
            rig["knots"] = [{"at": 0}, {"at": 0.5, "offset": across}, {"at": 1}]
            rig.setdefault("clips", {})["mine"] = {"waves": [
                {"knot": 2, "offset": across, "period": 1.1 + i, "phase": 0.1}]}
            rig.setdefault("sockets", {})["grip %d" % i] = {"at": 0.3, "offset": across}
        return parts

    def check_survival(self, source, before, after, *options):
        """Edited, saved beside the model, the model changed, baked again: each part's rig is as it was."""
        self.write(source, before)
        self.bake(source, *options)
        untouched = self.dump()
        wanted = self.edited(json.loads(untouched)["parts"])
        saved = os.path.splitext(source)[0] + ".rig.json"
        self.write(saved, json.dumps({"kelp": 1, "parts": wanted}))
        self.bake(source, *options)
        text, alone = self.dump(), {name: self.dump("--part", name) for name in wanted}
        have = json.loads(text)["parts"]
        self.assertEqual(list(have), list(wanted))
        for i, name in enumerate(wanted):
            self.assertEqual(have[name]["knots"], wanted[name]["knots"], name)
            self.assertEqual(have[name]["clips"]["mine"]["waves"], wanted[name]["clips"]["mine"]["waves"])
            self.assertEqual(have[name]["sockets"]["grip %d" % i]["at"], 0.3)
            self.assertEqual(have[name]["axis"], wanted[name]["axis"])
            self.assertEqual(json.loads(alone[name]), {"kelp": 1, **have[name]})
            self.assertIn(saved, self.report_parts()[name]["rig"])
        # What is printed, is read to the same bytes: beside the changed model, and by --rig.
        self.write(saved, text)
        self.write(source, after)
        self.bake(source, *options)
        self.assertEqual(self.dump(), text)
        for name in wanted:
            self.assertEqual(self.dump("--part", name), alone[name])
        subprocess.run([DUMP, "verify", "--deep", self.path("out.kelp")], check=True, capture_output=True)
        os.rename(self.path(saved), self.path("elsewhere.json"))
        self.bake(source, "--rig", self.path("elsewhere.json"), *options)
        self.assertEqual(self.dump(), text)
        # The rigs as they were made are read to the same bytes too.
        self.write(source, before)
        self.bake(source, "--rig", self.write("untouched.json", untouched), *options)
        self.assertEqual(self.dump(), untouched)
        return list(wanted)

    def test_objects_of_a_vox_file(self):
        names = self.check_survival("hero.vox", vox(HERO), vox(HERO, 7), "--parts", "nodes")
        self.assertEqual(names, HERO)

    def test_objects_with_strange_names_and_turns(self):
        turns = [40, 4, 17, 34, 20, 72]
        names = self.check_survival("my car.vox", vox(STRANGE, 3, turns), vox(STRANGE, 9, turns), "--parts",
                                    "nodes", "--axis", "-x", "--unit", "0.1", "--pad", "2")
        self.assertEqual(names, STRANGE[:5] + ["wheel.2"])

    def test_nodes_of_a_gltf_file(self):
        names = self.check_survival("machine.gltf", machine(), machine(2.5), "--parts", "nodes",
                                    "--resolution", "40")
        self.assertEqual(sorted(names), ["arm", "arm.2", "base", "blade", "tail"])

    def test_nodes_with_rigs_of_their_own(self):
        # Without --parts nodes: the part with extras.kelp, and the rest.
        names = self.check_survival("machine.gltf", machine(2, False), machine(2.5, False), "--resolution",
                                    "40", "--up", "+z")
        self.assertEqual(names, ["machine", "tail"])

    def test_a_file_of_one_part(self):
        self.write("post.vox", vox(["post"]))
        self.bake("post.vox", "--rig", "sway")
        text = self.dump()
        self.assertIn("knots", json.loads(text), "the rig of the whole file")
        self.write("post.rig.json", text)
        self.bake("post.vox")
        self.assertEqual(self.dump(), text)
        # By name it works too; with --parts nodes, where a rig of the whole file does not, it is printed so.
        self.write("post.rig.json", json.dumps({"kelp": 1, "parts": {"post": json.loads(text)}}))
        for options in (), ("--parts", "nodes"):
            self.bake("post.vox", *options)
            rig = json.loads(self.dump())
            self.assertEqual(rig.get("parts", {"post": rig})["post"]["clips"], json.loads(text)["clips"])
            self.assertEqual("parts" in rig, bool(options))

    def test_others_keep_their_rigs(self):
        self.write("machine.gltf", machine())
        self.bake("machine.gltf", "--parts", "nodes", "--resolution", "40")
        before = self.parts()
        self.write("machine.rig.json", '{"kelp": 1, "parts": {"arm.2": {"kelp": 1, "bend": "sweep"}}}')
        self.bake("machine.gltf", "--parts", "nodes", "--resolution", "40")
        after = self.parts()
        self.assertEqual(after["arm.2"]["bend"], "sweep")
        self.assertNotIn("clips", after["arm.2"], "its animation is not in the rig")
        for name in "base", "blade", "arm", "tail":
            self.assertEqual(after[name], before[name])
        self.assertIn("extras.kelp", self.report_parts()["tail"]["rig"])

    def test_joints_of_a_skin(self):
        options = ("--resolution", "64")
        self.write("tube.gltf", tube())
        self.bake("tube.gltf", *options)
        names = list(self.report_parts())
        alone = {name: self.dump("--part", name) for name in names}
        wanted = self.edited({"bone4": json.loads(alone["bone4"])})
        self.write("tube.rig.json", json.dumps({"kelp": 1, "parts": wanted}))
        self.bake("tube.gltf", *options)
        self.assertEqual(list(self.report_parts()), names)
        for name in names:
            if name != "bone4":
                self.assertEqual(self.dump("--part", name), alone[name])
        its, text = self.dump("--part", "bone4"), self.dump()
        self.assertIn("grip 0", json.loads(its)["sockets"])
        self.assertEqual({"kelp": 1, **json.loads(text)["parts"]["bone4"]}, json.loads(its))
        self.write("tube.rig.json", text)
        self.bake("tube.gltf", *options)
        self.assertEqual(self.dump(), text)
        self.refused("tube.gltf", '{"kelp": 1, "parts": {"bone9": {}}}', "'bone9'", "bone0", options=options)

    def test_parts_that_are_not_there(self):
        self.write("hero.vox", vox(HERO))
        self.refused("hero.vox", '{"kelp": 1, "parts": {"body": {}, "arm": {}}}',
                     "hero.vox: there is no part 'arm', for which the rig (rig file bad.rig.json) has one; "
                     "parts are 'body', 'head', 'arm_l', 'arm_r', 'leg_l', 'leg_r'")
        self.refused("hero.vox", '{"kelp": 1, "parts": {"arm_l": {}}}', "parts are 'hero'", "--parts nodes",
                     options=())
        self.write("many.vox", vox(["n%d" % i for i in range(60)]))
        self.refused("many.vox", '{"kelp": 1, "parts": {"m": {}}}', "'n39' and 20 more")
        self.write("box.obj", "v 0 0 0\nv 1 0 0\nv 1 2 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 1 4 3\n")
        self.refused("box.obj", '{"kelp": 1, "parts": {"Box": {}}}', "parts are 'box'", options=())
        # What earlier versions wrote beside the pack is not read.
        self.write("hero.arm_r.rig.json", "{")
        self.bake("hero.vox", "--parts", "nodes")

    def test_what_no_rig_file_is(self):
        self.write("hero.vox", vox(HERO))
        deep = '{"kelp": 1, "parts": ' + '{"body": ' * 40 + "{}" + "}" * 41
        for rig, said in (
                ('{"kelp": 1, "parts": {}}', "/parts: names no part"),
                ('{"kelp": 1, "parts": []}', "/parts: must be an object that maps names of parts to rigs"),
                ('{"kelp": 1, "parts": {"body": 3}}', "/parts/body: must be an object"),
                ('{"kelp": 1, "parts": {"body": null}}', "/parts/body: must be an object"),
                ('{"kelp": 1, "parts": {"": {}}}', "1 to 255 bytes"),
                ('{"kelp": 1, "parts": {"a\\n": {}}}', "control characters"),
                ('{"kelp": 1, "parts": {"body": {}, "body": {}}}', "the key 'body' stands twice"),
                ('{"kelp": 1, "parts": {"body": {}}, "knots": []}', '/knots: beside "parts"'),
                ('{"kelp": 1, "parts": {"body": {}}, "part": 1}', "/part: unknown key; did you mean"),
                ('{"kelp": 1, "part": {"body": {}}}', "/part: unknown key; did you mean"),
                ('{"parts": {"body": {}}}', "'kelp' is missing"),
                ('{"kelp": 2, "parts": {"body": {}}}', "/kelp: this tool reads version 1"),
                ('{"kelp": 1, "parts": {"body": {"kelp": 2}}}', "/parts/body/kelp: this tool reads"),
                ('{"kelp": 1, "parts": {"body": {"skin": {"parts": [{"joints": ["a"]}]}}}}',
                 "/parts/body/skin: a skin is not divided"),
                ('{"kelp": 1, "parts": {"body": {"parts": {"a": {}}}}}', "/parts/body/parts: unknown key"),
                ('{"kelp": 1, "parts": {"body": {"knots": [{"at": 0}]}}}', "/parts/body/knots: has 1 knot"),
                ('{"kelp": 1, "parts": {"body": {"parent_at": 0.5}}}', "no parent part"),
                ('{"kelp": 1, "parts": {' + ", ".join('"%d": {}' % i for i in range(5000)) + "}}",
                 "more than 4096 keys"),
                (deep, "nested more than 16 levels"),
                ('{"kelp": 1, "parts": {"body": {}}', "not valid JSON"),
                ('{"kelp": 1, "parts": {"body": {"roll": 1e999}}}', "too large")):
            self.refused("hero.vox", rig, said)
        self.refused("hero.vox", '{"kelp": 1}', "one for the whole file", '"parts"', code=1)
        self.refused("hero.vox", '{"kelp": 1, "parts": {"body": {"axis": "+x"}}}', "--axis +z",
                     options=("--parts", "nodes", "--axis", "+z"), code=1)
        self.refused("hero.vox", '{"kelp": 1, "skin": {"parts": [{"joints": ["a"]}]}, "parts": {"body": {}}}',
                     "/skin: a skin is not divided")
        self.assertFalse(os.path.exists(self.path("out.kelp")))


if __name__ == "__main__":
    unittest.main()
