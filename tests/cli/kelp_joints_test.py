# SPDX-License-Identifier: MIT
"""Usage: kelp_joints_test.py KELP_BAKE KELP_DUMP SOURCES; KELP_LIBRARY and PYTHONPATH lead to the library and
to kelp.py.

The joints of packs against the glTF files that they are made of, which are read here: names, parents, inverse
bind matrices. An engine that has the file's own matrices moves the pack with them as the pack's clips do."""

import base64
import json
import math
import os
import struct
import subprocess
import sys
import tempfile
import unittest

try:
    import kelp
    import numpy as np
except ImportError as absent:
    print("SKIPPED: %s" % absent)
    sys.exit(0)

BAKE, DUMP, SOURCES = (os.path.abspath(path) for path in sys.argv[1:4])
del sys.argv[1:4]
ASSETS = os.environ.get("KELP_ASSETS") or os.path.join(SOURCES, "..", "shared", "assets")
COMPONENTS = {5120: "i1", 5121: "u1", 5122: "<i2", 5123: "<u2", 5125: "<u4", 5126: "<f4"}
WIDTHS = {"SCALAR": 1, "VEC2": 2, "VEC3": 3, "VEC4": 4, "MAT4": 16}
# --up +z: the file's z is the object's y.
Z_UP = np.array([(1, 0, 0, 0), (0, 0, 1, 0), (0, -1, 0, 0), (0, 0, 0, 1)], float)


def turned(x, y, z, w):
    return np.array([(1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w), 0),
                     (2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w), 0),
                     (2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y), 0), (0, 0, 0, 1)])


def placed(translation, rotation=(0, 0, 0, 1), scale=(1, 1, 1)):
    out = turned(*rotation) @ np.diag([*scale, 1])
    out[:3, 3] = translation
    return out


class Source:
    """A glTF file."""

    def __init__(self, path):
        with open(path, "rb") as file:
            data = file.read()
        binary = b""
        if data[:4] == b"glTF":
            (size,) = struct.unpack_from("<I", data, 12)
            binary, data = data[20 + size + 8:], data[20:20 + size]
        self.json = json.loads(data)
        self.buffers = []
        for buffer in self.json["buffers"]:
            uri = buffer.get("uri")
            if uri is None:
                self.buffers.append(binary)
            elif uri.startswith("data:"):
                self.buffers.append(base64.b64decode(uri.split(",")[1]))
            else:
                with open(os.path.join(os.path.dirname(path), uri), "rb") as file:
                    self.buffers.append(file.read())
        self.nodes = self.json["nodes"]
        self.parents = [-1] * len(self.nodes)
        for index, node in enumerate(self.nodes):
            for child in node.get("children", []):
                self.parents[child] = index

    def values(self, index):
        accessor = self.json["accessors"][index]
        view = self.json["bufferViews"][accessor["bufferView"]]
        kind, width = np.dtype(COMPONENTS[accessor["componentType"]]), WIDTHS[accessor["type"]]
        array = np.ndarray((accessor["count"], width), kind, self.buffers[view["buffer"]],
                           view.get("byteOffset", 0) + accessor.get("byteOffset", 0),
                           (view.get("byteStride", kind.itemsize * width), kind.itemsize))
        return array / np.iinfo(kind).max if accessor.get("normalized") else array.astype(float)

    def world(self, moment=None):
        """Matrices of all nodes. moment: what channels say of some, {node: {path: value}}."""
        matrices = {}

        def of(index):
            if index not in matrices:
                node = {**self.nodes[index], **(moment or {}).get(index, {})}
                if "matrix" in node:
                    local = np.array(node["matrix"]).reshape(4, 4).T
                else:
                    local = placed(node.get("translation", (0, 0, 0)), node.get("rotation", (0, 0, 0, 1)),
                                   node.get("scale", (1, 1, 1)))
                above = self.parents[index]
                matrices[index] = local if above < 0 else of(above) @ local
            return matrices[index]

        return [of(index) for index in range(len(self.nodes))]

    def moment(self, animation, share=0.7):
        """A key of all channels, which have keys at the same times, and its time."""
        found, at = {}, set()
        for channel in animation["channels"]:
            sampler = animation["samplers"][channel["sampler"]]
            value, times = self.values(sampler["output"]), self.values(sampler["input"])[:, 0]
            key = int(share * (len(times) - 1))
            at.add(times[key])
            found.setdefault(channel["target"]["node"], {})[channel["target"]["path"]] = value[key]
        [time] = at
        return found, float(time)

    def binds(self, skin):
        """Inverse bind matrices by node."""
        matrices = self.values(skin["inverseBindMatrices"]).reshape(-1, 4, 4).transpose(0, 2, 1)
        return dict(zip(skin["joints"], matrices))

    def place(self, skin):
        """Where kelp has a skin's mesh at rest: its uppermost joint is where the scene has it."""
        binds = self.binds(skin)
        depth = {node: len(self.above(node)) for node in binds}
        top = min(binds, key=lambda node: depth[node])
        return self.world()[top] @ binds[top]

    def above(self, node):
        out = []
        while self.parents[node] >= 0:
            node = self.parents[node]
            out.append(node)
        return out

    def name(self, node):
        return self.nodes[node].get("name") or "node %d" % node

    def skinned(self):
        """Of each primitive that a skin moves: that, and (points, joints, weights)."""
        for node in self.nodes:
            if "mesh" not in node or "skin" not in node:
                continue
            skin = self.json["skins"][node["skin"]]
            for primitive in self.json["meshes"][node["mesh"]]["primitives"]:
                its = primitive["attributes"]
                joints = np.array(skin["joints"])[self.values(its["JOINTS_0"]).astype(int)]
                yield skin, self.values(its["POSITION"]), joints, self.values(its["WEIGHTS_0"])


