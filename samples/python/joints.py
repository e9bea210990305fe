# SPDX-License-Identifier: MIT
"""Usage: joints.py MODEL.gltf|.glb PACK.kelp PICTURE.png [CLIP [SECONDS]]

Moves the skeleton of a pack as an engine would, by the matrices of its own animation: those that this program
computes from the glTF file, from which the pack was baked. Draws the pack (left) beside the file's skinned
triangles (right). Reads what exporters write: buffers, linear, step and cubic keys; no compression."""
import base64
import json
import os
import struct
import sys

import kelp
import numpy as np

SIZE = (480, 480)
TYPES = {5120: "i1", 5121: "u1", 5122: "<i2", 5123: "<u2", 5125: "<u4", 5126: "<f4"}
NUMBERS = {"SCALAR": 1, "VEC2": 2, "VEC3": 3, "VEC4": 4, "MAT4": 16}


class Model:
    def __init__(self, path):
        with open(path, "rb") as file:
            data = file.read()
        chunk = None
        if data[:4] == b"glTF":
            size = struct.unpack("<I", data[12:16])[0]
            data, chunk = data[20:20 + size], data[28 + size:]
        self.json = json.loads(data)
        self.buffers = [self.load(path, buffer.get("uri"), chunk) for buffer in self.json["buffers"]]
        self.nodes = self.json["nodes"]
        self.parents = {child: i for i, node in enumerate(self.nodes) for child in node.get("children", [])}

    @staticmethod
    def load(path, uri, chunk):
        if uri is None:
            return chunk
        if uri.startswith("data:"):
            return base64.b64decode(uri.split(",", 1)[1])
        with open(os.path.join(os.path.dirname(path), uri), "rb") as file:
            return file.read()

    def read(self, index):
        """An accessor: (count, numbers), normalized integers as fractions."""
        accessor = self.json["accessors"][index]
        view = self.json["bufferViews"][accessor["bufferView"]]
        kind, numbers = np.dtype(TYPES[accessor["componentType"]]), NUMBERS[accessor["type"]]
        at = view.get("byteOffset", 0) + accessor.get("byteOffset", 0)
        step = view.get("byteStride") or kind.itemsize * numbers
        raw = np.frombuffer(self.buffers[view["buffer"]], "u1")
        rows = at + step * np.arange(accessor["count"])[:, None] + np.arange(kind.itemsize * numbers)
        values = np.ascontiguousarray(raw[rows]).view(kind).astype(float)
        return values / np.iinfo(kind).max if accessor.get("normalized") else values

    def worlds(self, clip, seconds):
        """The matrix of each node in the scene at a moment of an animation; None: at rest."""
        nodes = [dict(node) for node in self.nodes]
        for channel in clip["channels"] if clip else []:
            sampler, target = clip["samplers"][channel["sampler"]], channel["target"]
            if "node" in target and target["path"] != "weights":
                nodes[target["node"]][target["path"]] = self.sample(sampler, target["path"], seconds)
        worlds = {}

        def world(i):
            if i not in worlds:
                above = world(self.parents[i]) if i in self.parents else np.eye(4)
                worlds[i] = above @ local(nodes[i])
            return worlds[i]

        return [world(i) for i in range(len(nodes))]

    def sample(self, sampler, path, seconds):
        times, values = self.read(sampler["input"])[:, 0], self.read(sampler["output"])
        how = sampler.get("interpolation", "LINEAR")
        if how == "CUBICSPLINE":
            into, values, out = values[0::3], values[1::3], values[2::3]
        after = int(np.searchsorted(times, seconds, "right"))
        if after in (0, len(times)):
            return values[0 if after == 0 else -1]
        a, b, span = values[after - 1], values[after], times[after] - times[after - 1]
        t = (seconds - times[after - 1]) / span
        if how == "STEP":
            return a
        if how == "CUBICSPLINE":
            return ((2 * t**3 - 3 * t**2 + 1) * a + (t**3 - 2 * t**2 + t) * span * out[after - 1]
                    + (3 * t**2 - 2 * t**3) * b + (t**3 - t**2) * span * into[after])
        if path == "rotation":
            b = -b if a @ b < 0 else b
            angle = np.arccos(np.clip(a @ b, -1, 1))
            if angle > 1e-6:
                return (np.sin((1 - t) * angle) * a + np.sin(t * angle) * b) / np.sin(angle)
        return (1 - t) * a + t * b

    def skinned(self, worlds):
        """The triangles of all skinned meshes, (n, 3, 3), as linear blend skinning draws them."""
        found = []
        for node in self.nodes:
            if "mesh" not in node or "skin" not in node:
                continue
            skin = self.json["skins"][node["skin"]]
            inverse = self.read(skin["inverseBindMatrices"]).reshape(-1, 4, 4).transpose(0, 2, 1)
            matrices = np.array([worlds[joint] for joint in skin["joints"]]) @ inverse
            for primitive in self.json["meshes"][node["mesh"]]["primitives"]:
                names = primitive["attributes"]
                points = self.read(names["POSITION"])
                joints, weights = self.read(names["JOINTS_0"]).astype(int), self.read(names["WEIGHTS_0"])
                blended = np.einsum("vk,vkab->vab", weights / weights.sum(1, keepdims=True), matrices[joints])
                posed = np.einsum("vab,vb->va", blended, np.c_[points, np.ones(len(points))])[:, :3]
                order = self.read(primitive["indices"]) if "indices" in primitive else np.arange(len(points))
                found.append(posed[order.astype(int).reshape(-1, 3)])
        return np.concatenate(found)


