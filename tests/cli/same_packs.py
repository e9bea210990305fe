#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""The same input bakes to the same bytes: on 1, 2 and 7 threads, with and without AVX2 and AVX-512, by every
kelp-bake that is named.

  same_packs.py made|real [--models FOLDER] [--assets FOLDER] [--full] KELP_BAKE [KELP_BAKE...]

made: files written here (and the sample models, where --models names a folder that holds them).
real: the shared assets; exit code 77 where they are absent.
--full: finer, and with the heavy files: minutes for each program instead of seconds.

glibc picks its sin, cos, atan2, pow and log by processor. Those that fuse a multiplication with an addition
round differently in the last bit. GLIBC_TUNABLES makes it pick those of an old processor. For kelp's own
vector code see tests/bake/same_packs_test.cpp.
"""
import argparse
import collections
import hashlib
import json
import math
import os
import struct
import subprocess
import sys
import tempfile

OLD_PROCESSOR = {
    "GLIBC_TUNABLES": "glibc.cpu.hwcaps=-AVX,-AVX2,-FMA,-FMA4,-AVX512F,-AVX512VL,-AVX512BW,-AVX512DQ,-BMI2"}
VARIANTS = [(["--threads", "1"], {}),
            (["--threads", "2"], {}),
            (["--threads", "7"], {}),
            (["--threads", "2"], OLD_PROCESSOR)]

# File, options, resolution of a quick run (0: not in it), of a full one; "own": of the file's own.
REAL = [
    ("gltf/draco_testdata/Duck.glb", [], 48, 160),  # a picture
    # parts that move
    ("gltf/draco_testdata/CesiumMilkTruck/CesiumMilkTruck.gltf", ["--parts", "nodes"], 48, 160),
    ("gltf/draco_testdata/Fox/Fox.gltf", ["--at", "Walk:0.3"], 48, 128),  # a skin in motion
    ("gltf/plants/fern_02.glb", [], 48, 160),  # sheets, cut out by a picture's alpha
    ("gltf/assimp/2CylinderEngine.glb", [], 0, 128),  # a hundred thousand triangles, bodies within bodies
    ("gltf/meshopt/pirate.glb", ["--rig", "sway"], 48, 128),  # compressed, a rig
    ("gltf/pmndrs/bunny.glb", [], 32, 96),  # Draco
    ("mesh/common3d/stanford-bunny.obj", ["--bend", "cage"], 48, 160),  # a body with holes, capped
    ("mesh/common3d/teapot.obj", ["--fill", "surface"], 48, 128),
    ("mesh/assimp/OBJ/spider.obj", [], 32, 128),  # materials of a library, pictures
    ("mesh/stanford/dragon_vrip_res3.ply", [], 48, 160),
    ("mesh/draco_testdata/test_pos_color.ply", [], 32, 96),  # colors at corners
    ("vdb/gaffer_sphere.vdb", [], 32, 96),  # a level set
    ("vox/vengi/8ontop.vox", [], "own", "own"),  # voxels that are kept, in 72 turned objects
    ("vox/vox-reader/deer.vox", ["--axis", "-x", "--rig", "swim"], "own", "own"),
]


def lump(n, point):
    """A grid of n x n quads over a ball's angles, open at both poles; point(u, v) places a corner."""
    corners = [
        point(2 * math.pi * i / n, math.pi * (0.04 + 0.92 * j / n)) for j in range(n + 1) for i in range(n)]
    faces = []
    for j in range(n):
        for i in range(n):
            a, b = j * n + i, j * n + (i + 1) % n
            faces += [(a, b, b + n), (a, b + n, a + n)]
    return corners, faces


def wavy(u, v):
    r = 1 + 0.15 * math.sin(5 * u) * math.sin(4 * v)
    return r * math.sin(v) * math.cos(u), 1.3 * r * math.cos(v), r * math.sin(v) * math.sin(u)


def ring(u, v):
    r = 2 + 0.6 * math.cos(2 * v)
    return r * math.cos(u), 0.6 * math.sin(2 * v), r * math.sin(u)