class Joints(unittest.TestCase):
    def bake(self, path, *options, resolution=48):
        """The pack's path, and what the baker said."""
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        out = os.path.join(folder.name, "out.kelp")
        done = subprocess.run([BAKE, path, "-o", out, "--resolution", str(resolution), "--progress", "none",
                               *options], capture_output=True, text=True)
        self.assertEqual(0, done.returncode, done.stderr)
        return out, done.stderr

    def open(self, pack):
        asset = kelp.Asset(pack, distance_level=0)
        self.addCleanup(asset.close)
        asset.load_all()
        return asset

    def real(self, name):
        path = os.path.join(ASSETS, "gltf", name)
        if not os.path.exists(path):
            self.skipTest("%s is absent: set KELP_ASSETS" % path)
        return path

    def near(self, got, expected, what=""):
        scale = np.abs(np.asarray(expected)).max()
        np.testing.assert_allclose(got, expected, rtol=0, atol=2e-6 * scale, err_msg=what)

    def check_skin(self, source, asset, to_object=np.eye(4)):
        """The joints of a file's only skin. Their indices by node."""
        joints, index = asset.joints, {}
        [skin] = source.json["skins"]
        from_object = np.linalg.inv(to_object @ source.place(skin))
        for node, bind in source.binds(skin).items():
            index[node] = asset.find_joint(source.name(node))
            self.near(joints[index[node]].inverse_bind, bind @ from_object, source.name(node))
        self.assertEqual(len(index), len(set(index.values())))
        for node in index:
            above = [index[other] for other in source.above(node) if other in index]
            self.assertEqual(above[0] if above else kelp.NONE, joints[index[node]].parent)
        for at, joint in enumerate(joints):
            self.assertLess(joint.parent, at)
            self.assertTrue(all(0 <= part < asset.info.parts for part in joint.parts))
        return index

    def check_motion(self, source, asset, index, to_object=np.eye(4)):
        """Vertices that the file's own matrices and the pack's inverse bind matrices move lie on the pack's
        solid, which the same clip moves."""
        joints, moved = asset.joints, False
        for number, animation in enumerate(source.json["animations"]):
            moment, time = source.moment(animation)
            world = source.world(moment)
            matrices = {node: to_object @ world[node] @ joints[at].inverse_bind for node, at in index.items()}
            pose = kelp.Pose(asset)
            pose.add_clip(number, time, play=kelp.Play.ONCE)
            posed = kelp.Instance(asset, pose)
            voxel = np.linalg.norm(asset.parts[0].to_object[:3, 0])
            apart = []
            for skin, points, nodes, weights in source.skinned():
                rest = np.c_[points, np.ones(len(points))] @ (to_object @ source.place(skin)).T
                weights = weights / weights.sum(1, keepdims=True)
                for i in range(0, len(points), max(1, len(points) // 150)):
                    matrix = sum(weight * matrices[node] for weight, node in zip(weights[i], nodes[i]))
                    at = (matrix @ rest[i])[:3]
                    moved = moved or np.linalg.norm(at - rest[i, :3]) > 2 * voxel
                    apart.append(kelp.closest_point(posed, at).distance / voxel)
            self.assertLess(np.mean(apart), 1, animation.get("name"))
            self.assertLess(np.percentile(apart, 95), 3, animation.get("name"))
        self.assertTrue(moved)

    def check_file(self, name, to_object=np.eye(4), options=()):
        path = self.real(name)
        source, asset = Source(path), self.open(self.bake(path, *options)[0])
        self.check_motion(source, asset, self.check_skin(source, asset, to_object), to_object)

    def test_fox(self):
        self.check_file("draco_testdata/Fox/Fox.gltf")

    def test_names_that_are_missing(self):
        self.check_file("skinned/CesiumMan.glb")

    def test_another_axis_and_unit(self):
        self.check_file("skinned/CesiumMan.glb", 0.01 * Z_UP @ np.diag([1, 1, 1, 100]),
                        ["--up", "+z", "--unit", "0.01"])

    def test_greenman(self):
        self.check_file("skinned/greenman.glb")

    def test_rigged_simple(self):
        self.check_file("skinned/rigged_simple.gltf")

    def test_two_skins(self):
        """A node that two skins bind otherwise, names given twice or not at all, a mesh without a skin, and
        joints that stand otherwise at rest than when they were bound. Each body follows one joint alone: so
        does its part."""
        with tempfile.TemporaryDirectory() as folder:
            path = os.path.join(folder, "two.gltf")
            with open(path, "w") as file:
                json.dump(two_skins(), file)
            source, (pack, _) = Source(path), self.bake(path, resolution=64)
            asset = self.open(pack)
        joints = asset.joints
        self.assertEqual(["hip", "node 2", "hip", "hip", "hat"], [joint.name for joint in joints])
        self.assertEqual([kelp.NONE, 0, 1, 1], [joint.parent for joint in joints[:4]])
        first, second = source.json["skins"]
        places = [np.linalg.inv(source.place(skin)) for skin in (first, second)]
        for joint, node, skin in ((0, 1, 0), (0, 1, 1), (1, 2, 0), (2, 3, 0), (3, 3, 1)):
            self.near(joints[joint].inverse_bind,
                      source.binds((first, second)[skin])[node] @ places[skin], "%d of %d" % (joint, skin))
        # The hat stands on the joint above as it does in the scene.
        world = source.world()
        self.near(np.linalg.inv(joints[4].inverse_bind),
                  np.linalg.inv(joints[2].inverse_bind) @ np.linalg.inv(world[3]) @ world[4])

        nodes = (1, 2, 3, 3, 4)
        pose = kelp.Pose(asset)
        moment, time = source.moment(source.json["animations"][0], 1)
        pose.add_clip(0, time, play=kelp.Play.ONCE)
        posed = kelp.Instance(asset, pose)
        world, owned = source.world(moment), 0
        for joint, node in zip(joints, nodes):
            for index in joint.parts:
                part = asset.parts[index]
                corners = np.array([(x, y, z, 1) for x in (0, part.size[0]) for y in (0, part.size[1])
                                    for z in (0, part.size[2])])
                voxel = np.linalg.norm(part.to_object[:3, 0])
                expected = corners @ (world[node] @ joint.inverse_bind @ part.to_object).T
                got = corners @ posed.part_to_world(int(index)).T
                self.assertLess(np.abs(got - expected).max(), 0.5 * voxel, part.name)
                self.assertGreater(np.abs(got - corners @ part.to_object.T).max(), 2 * voxel, part.name)
                owned += 1
        self.assertEqual(len(asset.parts), owned + 1)  # and the body, whose nodes follow them
        body = next(i for i in range(len(asset.parts)) if all(i not in joint.parts for joint in joints))
        driven = kelp.Pose(asset)
        driven.set_joints(asset, [world[node] @ joint.inverse_bind for joint, node in zip(joints, nodes)])
        self.assertLess(np.abs(driven.nodes(body) - pose.nodes(body)).max(), 0.02)
        self.assertGreater(np.abs(driven.nodes(body) - kelp.Pose(asset).nodes(body)).max(), 2)

        done = subprocess.run([DUMP, "info", pack, "--format", "json"], capture_output=True, text=True)
        told = json.loads(done.stdout)["joints"]
        self.assertEqual([joint.name for joint in joints], [joint["name"] for joint in told])
        for joint, line in zip(joints, told):
            self.assertEqual(joint.parent, -1 if line["parent"] is None else line["parent"])
            self.assertEqual(joint.parts.tolist(), line["parts"])
            self.near(np.array(line["inverse_bind"]).T, joint.inverse_bind[:3])

    def test_a_matrix_without_an_inverse(self):
        with tempfile.TemporaryDirectory() as folder:
            path = os.path.join(folder, "flat.gltf")
            with open(path, "w") as file:
                json.dump(two_skins(flat=True), file)
            pack, said = self.bake(path)
        self.assertIn("'node 2'", said)
        asset = self.open(pack)
        self.assertEqual([], asset.joints)
        self.assertEqual(1, len(asset.clips))

    def test_nothing_without_a_skin(self):
        self.assertEqual([], self.open(self.bake(self.real("draco_testdata/Box.glb"))[0]).joints)


def two_skins(flat=False):
    """Boxes on a chain of three joints, below a node that turns and shrinks; the mesh was made in centimeters
    with z up. The second skin has the last joint turned."""
    data, views, accessors = b"", [], []

    def add(kind, component, array, **more):
        nonlocal data
        packed = np.asarray(array, COMPONENTS[component]).tobytes()
        views.append({"buffer": 0, "byteOffset": len(data), "byteLength": len(packed)})
        data += packed + b"\0" * (-len(packed) % 4)
        accessors.append({"bufferView": len(views) - 1, "componentType": component, "type": kind,
                          "count": np.size(array) // WIDTHS[kind], **more})
        return len(accessors) - 1

    half = math.sqrt(0.5)
    armature = placed((3, 1, -2), (0, half, 0, half), (0.5, 0.5, 0.5))
    chain = [placed((0, 1, 0), (0.6, 0, 0, 0.8)), placed((0, 2, 0)), placed((0, 2, 0), (0, 0, 0.6, 0.8))]
    bound = [armature @ placed((0, 1, 0), (0.6, 0, 0, 0.8))]  # straight
    bound += [bound[0] @ placed((0, 2, 0)), bound[0] @ placed((0, 4, 0))]
    from_mesh = placed((5, 0, 0), (-half, 0, 0, half), (0.01, 0.01, 0.01))
    inverse = [np.linalg.inv(joint) @ from_mesh for joint in bound]
    turn = np.linalg.inv(bound[2] @ placed((0, 0, 0), (0, 0.8, 0, 0.6))) @ from_mesh
    if flat:
        inverse[1] = inverse[1] @ np.diag([1, 1, 0, 1])
    faces = [0, 1, 3, 0, 3, 2, 4, 6, 7, 4, 7, 5, 0, 4, 5, 0, 5, 1, 2, 3, 7, 2, 7, 6, 0, 2, 6, 0, 6, 4,
             1, 5, 7, 1, 7, 3]

    def boxes(middles, joints, space):
        points = [(np.linalg.inv(space) @ middle @ (0.3 * a, 0.4 * b, 0.5 * c, 1))[:3] for middle in middles
                  for a in (-1, 1) for b in (-1, 1) for c in (-1, 1)]
        its = {"POSITION": add("VEC3", 5126, points, min=np.min(points, 0).tolist(),
                               max=np.max(points, 0).tolist())}
        if joints:
            its["JOINTS_0"] = add("VEC4", 5123, [(joint, 0, 0, 0) for joint in joints for _ in range(8)])
            its["WEIGHTS_0"] = add("VEC4", 5126, [(1, 0, 0, 0)] * (8 * len(joints)))
        return {"primitives": [{"attributes": its, "indices": add(
            "SCALAR", 5123, [8 * box + corner for box in range(len(middles)) for corner in faces])}]}

    def node(matrix, **more):
        return {"matrix": matrix.T.ravel().tolist(), **more}

    def moving(translation, rotation=(0, 0, 0, 1), **more):
        return {"translation": translation, "rotation": rotation, **more}

    aside = [joint @ placed((3, 0, 0)) for joint in bound]
    times = add("SCALAR", 5126, [0, 1], min=[0], max=[1])
    samplers, channels = [], []
    for target, path, kind, values in (
            (1, "translation", "VEC3", [(0, 1, 0), (1, 1.5, 0)]),
            (1, "rotation", "VEC4", [(0.6, 0, 0, 0.8), (0.6, 0, 0, 0.8)]),
            (2, "rotation", "VEC4", [(0, 0, 0, 1), (0, 0, 0.6, 0.8)]),
            (3, "rotation", "VEC4", [(0, 0, 0.6, 0.8), (0.6, 0, 0, 0.8)])):
        channels.append({"sampler": len(samplers), "target": {"node": target, "path": path}})
        samplers.append({"input": times, "output": add(kind, 5126, values)})
    return {
        "asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0, 5, 6]}],
        "nodes": [node(armature, children=[1]),
                  moving((0, 1, 0), (0.6, 0, 0, 0.8), name="hip", children=[2]),
                  moving((0, 2, 0), children=[3]),
                  moving((0, 2, 0), (0, 0, 0.6, 0.8), name="hip", children=[4]),
                  node(placed((0, 2, 0)), name="hat", mesh=2),
                  {"mesh": 0, "skin": 0}, {"mesh": 1, "skin": 1}],
        "meshes": [boxes(bound, [2, 1, 0], from_mesh), boxes(aside[2:], [1], from_mesh),
                   boxes([np.eye(4)], None, np.eye(4))],
        # children before parents
        "skins": [{"joints": [3, 2, 1], "inverseBindMatrices": add(
                      "MAT4", 5126, [inverse[j].T.ravel() for j in (2, 1, 0)])},
                  {"joints": [1, 3], "inverseBindMatrices": add(
                      "MAT4", 5126, [inverse[0].T.ravel(), turn.T.ravel()])}],
        "animations": [{"name": "bend", "samplers": samplers, "channels": channels}],
        "accessors": accessors, "bufferViews": views,
        "buffers": [{"byteLength": len(data), "uri": "data:application/octet-stream;base64," +
                     base64.b64encode(data).decode()}]}


if __name__ == "__main__":
    unittest.main()
