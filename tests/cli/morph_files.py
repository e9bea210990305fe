#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""glTF files with morph targets: morph_files.py FOLDER writes each as NAME.gltf. `stress` is of the kind of
Khronos's MorphStressTest: a block of which each of eight targets raises a place."""

import json
import math
import os
import sys

from skinned_tube import Gltf

FLOAT, USHORT = 5126, 5123


def box(low, high, step):
    """The points and triangles of a box whose sides are grids of about `step`."""
    points, faces = [], []
    for axis in range(3):
        u, v = (axis + 1) % 3, (axis + 2) % 3
        nu, nv = (max(1, round((high[k] - low[k]) / step)) for k in (u, v))
        for side in (low, high):
            first = len(points)
            for j in range(nv + 1):
                for i in range(nu + 1):
                    point = [0.0] * 3
                    point[axis] = side[axis]
                    point[u] = low[u] + (high[u] - low[u]) * i / nu
                    point[v] = low[v] + (high[v] - low[v]) * j / nv
                    points.append(point)
            for j in range(nv):
                for i in range(nu):
                    a = first + j * (nu + 1) + i
                    b, c, d = a + 1, a + nu + 1, a + nu + 2
                    faces += [a, b, d, a, d, c] if side is high else [a, d, b, a, c, d]
    return points, faces


def bump(distance, radius):
    """1 in the middle, smoothly 0 at `radius`."""
    return 0.5 + 0.5 * math.cos(math.pi * min(abs(distance) / radius, 1))


def flat(vectors):
    return [x for vector in vectors for x in vector]


class File(Gltf):
    """Nodes, meshes and animations beside the accessors. Nodes are roots, but those of a chain of joints."""

    def __init__(self):
        super().__init__()
        self.nodes, self.meshes, self.animations, self.skins, self.roots = [], [], {}, [], []

    def sparse(self, vectors):
        """An accessor of zeros, of which those that are none are stored."""
        moved = [i for i, vector in enumerate(vectors) if any(vector)]
        stored = (self.add("SCALAR", USHORT, moved), self.add("VEC3", FLOAT, flat(vectors[i] for i in moved)))
        views = [self.accessors[a]["bufferView"] for a in stored]
        self.accessors.append({"componentType": FLOAT, "type": "VEC3", "count": len(vectors), "sparse": {
            "count": len(moved), "indices": {"bufferView": views[0], "componentType": USHORT},
            "values": {"bufferView": views[1]}}})
        return len(self.accessors) - 1

    def mesh(self, points, faces, targets, names=None, sparse=False, weights=None, follow=None):
        """A node with a mesh; targets: functions of a point; follow(point): its joints and weights."""
        low, high = ([choose(p[k] for p in points) for k in range(3)] for choose in (min, max))
        attributes = {"POSITION": self.add("VEC3", FLOAT, flat(points), min=low, max=high)}
        if follow:
            attributes["JOINTS_0"] = self.add("VEC4", USHORT, flat(follow(p)[0] for p in points))
            attributes["WEIGHTS_0"] = self.add("VEC4", FLOAT, flat(follow(p)[1] for p in points))
        primitive = {"attributes": attributes, "indices": self.add("SCALAR", USHORT, faces), "targets": []}
        for target in targets:
            offsets = [target(p) for p in points]
            primitive["targets"].append(
                {"POSITION": self.sparse(offsets) if sparse else self.add("VEC3", FLOAT, flat(offsets))})
        mesh = {"name": "mesh%d" % len(self.meshes), "primitives": [primitive]}
        if names:
            mesh["extras"] = {"targetNames": names}
        if weights:
            mesh["weights"] = weights
        self.meshes.append(mesh)
        index = len(self.meshes) - 1
        return self.node("body%d" % index, mesh=index, **({"skin": 0} if follow else {}))

    def node(self, name, root=True, **more):
        self.nodes.append({"name": name, **more})
        if root:
            self.roots.append(len(self.nodes) - 1)
        return len(self.nodes) - 1

    def joints(self, places):
        """A chain of joints and the skin of it."""
        first = len(self.nodes)
        for k, (place, before) in enumerate(zip(places, [(0, 0, 0)] + places)):
            more = {"children": [first + k + 1]} if k + 1 < len(places) else {}
            self.node("bone%d" % k, k == 0, translation=[a - b for a, b in zip(place, before)], **more)
        binds = [x for p in places for x in (1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, -p[0], -p[1], -p[2], 1)]
        self.skins.append({"joints": list(range(first, first + len(places))),
                           "inverseBindMatrices": self.add("MAT4", FLOAT, binds)})
        return first

    def animate(self, clip, node, path, times, values, interpolation="LINEAR"):
        animation = self.animations.setdefault(clip, {"name": clip, "samplers": [], "channels": []})
        kind = {"weights": "SCALAR", "rotation": "VEC4"}.get(path, "VEC3")
        keys = self.add("SCALAR", FLOAT, times, min=[times[0]], max=[times[-1]])
        animation["samplers"].append({"input": keys, "output": self.add(kind, FLOAT, values),
                                      "interpolation": interpolation})
        animation["channels"].append({"sampler": len(animation["samplers"]) - 1,
                                      "target": {"node": node, "path": path}})

    def json(self):
        document = {"asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": self.roots}],
                    "nodes": self.nodes, "meshes": self.meshes, "accessors": self.accessors,
                    "bufferViews": self.views, "buffers": [self.buffer()]}
        if self.animations:
            document["animations"] = list(self.animations.values())
        if self.skins:
            document["skins"] = self.skins
        return document


