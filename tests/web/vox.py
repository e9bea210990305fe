# SPDX-License-Identifier: MIT
"""Writes MagicaVoxel files: a small tree, and one that lies about its size."""

import struct


def chunk(name, content, children=b""):
    return name + struct.pack("<II", len(content), len(children)) + content + children


def vox(size, voxels, palette=None):
    body = chunk(b"SIZE", struct.pack("<III", *size))
    body += chunk(b"XYZI", struct.pack("<I", len(voxels)) + b"".join(bytes(v) for v in voxels))
    if palette:
        body += chunk(b"RGBA", b"".join(bytes((*c, 255)) for c in palette).ljust(1024, b"\xff"))
    return b"VOX " + struct.pack("<I", 150) + chunk(b"MAIN", b"", body)


def tree():
    """32 x 32 x 64: a brown trunk and a green crown with red fruit."""
    voxels = []
    for z in range(64):
        for y in range(32):
            for x in range(32):
                to_trunk = (x - 15.5) ** 2 + (y - 15.5) ** 2
                to_crown = to_trunk + (z - 46) ** 2
                if z < 40 and to_trunk < (4 - z / 20) ** 2:
                    voxels.append((x, y, z, 1))
                elif to_crown < 15 ** 2:
                    voxels.append((x, y, z, 3 if (7 * x + 5 * y + 11 * z) % 41 == 0 else 2))
    return vox((32, 32, 64), voxels, [(110, 72, 40), (60, 140, 50), (200, 40, 40)])


def liar():
    """Claims four thousand million voxels."""
    return vox((1 << 31, 1 << 31, 1 << 31), [(0, 0, 0, 1)])[:-4].replace(
        struct.pack("<I", 1) + bytes((0, 0, 0)), struct.pack("<I", 0xffffffff) + bytes((0, 0, 0)))


def text(*words):
    """A dictionary, of keys and values in turn."""
    pairs = b"".join(struct.pack("<I", len(word)) + word.encode() for word in words)
    return struct.pack("<I", len(words) // 2) + pairs


def apart(distance):
    """Two cubes of 4 voxels, so far apart along each axis; some 600 bytes."""
    cube = [(x, y, z, 1) for x in range(4) for y in range(4) for z in range(4)]
    body = chunk(b"SIZE", struct.pack("<III", 4, 4, 4))
    body += chunk(b"XYZI", struct.pack("<I", len(cube)) + b"".join(bytes(v) for v in cube))

    def shift(node, child, *frame):
        return chunk(b"nTRN", struct.pack("<I", node) + text() + struct.pack("<IiiI", child, -1, 0, 1)
                     + text(*frame))

    def shape(node):
        return chunk(b"nSHP", struct.pack("<I", node) + text() + struct.pack("<II", 1, 0) + text())
    body += shift(0, 1) + chunk(b"nGRP", struct.pack("<I", 1) + text() + struct.pack("<III", 2, 2, 4))
    body += shift(2, 3) + shape(3) + shift(4, 5, "_t", f"{distance} {distance} {distance}") + shape(5)
    return b"VOX " + struct.pack("<I", 150) + chunk(b"MAIN", b"", body)
