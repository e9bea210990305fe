#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Checks what samples/models/make_models.py wrote, as a reader would who knows glTF 2.0 but not the
script, and that it writes the same again.

Usage: check_models.py path/to/make_models.py MODELS
MODELS is a folder that it has written.
"""

import filecmp
import json
import math
import os
import struct
import subprocess
import sys
import tempfile

# Axis, size along the axis in metres, clips and how far each moves the far end (in units of that size); of
# clips made of keys: by how many degrees the spline turns at most, from its first knot to its last.
EXPECTED = {
    "kelp_plant": ("+y", 1.2, {"sway": (0.15, 0.35), "current": (0.25, 0.40)}),
    "sea_grass": ("+y", 0.8, {"sway": (0.20, 0.40)}),
    "dulse": ("+y", 0.5, {"sway": (0.10, 0.25)}),
    "orange": ("+y", 0.11, {"wobble": (0.10, 0.25)}),
    "fish": ("-x", 0.3, {"swim": (0.10, 0.20)}),
    "fusilier": ("-x", 0.24, {"swim": (0.08, 0.20), "turn": 90}),
    "tentacle": ("+y", 0.6, {"curl": 270, "sway": (0.15, 0.35)}),
    "seabed": ("+y", 0.085, {}),
}
SKINNED = ("octopus",)  # check_skinned.py looks at what is in them
COMPONENTS = {5126: ("f", 4), 5121: ("B", 1), 5123: ("H", 2), 5125: ("I", 4)}
WIDTHS = {"SCALAR": 1, "VEC3": 3, "VEC4": 4, "MAT4": 16}
ARRAY_BUFFER, ELEMENT_ARRAY_BUFFER = 34962, 34963


class Fault(Exception):
    pass


def require(condition, what):
    if not condition:
        raise Fault(what)


def cross(a, b):
    return (a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0])


def dot(a, b):
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


def area_vector(p, q, r):
    """Normal of a triangle, twice its area long."""
    return cross((q[0] - p[0], q[1] - p[1], q[2] - p[2]), (r[0] - p[0], r[1] - p[1], r[2] - p[2]))


def read_glb(path):
    """The document and the binary chunk; checks header, chunk order, lengths and padding (glTF 2.0, section
    4.4)."""
    with open(path, "rb") as file:
        data = file.read()
    magic, version, length = struct.unpack_from("<4sII", data)
    require((magic, version, length) == (b"glTF", 2, len(data)), "header is %r" % ((magic, version, length),))
    json_size, json_type = struct.unpack_from("<I4s", data, 12)
    require(json_type == b"JSON" and json_size % 4 == 0,
            "the first chunk is %r, %d bytes" % (json_type, json_size))
    bin_size, bin_type = struct.unpack_from("<I4s", data, 20 + json_size)
    require(bin_type == b"BIN\0" and bin_size % 4 == 0,
            "the second chunk is %r, %d bytes" % (bin_type, bin_size))
    require(28 + json_size + bin_size == len(data), "bytes after the last chunk")

    def no_constants(text):
        raise Fault("JSON has %s" % text)

    document = json.loads(data[20:20 + json_size].decode("utf-8"), parse_constant=no_constants)
    require(document["asset"]["version"] == "2.0", "asset.version")
    require(len(document["buffers"]) == 1 and 0 <= bin_size - document["buffers"][0]["byteLength"] < 4,
            "buffers[0].byteLength")
    return document, data[28 + json_size:]


def read_accessor(document, binary, index, kinds, target):
    accessor = document["accessors"][index]
    view = document["bufferViews"][accessor["bufferView"]]
    letter, size = COMPONENTS[accessor["componentType"]]
    width = WIDTHS[accessor["type"]]
    place = "accessors[%d]" % index
    require((accessor["type"], accessor["componentType"]) in kinds,
            "%s is %s of %d" % (place, accessor["type"], accessor["componentType"]))
    require(view.get("target") == target and view["buffer"] == 0 and "byteStride" not in view,
            place + ": its view's target")
    start = view.get("byteOffset", 0) + accessor.get("byteOffset", 0)
    require(start % 4 == 0, place + " is not aligned")
    require(accessor.get("byteOffset", 0) + accessor["count"] * width * size <= view["byteLength"],
            place + " leaves its view")
    require(view.get("byteOffset", 0) + view["byteLength"] <= document["buffers"][0]["byteLength"],
            place + ": its view leaves the buffer")
    values = list(struct.iter_unpack("<%d%s" % (width, letter),
                                     binary[start:start + accessor["count"] * width * size]))
    require(all(map(math.isfinite, (x for v in values for x in v))), place + " is not finite")
    for bound, choose in (("min", min), ("max", max)):
        if bound in accessor:
            require(accessor[bound] == [choose(c) for c in zip(*values)], "%s.%s" % (place, bound))
    return accessor, values


def components(count, triangles):
    """Triangles grouped by connected component."""
    parent = list(range(count))

    def root(i):
        while parent[i] != i:
            parent[i] = parent[parent[i]]
            i = parent[i]
        return i

    for a, b, c in triangles:
        parent[root(b)] = root(a)
        parent[root(c)] = root(a)
    groups = {}
    for t in triangles:
        groups.setdefault(root(t[0]), []).append(t)
    return list(groups.values())


def check_surface(positions, triangles, least_area):
    """Every component closed, two-manifold, consistently wound, facing outward, without slivers of no area.
    Returns their number."""
    require({i for t in triangles for i in t} == set(range(len(positions))),
            "an index out of range, or a vertex without a triangle")
    require(len(set(positions)) == len(positions), "two vertices share a position")
    edges = set()
    for t in triangles:
        a, b, c = t
        for edge in ((a, b), (b, c), (c, a)):
            if edge[0] == edge[1] or edge in edges:
                raise Fault("triangle %r repeats a vertex, or walks an edge in a direction already taken"
                            % (t,))
            edges.add(edge)
    for a, b in edges:
        if (b, a) not in edges:
            raise Fault("edge %r has no opposite: the surface is open" % ((a, b),))
    groups = components(len(positions), triangles)
    for group in groups:
        volume, area = 0.0, 0.0
        for a, b, c in group:
            p, q, r = positions[a], positions[b], positions[c]
            n = area_vector(p, q, r)
            size = 0.5 * math.sqrt(dot(n, n))
            if size <= least_area:
                raise Fault("triangle %r has the area %g" % ((a, b, c), size))
            area += size
            volume += dot(p, cross(q, r)) / 6.0
        require(volume > 0.0, "a component of %d triangles faces inward" % len(group))
        # Half the mean thickness of a sheet is volume / area: nothing is a mere film.
        require(volume / area > 1e-3 * math.sqrt(area), "a component of %d triangles is a film" % len(group))
    return len(groups)


def check_normals(positions, normals, triangles):
    require(all(abs(dot(n, n) - 1.0) < 1e-4 for n in normals), "a normal is not of length 1")
    against = 0
    for a, b, c in triangles:
        n = area_vector(positions[a], positions[b], positions[c])
        against += (dot(n, normals[a]) <= 0.0) + (dot(n, normals[b]) <= 0.0) + (dot(n, normals[c]) <= 0.0)
    require(against < 1e-3 * len(triangles), "%d corners have normals against their triangle" % against)


def check_rig(rig, expected_axis, clips):
    """The rig of extras.kelp. A rig with a clip that turns is swept, all others say nothing."""
    swept = {"bend"} if any(isinstance(claim, int) for claim in clips.values()) else set()
    require(set(rig) - {"sockets"} == {"kelp", "axis", "knots", "clips"} | swept and rig["kelp"] == 1,
            "extras.kelp has the keys %s" % sorted(rig))
    require(rig["axis"] == expected_axis and rig.get("bend", "sweep") == "sweep",
            "axis is %s, bend %s" % (rig["axis"], rig.get("bend")))
    at = [knot["at"] for knot in rig["knots"]]
    rooted = clips and not any(move["knot"] == 0 for clip in rig["clips"].values()
                               for move in clip.get("waves", []) + clip.get("keys", []))
    root = {"at": 0, "tangent": [0, 1, 0]} if rooted else {"at": 0}  # a root stays upright
    require(rig["knots"] == [root] + [{"at": place} for place in at[1:]] and at[-1] == 1
            and at == sorted(set(at)), "knots %r" % rig["knots"])
    require(set(rig["clips"]) == set(clips), "clips are %s" % sorted(rig["clips"]))
    for name, clip in rig["clips"].items():
        if isinstance(clips[name], int):
            check_keys(name, clip, expected_axis, at, clips[name])
        else:
            check_waves(name, clip, expected_axis, len(at), *clips[name])


def check_waves(name, clip, axis, knots, least, most):
    for wave in clip["waves"]:
        kind = "offset" if "offset" in wave else "tangent"
        require(set(wave) == {"knot", kind, "period", "phase"},
                "%s: a wave has the keys %s" % (name, sorted(wave)))
        require(0 <= wave["knot"] < knots and wave["period"] > 0 and len(wave[kind]) == 3,
                "%s: %r" % (name, wave))
        require(wave[kind]["xyz".index(axis[1])] == 0,
                "%s moves along the axis: the spline would not stay monotone beyond doubt" % name)
        require(axis != "+y" or kind == "tangent" or wave["knot"] > 0, "%s moves the foot" % name)
    longest = max(wave["period"] for wave in clip["waves"])
    require(all(abs(longest / w["period"] - round(longest / w["period"])) < 1e-6 for w in clip["waves"]),
            "%s does not loop" % name)
    reach = 0.0
    for step in range(240):
        moved = [0.0, 0.0, 0.0]
        for wave in clip["waves"]:
            if wave["knot"] == knots - 1 and "offset" in wave:
                phase = math.sin(2.0 * math.pi * (step / 240.0 * longest / wave["period"] + wave["phase"]))
                moved = [m + phase * x for m, x in zip(moved, wave["offset"])]
        reach = max(reach, math.sqrt(dot(moved, moved)))
    require(least <= reach <= most, "%s moves the far end by %.3f" % (name, reach))


def check_keys(name, clip, axis, at, degrees):
    """Cubic keys that loop: from rest to rest without a jump. Between the knots' places at every key lie
    chords that are not longer than the straight spline; the tangents turn as claimed."""
    along = "xyz".index(axis[1])
    sign = 1 if axis[0] == "+" else -1
    straight = [sign * (i == along) for i in range(3)]
    times = sorted({key["time"] for key in clip["keys"]})
    require(times[0] == 0 and times[-1] == clip["duration"] and clip["interpolation"] == "cubic", name)
    values = {(key["time"], key["knot"], kind): key[kind] for key in clip["keys"]
              for kind in ("offset", "tangent") if kind in key}
    moved = {key[1:] for key in values}
    require(len(values) == len(clip["keys"]) == len(times) * len(moved), "%s: keys are missing" % name)
    for key in clip["keys"]:
        require(axis != "+y" or key["knot"] > 0, "%s moves the foot" % name)
        if key["time"] in (times[0], times[-1]):
            require(not any(key.get("offset", []) + key.get("tangent", []) + key["in"] + key["out"]),
                    "%s does not begin and end at rest: %r" % (name, key))
    most = 0.0
    for time in times:
        def value(knot, kind, time=time):
            return values.get((time, knot, kind), (0, 0, 0))

        line = [[p * s + o for s, o in zip(straight, value(k, "offset"))] for k, p in enumerate(at)]
        for k in range(len(at) - 1):
            require(0.85 < math.dist(line[k], line[k + 1]) / (at[k + 1] - at[k]) < 1.001,
                    "%s: the spline is not as long as it was, %g s, knot %d" % (name, time, k))
        turned, before = 0.0, None
        for k in range(len(at)):
            heading = [s + t for s, t in zip(straight, value(k, "tangent"))]
            across = [h for i, h in enumerate(heading) if i != along]
            now = math.atan2(sum(across), sign * heading[along])  # all in one plane, one of x, y, z
            if before is not None:
                turned += math.remainder(now - before, 2.0 * math.pi)
            before = now
        most = max(most, abs(math.degrees(turned)))
    require(abs(most - degrees) < 2, "%s turns by %.1f degrees" % (name, most))


def check_model(path, name):
    document, binary = read_glb(path)
    axis, size, clips = EXPECTED[name]
    require(document["scenes"][document["scene"]]["nodes"] == [0] and len(document["nodes"]) == 1, "scene")
    node = document["nodes"][0]
    check_rig(node["extras"]["kelp"], axis, clips)
    parts, count, corners = 0, 0, []
    for primitive in document["meshes"][node["mesh"]]["primitives"]:
        attributes = primitive["attributes"]
        require(set(attributes) == {"POSITION", "NORMAL", "COLOR_0"} and primitive.get("mode", 4) == 4,
                "attributes %s" % sorted(attributes))
        require(0 <= primitive["material"] < len(document["materials"]), "material")
        position, positions = read_accessor(document, binary, attributes["POSITION"], {("VEC3", 5126)},
                                            ARRAY_BUFFER)
        require("min" in position and "max" in position, "POSITION needs min and max")
        _, normals = read_accessor(document, binary, attributes["NORMAL"], {("VEC3", 5126)}, ARRAY_BUFFER)
        colour, colours = read_accessor(document, binary, attributes["COLOR_0"], {("VEC4", 5123)},
                                        ARRAY_BUFFER)
        require(colour["normalized"] is True and all(c[3] == 65535 for c in colours),
                "COLOR_0 is not normalized or not opaque")
        require(len(set(colours)) > 100, "COLOR_0 is all but plain")
        _, indices = read_accessor(document, binary, primitive["indices"],
                                   {("SCALAR", 5123), ("SCALAR", 5125)}, ELEMENT_ARRAY_BUFFER)
        require(len(positions) == len(normals) == len(colours) and len(indices) % 3 == 0, "counts differ")
        flat = [i for i, in indices]
        triangles = list(zip(flat[0::3], flat[1::3], flat[2::3]))
        parts += check_surface(positions, triangles, 1e-9 * size * size)
        check_normals(positions, normals, triangles)
        count += len(triangles)
        corners += [position["min"], position["max"]]
    extent = [max(c) - min(c) for c in zip(*corners)]
    require(abs(extent["xyz".index(axis[1])] / size - 1.0) < 0.05, "its size is %r" % extent)
    if axis == "+y":
        require(0.0 <= min(c[1] for c in corners) < 0.01 * size, "it does not stand on the ground")
    print("%s: %d triangles in %d closed surfaces, %.3f x %.3f x %.3f m" % (name, count, parts, *extent))
    return positions, triangles


def check_the_check(positions, triangles):
    """A check that cannot fail shows nothing: damage the last surface in four ways and expect an answer to
    each."""
    a, b, c = triangles[0]
    damaged = {
        "a hole": (positions, triangles[1:]),
        "a turned triangle": (positions, [(a, c, b)] + triangles[1:]),
        "a surface inside out": (positions, [(p, r, q) for p, q, r in triangles]),
        "a collapsed triangle": ([positions[a] if i == b else p for i, p in enumerate(positions)], triangles),
    }
    for what, (some_positions, some_triangles) in damaged.items():
        try:
            check_surface(some_positions, some_triangles, 1e-12)
        except Fault:
            continue
        raise Fault("the check does not see " + what)


def main(script, models):
    with tempfile.TemporaryDirectory() as folder:
        again = os.path.join(folder, "again", "deeper")
        require(subprocess.run([sys.executable, script, again], stdout=subprocess.DEVNULL).returncode == 0,
                "the script failed")
        for name in (*EXPECTED, *SKINNED):
            file = name + ".glb"
            require(filecmp.cmp(os.path.join(models, file), os.path.join(again, file), shallow=False),
                    file + " differs from run to run")
        for name in EXPECTED:
            try:
                positions, triangles = check_model(os.path.join(again, name + ".glb"), name)
            except Fault as fault:
                raise Fault("%s.glb: %s" % (name, fault)) from None
        check_the_check(positions, triangles)
        # The command line: no folder is a usage error, a folder that cannot be made an I/O error; both in one
        # line or two, no traceback.
        for arguments, code in (([], 1), ([os.path.join(again, "fish.glb", "below_a_file")], 2)):
            run = subprocess.run([sys.executable, script, *arguments], stdout=subprocess.PIPE,
                                 stderr=subprocess.PIPE, text=True)
            require(run.returncode == code and not run.stdout and "Traceback" not in run.stderr,
                    "with %r: exit code %d, %s" % (arguments, run.returncode, run.stderr))
        require(not os.path.exists(os.path.join(os.path.dirname(script), "__pycache__")),
                "the script left __pycache__ in the source tree")


if __name__ == "__main__":
    try:
        main(*sys.argv[1:])
    except Fault as fault:
        sys.exit("check_models.py: %s" % fault)
