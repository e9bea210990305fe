# SPDX-License-Identifier: MIT
"""A skinned glTF file, made in memory."""

import base64
import json
import math
import struct

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