def local(node):
    if "matrix" in node:
        return np.array(node["matrix"], float).reshape(4, 4).T
    turn = np.array(node.get("rotation", (0, 0, 0, 1)), float)
    x, y, z, w = turn / np.linalg.norm(turn)
    turn = np.array([[1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
                     [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
                     [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)]])
    matrix = np.eye(4)
    matrix[:3, :3] = turn * np.array(node.get("scale", (1, 1, 1)))
    matrix[:3, 3] = node.get("translation", (0, 0, 0))
    return matrix


def draw(triangles, view, background):
    """A picture of triangles in gray, lit from the eye: the nearest wins."""
    width, height = size = view.viewport
    image = np.tile(np.array(background[:3]) * 255, (height, width, 1))
    depth = np.full((height, width), np.inf)
    corners = np.concatenate([triangles, np.ones(triangles.shape[:2] + (1,))], 2)
    eye = corners @ np.asarray(view.world_to_eye).T
    clip = eye @ np.asarray(view.eye_to_clip).T
    screen = (clip[..., :2] / clip[..., 3:] * (1, -1) + 1) / 2 * size
    seen = (screen.min(1) < size).all(1) & (screen.max(1) > 0).all(1)
    for points, ends in zip(screen[seen], eye[seen, :, :3]):
        normal = np.cross(ends[1] - ends[0], ends[2] - ends[0])
        low = np.clip(np.floor(points.min(0)).astype(int), 0, size)
        high = np.clip(np.ceil(points.max(0)).astype(int) + 1, 0, size)
        edges = np.column_stack([points[1] - points[0], points[2] - points[0]])
        if abs(np.linalg.det(edges)) < 1e-12:
            continue
        y, x = np.mgrid[low[1]:high[1], low[0]:high[0]]
        pixels = np.array([x.ravel(), y.ravel()]) + 0.5
        b, c = np.linalg.inv(edges) @ (pixels - points[0][:, None])
        far = 1 / ((1 - b - c) / -ends[0, 2] + b / -ends[1, 2] + c / -ends[2, 2])
        window = depth[low[1]:high[1], low[0]:high[0]]
        wins = ((b >= 0) & (c >= 0) & (b + c <= 1)).reshape(x.shape) & (far.reshape(x.shape) < window)
        window[wins] = far.reshape(x.shape)[wins]
        light = abs(normal[2]) / np.linalg.norm(normal)
        image[low[1]:high[1], low[0]:high[0]][wins] = 80 + 140 * light
    return image.astype(np.uint8)


def main(model_path, pack, picture, wanted=None, seconds=0.25):
    model = Model(model_path)
    clips = model.json.get("animations", [])
    clip = next((clip for clip in clips if clip.get("name") == wanted), clips[0] if clips else None)
    worlds = model.worlds(clip, float(seconds))
    names = {node.get("name") or "node %d" % i: i for i, node in enumerate(model.nodes)}
    with kelp.Canvas(*SIZE) as canvas, kelp.Asset(pack) as asset:
        pose = kelp.Pose(asset)
        pose.set_joints(asset, [worlds[names[joint.name]] @ joint.inverse_bind for joint in asset.joints])
        instance = kelp.Instance(asset, pose)
        low, high = instance.bounds()
        middle, far = (low + high) / 2, 0.8 * np.linalg.norm(high - low)
        view = kelp.View.look_at(SIZE, eye=middle + far * np.array((0.8, 0.2, 0.55)), target=middle)
        asset.load_all()
        renderer = kelp.Renderer(canvas)
        renderer.add(asset)
        background = (0.85, 0.87, 0.9, 1)
        left = np.asarray(renderer.picture(view, instance, background=background))
        right = draw(model.skinned(worlds), view, background)
        kelp.write_png(picture, np.concatenate([left[..., :3], right], 1))
        inside = (left[..., :3] != left[0, 0, :3]).any(2), (right != right[0, 0]).any(2)
        print("the outlines have %.1f %% in common" % (100 * (inside[0] & inside[1]).sum()
                                                      / (inside[0] | inside[1]).sum()))


if __name__ == "__main__":
    if not 4 <= len(sys.argv) <= 6:
        sys.exit(__doc__)
    main(*sys.argv[1:])