STRESS = [(-2.1 + 0.6 * k, 0.25 if k % 2 else -0.25) for k in range(8)]


def stress():
    """A block with eight places that targets raise, in three clips."""
    file = File()

    def raised(place):
        return lambda p: [0, 0.5 * p[1] / 0.8 * bump(p[0] - place[0], 0.5) * bump(p[2] - place[1], 0.5), 0]

    node = file.mesh(*box((-2.4, 0, -0.7), (2.4, 0.8, 0.7), 0.1), [raised(place) for place in STRESS],
                     ["Key %d" % (k + 1) for k in range(8)])
    one = [[1.0 if i == k else 0.0 for i in range(8)] for k in range(8)]
    file.animate("Individuals", node, "weights", [0.5 * k for k in range(9)], flat(one + [[0.0] * 8]))
    wave = []
    for key in range(5):  # a cubic: in-slope, value, out-slope
        phase = [0.5 * math.pi * key - 0.7 * k for k in range(8)]
        slope = [0.5 * math.pi * 0.5 * math.sin(a) for a in phase]
        wave += slope + [0.5 - 0.5 * math.cos(a) for a in phase] + slope
    file.animate("TheWave", node, "weights", [0, 1, 2, 3, 4], wave, "CUBICSPLINE")
    file.animate("Pulse", node, "weights", [0, 0.25, 0.75], [0.0] * 8 + [1.0, 0.0] * 4 + [0.5] * 8, "STEP")
    return file.json()


def skinned():
    """A column that bends by four joints, and bulges."""
    file = File()

    def follow(p):
        at = min(max(p[1] - 0.5, 0), 3)
        low = min(int(at), 2)
        return (low, low + 1, 0, 0), (1 - (at - low), at - low, 0, 0)

    def bulge(p):
        return [0.6 * bump(p[1] - 2, 1.2) * x for x in (p[0], 0, p[2])]

    def lean(p):
        return [0.06 * p[1] * p[1], 0, 0]

    node = file.mesh(*box((-0.4, 0, -0.4), (0.4, 4, 0.4), 0.1), [bulge, lean], ["bulge", "lean"],
                     follow=follow)
    bones = file.joints([(0, float(k), 0) for k in range(4)])
    for k in range(1, 4):
        file.animate("curl", bones + k, "rotation", [0, 1, 2],
                     [0, 0, 0, 1, 0, 0, math.sin(0.2), math.cos(0.2), 0, 0, 0, 1])
    file.animate("curl", node, "weights", [0, 0.5, 2], [0, 0, 1, 0.3, 0, -0.5])
    file.animate("breathe", node, "weights", [0, 1, 2], [0, 0, 1, 0, 0, 0])
    return file.json()


