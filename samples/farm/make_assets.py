#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Writes small models of five kinds, and the table that bakes them: something for a farm to work on. Needs
nothing but Python 3."""
import argparse
import json
import math
import os
import struct
import sys
import zlib

KINDS = ["obj", "gltf", "ply", "stl", "vox"]
# what is textured shares skin.png
FOLDERS = {"obj": "textured", "gltf": "textured", "ply": "plain", "stl": "plain", "vox": "painted"}


def lump(seed, n=14):
    """Corners, texture coordinates and triangles of a closed body, no two alike."""
    a, b, stretch = 2 + seed % 5, 1 + seed % 4, 0.7 + 0.1 * (seed % 11)
    corners, coordinates = [], []
    for j in range(n + 1):
        for i in range(n):
            u, v = 2 * math.pi * i / n, math.pi * j / n
            r = 1 + 0.2 * math.sin(a * u + seed) * math.sin(v) ** 2 * math.cos(b * v)
            corners.append((r * math.sin(v) * math.cos(u), stretch * math.cos(v),
                            r * math.sin(v) * math.sin(u)))
            coordinates.append((i / n, j / n))
    triangles = []
    for j in range(n):
        for i in range(n):
            p, q = j * n + i, j * n + (i + 1) % n
            triangles += [(p, q, q + n)] * (j > 0) + [(p, q + n, p + n)] * (j < n - 1)
    # The corners of a pole are one.
    pole = {**{i: 0 for i in range(n)}, **{n * n + i: n * n for i in range(n)}}
    return corners, coordinates, [tuple(pole.get(c, c) for c in t) for t in triangles]


def obj(seed):
    corners, coordinates, triangles = lump(seed)
    lines = ["mtllib skin.mtl",
             "usemtl skin"] + ["v %.6f %.6f %.6f" % c
                               for c in corners] + ["vt %.4f %.4f" % c for c in coordinates]
    return ("\n".join(lines + ["f " + " ".join("%d/%d" % (c + 1, c + 1) for c in t) for t in triangles])
            + "\n").encode()


def gltf(seed):
    corners, coordinates, triangles = lump(seed)
    blocks = [b"".join(struct.pack("<3f", *c) for c in corners),
              b"".join(struct.pack("<2f", *c) for c in coordinates),
              b"".join(struct.pack("<3H", *t) for t in triangles)]
    stored = [struct.unpack("<3f", struct.pack("<3f", *c)) for c in corners]
    binary = b"".join(blocks)
    views = [{"buffer": 0, "byteOffset": sum(map(len, blocks[:i])), "byteLength": len(block)}
             for i, block in enumerate(blocks)]
    scene = {
        "asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0]}], "nodes": [{"mesh": 0}],
        "meshes": [
            {"primitives": [{"attributes": {"POSITION": 0, "TEXCOORD_0": 1}, "indices": 2, "material": 0}]}],
        "materials": [{"pbrMetallicRoughness": {"baseColorTexture": {"index": 0}, "metallicFactor": 0}}],
        "textures": [{"source": 0}], "images": [{"uri": "skin.png"}],
        "accessors": [{"bufferView": 0, "componentType": 5126, "count": len(corners), "type": "VEC3",
                       "min": [min(c[i] for c in stored) for i in range(3)],
                       "max": [max(c[i] for c in stored) for i in range(3)]},
                      {"bufferView": 1, "componentType": 5126, "count": len(corners), "type": "VEC2"},
                      {"bufferView": 2, "componentType": 5123, "count": 3 * len(triangles),
                       "type": "SCALAR"}],
        "bufferViews": views, "buffers": [{"uri": "lump%03d.bin" % seed, "byteLength": len(binary)}]}
    return json.dumps(scene).encode(), binary


def ply(seed):
    corners, _, triangles = lump(seed)
    head = ("ply\nformat binary_little_endian 1.0\nelement vertex %d\n"
            "property float x\nproperty float y\nproperty float z\n"
            "property uchar red\nproperty uchar green\nproperty uchar blue\n"
            "element face %d\nproperty list uchar int vertex_indices\nend_header\n"
            % (len(corners), len(triangles)))
    points = b"".join(struct.pack("<3f3B", *c, (i * 7 + seed) % 256, i % 256, seed % 256)
                      for i, c in enumerate(corners))
    return head.encode() + points + b"".join(struct.pack("<B3i", 3, *t) for t in triangles)


def stl(seed):
    corners, _, triangles = lump(seed)
    facets = (struct.pack("<3f", 0, 0, 0) + b"".join(struct.pack("<3f", *corners[c]) for c in t) + bytes(2)
              for t in triangles)
    return bytes(80) + struct.pack("<I", len(triangles)) + b"".join(facets)


def vox(seed):
    """A MagicaVoxel model: a stepped pyramid of up to 12 x 12 x 12 voxels."""
    size = 6 + seed % 7
    voxels = [(x, y, z, 1 + (z + seed) % 255) for z in range(size) for y in range(size) for x in range(size)
              if z // 2 <= min(x, y, size - 1 - x, size - 1 - y)]
    chunks = struct.pack("<4s5I", b"SIZE", 12, 0, size, size, size)
    chunks += struct.pack("<4s3I", b"XYZI", 4 + 4 * len(voxels), 0, len(voxels))
    chunks += b"".join(struct.pack("<4B", *v) for v in voxels)
    return struct.pack("<4sI4s2I", b"VOX ", 150, b"MAIN", 0, len(chunks)) + chunks


def png(size=16):
    rows = b"".join(b"\0"
                    + b"".join(struct.pack("<3B", 16 * x, 16 * y, 255 if (x ^ y) & 4 else 64)
                               for x in range(size)) for y in range(size))
    chunks = [(b"IHDR", struct.pack(">2I5B", size, size, 8, 2, 0, 0, 0)), (b"IDAT", zlib.compress(rows)),
              (b"IEND", b"")]
    return b"\x89PNG\r\n\x1a\n" + b"".join(struct.pack(">I", len(data)) + kind + data
                                           + struct.pack(">I", zlib.crc32(kind + data))
                                           for kind, data in chunks)


def write(folder, name, content):
    path = os.path.join(folder, name)
    os.makedirs(os.path.dirname(path), exist_ok=True)
    with open(path, "wb") as file:
        file.write(content)


def options(seed, kind):
    if kind == "vox":
        return ["", "--pad 1", "--up +z", "--rig sway"][seed // len(KINDS) % 4]
    more = ["--resolution 28", "--resolution %d" % (24 + seed % 9), "--resolution 28 --rig sway",
            "--resolution 28 --fill surface", "--resolution 28 --pad 1 --keep-materials",
            "--resolution 28 --up +z --unit cm", "--voxel-size 0.08"]
    return more[seed // len(KINDS) % len(more)]


def make(folder, count):
    lines = ["input\tpack\toptions"]
    for seed in range(count):
        kind = KINDS[seed % len(KINDS)]
        stem = "%s/lump%03d" % (FOLDERS[kind], seed)
        content = {"obj": obj, "gltf": gltf, "ply": ply, "stl": stl, "vox": vox}[kind](seed)
        if kind == "gltf":
            content, binary = content
            write(folder, stem + ".bin", binary)
        write(folder, stem + "." + kind, content)
        lines.append("%s.%s\tpacks/%s.kelp\t%s" % (stem, kind, stem, options(seed, kind)))
    write(folder, "textured/skin.png", png())
    write(folder, "textured/skin.mtl", b"newmtl skin\nmap_Kd skin.png\n")
    write(folder, "assets.tsv", ("\n".join(lines) + "\n").encode())


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("folder", metavar="FOLDER",
                        help="is made if need be; the table is FOLDER/assets.tsv")
    parser.add_argument("--count", type=int, default=200, metavar="N",
                        help="of models, 5 to 999 (default 200)")
    arguments = parser.parse_args()
    if not 5 <= arguments.count <= 999:
        print("make_assets.py: --count %d: give 5 to 999" % arguments.count, file=sys.stderr)
        return 1
    try:
        make(arguments.folder, arguments.count)
    except OSError as error:
        print("make_assets.py: %s: %s; give a folder that can be written" % (error.filename, error.strerror),
              file=sys.stderr)
        return 2
    return 0


if __name__ == "__main__":
    sys.exit(main())
