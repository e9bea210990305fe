# SPDX-License-Identifier: MIT
"""check_skinned.py BIN MODELS PICTURES OUT: the sample model octopus, read as glTF 2.0, skinned as the
specification says, and baked; then PICTURES/skins.py at a small size, without the assets. Without kelp-render
in BIN, or without EGL, no pictures are looked at."""

import json
import math
import os
import shutil
import subprocess
import sys

from check_figures import check_sheet, coloured, differing, share_of
from check_models import (ARRAY_BUFFER, ELEMENT_ARRAY_BUFFER, area_vector, check_normals, check_surface, dot,
                          read_accessor, read_glb, require)

# Clips: how long, and by how many degrees the farthest bent arm turns at least, from its first joint to its
# last, at the moment when it turns most.
CLIPS = {"swim": (2.4, 75), "idle": (8.0, 240)}
ARMS, JOINTS = 8, 6


def product(p, q):
    """Of quaternions x, y, z, w."""
    (a, b, c, d), (e, f, g, h) = p, q
    return (d * e + a * h + b * g - c * f, d * f - a * g + b * h + c * e, d * g + a * f - b * e + c * h,
            d * h - a * e - b * f - c * g)


def rotated(q, v):
    return product(product(q, (*v, 0.0)), (-q[0], -q[1], -q[2], q[3]))[:3]


class Skinned:
    """A model with a skin whose joints are not turned at rest."""

    def __init__(self, path):
        self.document, self.binary = read_glb(path)
        self.nodes = self.document["nodes"]
        self.joints = self.document["skins"][0]["joints"]
        self.parent = {child: node for node, fields in enumerate(self.nodes)
                       for child in fields.get("children", [])}
        _, self.inverses = self.floats(self.document["skins"][0]["inverseBindMatrices"], "MAT4")
        self.positions, self.influences, self.triangles = [], [], []
        for primitive in self.document["meshes"][0]["primitives"]:
            self.take(primitive)

    def floats(self, accessor, kind, target=None):
        return read_accessor(self.document, self.binary, accessor, {(kind, 5126)}, target)

    def take(self, primitive):
        """Checks one closed surface and its weights."""
        attributes = primitive["attributes"]
        require(set(attributes) == {"POSITION", "NORMAL", "COLOR_0", "JOINTS_0", "WEIGHTS_0"},
                "attributes %s" % sorted(attributes))
        _, positions = self.floats(attributes["POSITION"], "VEC3", ARRAY_BUFFER)
        _, normals = self.floats(attributes["NORMAL"], "VEC3", ARRAY_BUFFER)
        _, weights = self.floats(attributes["WEIGHTS_0"], "VEC4", ARRAY_BUFFER)
        _, joints = read_accessor(self.document, self.binary, attributes["JOINTS_0"], {("VEC4", 5121)},
                                  ARRAY_BUFFER)
        _, indices = read_accessor(self.document, self.binary, primitive["indices"], {("SCALAR", 5123)},
                                   ELEMENT_ARRAY_BUFFER)
        flat = [i for i, in indices]
        triangles = list(zip(flat[0::3], flat[1::3], flat[2::3]))
        require(len(positions) == len(normals) == len(weights) == len(joints), "counts differ")
        require(all(min(w) >= 0.0 and abs(sum(w) - 1.0) < 1e-6 for w in weights), "weights")
        require(all(j < len(self.joints) for four in joints for j in four), "a joint out of range")
        check_surface(positions, triangles, 1e-10)
        check_normals(positions, normals, triangles)
        first = len(self.positions)
        self.positions += positions
        self.influences += [[(j, w) for j, w in zip(*both) if w > 0.0] for both in zip(joints, weights)]
        self.triangles += [tuple(first + i for i in t) for t in triangles]

    def pose(self, moves):
        """Of each joint: its rotation and its place. moves: {(node, path): value}, of others the rest."""
        found = {}

        def node_pose(node):
            if node not in found:
                turn = moves.get((node, "rotation"), (0.0, 0.0, 0.0, 1.0))
                place = moves.get((node, "translation"), self.nodes[node]["translation"])
                if node in self.parent:
                    above_turn, above_place = node_pose(self.parent[node])
                    place = tuple(p + q for p, q in zip(above_place, rotated(above_turn, place)))
                    turn = product(above_turn, turn)
                found[node] = turn, place
            return found[node]

        return [node_pose(node) for node in self.joints]

    def skinned(self, pose):
        """Where linear blend skinning puts every vertex."""
        moved = []
        for position, influences in zip(self.positions, self.influences):
            place = [0.0, 0.0, 0.0]
            for joint, weight in influences:
                turn, origin = pose[joint]
                # The inverse bind matrix is a translation: its last column.
                local = [p + self.inverses[joint][12 + i] for i, p in enumerate(position)]
                for i, r in enumerate(rotated(turn, local)):
                    place[i] += weight * (r + origin[i])
            moved.append(place)
        return moved

    def clip(self, animation):
        """Times, and what moves at each of them."""
        times, moves = None, []
        for channel in animation["channels"]:
            sampler = animation["samplers"][channel["sampler"]]
            path, node = channel["target"]["path"], channel["target"]["node"]
            _, at = self.floats(sampler["input"], "SCALAR")
            _, values = self.floats(sampler["output"], "VEC4" if path == "rotation" else "VEC3")
            require(sampler["interpolation"] == "LINEAR" and node in self.joints and len(at) == len(values)
                    and (times is None or at == times), "a channel of %s" % path)
            require(path != "rotation" or all(abs(dot(q, q) + q[3] ** 2 - 1.0) < 1e-5 for q in values),
                    "a rotation is not of length 1")
            times, moves = at, moves or [{} for _ in at]
            for moment, value in zip(moves, values):
                moment[node, path] = value
        return [time for time, in times], moves