def sparse():
    """Targets of which few values are stored, of a mesh that is turned and mirrored; no names or clips."""
    file = File()
    targets = [lambda p, k=k: [0, 0, 0.4 * p[2] * bump(p[1] - 0.5 - k, 0.6) * bump(p[0], 0.5)]
               for k in range(2)]
    node = file.mesh(*box((-0.5, 0, -0.5), (0.5, 2, 0.5), 0.1), targets, sparse=True)
    file.nodes[node].update(rotation=[0, 0, math.sin(0.3), math.cos(0.3)], scale=[1, 1.5, -0.8],
                            translation=[3, 1, 2])
    return file.json()


def resting():
    """Weights at rest: those of the node, not of its mesh; a clip goes on from them to others."""
    file = File()
    targets = [lambda p: [0.3 * p[1], 0, 0], lambda p: [0, 0, 0.75 * p[2] * bump(p[1] - 1, 0.8)]]
    node = file.mesh(*box((-0.4, 0, -0.4), (0.4, 2, 0.4), 0.1), targets, ["shear", "swell"], weights=[9, 9])
    file.nodes[node]["weights"] = [0.5, -0.25]
    file.animate("move", node, "weights", [0, 1, 2], [0.5, -0.25, 1, 1, 0, -0.25])
    return file.json()


def pair():
    """Two boxes with targets of the same names: `smile` moves alike, `blink` does not."""
    file = File()
    targets = [lambda p: [0, 0, 0.3 * bump(p[0], 0.5) * (p[2] + 0.5)],
               lambda p: [0, 0.25 * bump(p[0], 0.5) * (p[1] + 0.5), 0]]
    nodes = [file.mesh(*box((-0.5, -0.5, -0.5), (0.5, 0.5, 0.5), 0.1), targets, ["smile", "blink"])
             for _ in range(2)]
    file.nodes[nodes[1]].update(translation=[2, 0, 0], scale=[0.5, 1, 2])
    file.animate("play", nodes[0], "weights", [0, 1, 2], [0, 0, 1, 1, 0, 0])
    file.animate("play", nodes[1], "weights", [0, 1, 2], [0, 0, 1, 0, 0, 1])
    return file.json()


def jaws():
    """A block with a slit that is closed: above and below it, the mesh goes different ways."""
    file, points, faces = File(), [], []
    along = [-1 + 0.125 * k for k in range(17)]

    def point(x, z, row, side):
        gap = 0.004 if z > 0 else 0
        return [x, side * (gap + (1 - gap) * row / 8), z]

    def quad(a, b, c, d, flip=False):
        first = len(points)
        points.extend([a, d, c, b] if flip else [a, b, c, d])
        faces.extend([first, first + 1, first + 2, first, first + 2, first + 3])

    square = ((0, 0), (1, 0), (1, 1), (0, 1))
    for side in (1, -1):
        for i in range(16):
            for row in range(8):
                for x in (1, -1):  # the ends
                    quad(*(point(x, along[i + a], row + b, side) for b, a in square), x * side < 0)
                for z in (1, -1):  # front and back
                    quad(*(point(along[i + a], z, row + b, side) for a, b in square), z * side < 0)
            for k in range(16):  # top and bottom; the slit
                for row in (8, 0) if along[k] >= 0 else (8,):
                    quad(*(point(along[i + a], along[k + b], row, side) for b, a in square),
                         side * (row - 4) < 0)
    file.mesh(points, faces, [lambda p: [0, math.copysign(0.5 * max(p[2], 0), p[1]), 0]], ["open"])
    return file.json()


FILES = {"stress": stress, "skinned": skinned, "sparse": sparse, "resting": resting, "pair": pair,
         "jaws": jaws}


def main(folder):
    os.makedirs(folder, exist_ok=True)
    for name, make in FILES.items():
        with open(os.path.join(folder, name + ".gltf"), "w", encoding="ascii") as file:
            json.dump(make(), file)


if __name__ == "__main__":
    main(sys.argv[1])