def write_made(folder):
    """Answers (path, options, resolution of a quick run, of a full one)."""
    def path(name):
        return os.path.join(folder, name)

    corners, faces = lump(24, wavy)
    with open(path("holes.mtl"), "w") as file:
        for i in range(5):
            file.write("newmtl m%d\nKd %.3f %.3f 0.3\nPr 0.%d\n" % (i, i / 5, 1 - i / 7, i))
    with open(path("holes.obj"), "w") as file:
        file.write("mtllib holes.mtl\n" + "".join("v %.6f %.6f %.6f\n" % c for c in corners))
        for i, face in enumerate(faces):
            file.write("usemtl m%d\nf %d %d %d\n" % (i // 7 % 5, *(c + 1 for c in face)))

    # More colors than a palette has, and leaves that touch no body.
    with open(path("colors.ply"), "wb") as file:
        corners, faces = lump(40, wavy)
        file.write(b"ply\nformat binary_little_endian 1.0\nelement vertex %d\nproperty float x\n"
                   b"property float y\nproperty float z\nproperty uchar red\nproperty uchar green\n"
                   b"property uchar blue\nelement face %d\nproperty list uchar int vertex_indices\n"
                   b"end_header\n" % (len(corners), len(faces) // 2))
        for i, corner in enumerate(corners):
            file.write(struct.pack("<3f3B", *corner, i * 37 % 256, i * 101 % 256, i * 11 % 256))
        for face in faces[::2]:
            file.write(struct.pack("<B3i", 3, *face))

    with open(path("ring.stl"), "wb") as file:
        corners, faces = lump(30, ring)
        file.write(bytes(80) + struct.pack("<I", len(faces)))
        for face in faces:
            file.write(struct.pack("<3f", 0, 0, 0) + b"".join(struct.pack("<3f", *corners[c]) for c in face)
                       + bytes(2))

    # Two nodes, one turned about a slanted axis and moved by a clip; the other under it.
    corners, faces = lump(12, wavy)
    points = b"".join(struct.pack("<3f", *c) for c in corners)
    indices = b"".join(struct.pack("<3H", *f) for f in faces)
    times = struct.pack("<3f", 0, 0.5, 1)
    turns = b"".join(
        struct.pack("<4f", 0.36 * math.sin(a), 0.48 * math.sin(a), 0.8 * math.sin(a), math.cos(a))
        for a in (0, 0.3, 0.1))
    views, offset = [], 0
    for block in (points, indices, times, turns):
        views.append({"buffer": 0, "byteOffset": offset, "byteLength": len(block)})
        offset += len(block)
    with open(path("nodes.bin"), "wb") as file:
        file.write(points + indices + times + turns)
    limits = {"min": [min(c[i] for c in corners) for i in range(3)],
              "max": [max(c[i] for c in corners) for i in range(3)]}
    gltf = {
        "asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0]}],
        "nodes": [
            {"name": "body", "mesh": 0, "rotation": [0.1, 0.2, 0.3, math.sqrt(1 - 0.14)], "children": [1]},
            {"name": "arm", "mesh": 0, "translation": [2.5, 0.3, 0], "scale": [0.4, 0.5, 0.3]}],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "indices": 1, "material": 0}]}],
        "materials": [{"pbrMetallicRoughness": {"baseColorFactor": [0.2, 0.5, 0.1, 1], "metallicFactor": 0.3,
                                                "roughnessFactor": 0.7}}],
        "animations": [{"name": "turn", "samplers": [{"input": 2, "output": 3, "interpolation": "LINEAR"}],
                        "channels": [{"sampler": 0, "target": {"node": 1, "path": "rotation"}}]}],
        "accessors": [
            {"bufferView": 0, "componentType": 5126, "count": len(corners), "type": "VEC3", **limits},
            {"bufferView": 1, "componentType": 5123, "count": 3 * len(faces), "type": "SCALAR"},
            {"bufferView": 2, "componentType": 5126, "count": 3, "type": "SCALAR", "min": [0], "max": [1]},
            {"bufferView": 3, "componentType": 5126, "count": 3, "type": "VEC4"}],
        "bufferViews": views,
        "buffers": [{"uri": "nodes.bin", "byteLength": offset}]}
    with open(path("nodes.gltf"), "w") as file:
        json.dump(gltf, file)
    return [(path("holes.obj"), ["--rig", "sway", "--bend", "cage", "--cell", "4"], 64, 160),
            (path("colors.ply"), [], 64, 160),
            (path("ring.stl"), ["--axis", "-x", "--rig", "swim"], 64, 160),
            (path("nodes.gltf"), ["--parts", "nodes"], 48, 96)]


def bake(program, path, options, out, environment):
    result = subprocess.run([program, path, "-o", out, "--progress", "none", *options], capture_output=True,
                            timeout=900, env={**os.environ, **environment})
    if result.returncode != 0:
        return "exit code %d: %s" % (result.returncode, result.stderr.decode(errors="replace").strip())
    with open(out, "rb") as file:
        return hashlib.sha256(file.read()).hexdigest()


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("kind", choices=["made", "real"])
    parser.add_argument(
        "--models", help="folder with the sample models, as samples/models/make_models.py writes them")
    parser.add_argument("--assets", default=os.environ.get("KELP_ASSETS") or os.path.join(
                            os.path.dirname(os.path.abspath(__file__)), "../../../shared/assets"))
    parser.add_argument("--full", action="store_true")
    parser.add_argument("program", nargs="+")
    arguments = parser.parse_args()

    with tempfile.TemporaryDirectory() as folder:
        if arguments.kind == "made":
            cases = write_made(folder)
            if arguments.models:
                cases += [(os.path.join(arguments.models, name), [], 64, 96)
                          for name in sorted(os.listdir(arguments.models)) if name.endswith(".glb")]
        else:
            if not os.path.isdir(arguments.assets):
                print("same_packs.py: skipped: no assets in %s; set KELP_ASSETS" % arguments.assets)
                return 77
            cases = [(os.path.join(arguments.assets, name), *rest) for name, *rest in REAL]
        wrong = 0
        cases = [(path, options, full if arguments.full else quick) for path, options, quick, full in cases
                 if quick or arguments.full]
        for path, options, resolution in cases:
            packs = collections.defaultdict(list)
            for program in arguments.program:
                for extra, environment in VARIANTS:
                    grain = [] if resolution == "own" else ["--resolution", str(resolution)]
                    found = bake(program, path, [*options, *grain, *extra], os.path.join(folder, "out.kelp"),
                                 environment)
                    packs[found].append(
                        " ".join([program, *extra, *(["(old processor)"] if environment else [])]))
            same = len(packs) == 1 and not next(iter(packs)).startswith("exit code")
            wrong += not same
            print("%s %s %s at %s"
                  % ("same  " if same else "DIFFER", os.path.basename(path), " ".join(options), resolution),
                  flush=True)
            if not same:
                for found, ways in packs.items():
                    print("    %s\n        %s" % (found, "\n        ".join(ways)))
        print("%d of %d inputs gave the same pack in all of %d ways"
              % (len(cases) - wrong, len(cases), len(arguments.program) * len(VARIANTS)))
        return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())