def arm_turns(model, moves, arm):
    """The sum of the angles between an arm's joints, in degrees."""
    turned = 0.0
    for node, fields in enumerate(model.nodes):
        if fields["name"].startswith("arm.%d." % arm) and not fields["name"].endswith(".0"):
            turned += 2.0 * math.degrees(math.acos(min(1.0, abs(moves[node, "rotation"][3]))))
    return turned


def check_clip(model, animation):
    """It repeats without a jump, bends the arms as claimed, and stretches no triangle apart."""
    duration, degrees = CLIPS[animation["name"]]
    times, moves = model.clip(animation)
    require(times[0] == 0.0 and abs(times[-1] - duration) < 1e-6 and times == sorted(set(times)), "times")
    require(moves[0] == moves[-1], animation["name"] + " does not repeat")
    most = {arm: max((arm_turns(model, moment, arm), index) for index, moment in enumerate(moves))
            for arm in range(ARMS)}
    require(min(turned for turned, _ in most.values()) > degrees,
            "%s turns its arms by %r" % (animation["name"], most))
    bent = model.skinned(model.pose(moves[most[0][1]]))
    areas = [[math.sqrt(dot(n, n)) for n in (area_vector(*(points[i] for i in t)) for t in model.triangles)]
             for points in (model.positions, bent)]
    grown = max(now - 3.0 * before for before, now in zip(*areas))
    require(grown < 1e-5, "%s stretches a triangle by %g square metres" % (animation["name"], grown))


def check_joints(model, rest):
    """Every joint of an arm is close to the middle of what it moves, which begins there."""
    sums = [[0.0] * 4 for _ in model.joints]
    for position, influences in zip(model.positions, model.influences):
        for joint, weight in influences:
            sums[joint] = [s + weight * p for s, p in zip(sums[joint], (*position, 1.0))]
    for node, (_, place), (x, y, z, total) in zip(model.joints, rest, sums):
        name = model.nodes[node]["name"]
        require(total > 0.0, name + " moves nothing")
        far = math.dist(place, (x / total, y / total, z / total))
        require(not name.startswith("arm.") or far < 0.035, "%s is %.3f m from what it moves" % (name, far))


def check_model(path):
    model = Skinned(path)
    document, joints = model.document, model.joints
    require(document["scenes"][0]["nodes"] == [0, joints[0]] and document["nodes"][0]["skin"] == 0, "scene")
    require(len(joints) == 3 + ARMS * JOINTS and len(set(joints)) == len(joints), "joints")
    rest = model.pose({})
    require(max(math.dist(a, b) for a, b in zip(model.positions, model.skinned(rest))) < 1e-6,
            "the skin does not stand still at rest")
    check_joints(model, rest)
    require([a["name"] for a in document["animations"]] == list(CLIPS), "clips")
    for animation in document["animations"]:
        check_clip(model, animation)


def check_pack(binaries, model, out):
    """The pack is sound, and its parts follow the skin."""
    pack, report = os.path.join(out, "baked.kelp"), os.path.join(out, "baked.json")
    for program, *arguments in (("kelp-bake", model, "-o", pack, "--resolution", "64", "--report", report),
                                ("kelp-dump", "verify", "--deep", pack)):
        done = subprocess.run([os.path.join(binaries, program), *arguments], capture_output=True, text=True,
                              timeout=300)
        require(done.returncode == 0, done.stderr)
    with open(report, encoding="utf-8") as file:
        fits = {clip["name"]: clip["fit"] for clip in json.load(file)["clips"]}
    require(set(fits) == set(CLIPS), "clips %s" % sorted(fits))
    for name, fit in fits.items():
        print("%s: %.2f voxels off in the mean, %.2f of 95 %%" % (name, fit["mean"], fit["p95"]))
        require(fit["mean"] < 0.3 and fit["p95"] < 1.0, "%s does not follow its skin: %r" % (name, fit))


def check_pictures(binaries, models, pictures, out):
    """The sheet of the octopus: something on every tile, another pose on each. Those of the assets are
    left out."""
    sys.path.insert(0, pictures)
    import png

    done = subprocess.run([sys.executable, "-B", os.path.join(pictures, "skins.py"), "--bin", binaries,
                           "--models", models, "--out", out, "--assets", os.path.join(out, "none"), "--tile",
                           "80", "--resolution", "64"], capture_output=True, text=True, timeout=600)
    if "no EGL device" in done.stderr:
        print("SKIPPED: " + done.stderr.strip())
        return
    require(done.returncode == 0 and done.stderr.count("is left out; set KELP_ASSETS") == 2, done.stderr)
    require(done.stdout.split() == [os.path.abspath(os.path.join(out, "octopus.png"))], done.stdout)
    tiles = check_sheet(png.read(done.stdout.strip()), 4, (80, 72), 5)
    require(len(tiles) == 8, "%d tiles" % len(tiles))
    for tile in tiles:
        require(0.03 < share_of(tile, coloured) < 0.6, "an octopus does not fill its tile, or is not there")
    for a, b in ((0, 1), (1, 2), (2, 3), (4, 5), (5, 6), (6, 7)):
        require(differing(tiles[a], tiles[b]) > 0.02, "two moments look the same")


def main(binaries, models, pictures, out):
    sys.dont_write_bytecode = True
    shutil.rmtree(out, ignore_errors=True)
    os.makedirs(out)
    model = os.path.join(models, "octopus.glb")
    check_model(model)
    check_pack(binaries, model, out)
    if os.path.exists(os.path.join(binaries, "kelp-render")):
        check_pictures(binaries, models, pictures, out)
    else:
        print("SKIPPED: no kelp-render for the pictures")


if __name__ == "__main__":
    main(*sys.argv[1:])
