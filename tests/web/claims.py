# SPDX-License-Identifier: MIT
"""Packs that claim more than a page may hold, with every checksum right, after formats/SPEC.md."""

import os
import struct
import sys

HERE = os.path.dirname(os.path.abspath(__file__))
sys.path.insert(0, HERE + "/../formats")
from read_pack import Zstd
from xxh3 import xxh3_64

IDENTIFIER = bytes.fromhex("AB4B454C50414BBB0D0A1A0A")
COMPRESSED = 2  # the flag
GIB = 1 << 30


def frame(first, zeros, last):
    """A zstd frame of some bytes, so many zeros, and more bytes (RFC 8878): the zeros are blocks of one byte
    that is repeated, so 128 KiB of them take four bytes."""
    def block(kind, count, content):
        return struct.pack("<I", count << 3 | kind << 1)[:3] + content

    blocks = [block(0, len(first), first)]
    blocks += [block(1, min(1 << 17, zeros - at), b"\0") for at in range(0, zeros, 1 << 17)]
    blocks.append(block(0, len(last), last))
    blocks[-1] = bytes((blocks[-1][0] | 1,)) + blocks[-1][1:]
    size = len(first) + zeros + len(last)
    return b"\x28\xb5\x2f\xfd\xe0" + struct.pack("<Q", size) + b"".join(blocks)


class Pack:
    """The chunks of a pack as they are stored, to be changed and put together again."""

    def __init__(self, data):
        self.chunks = []
        for i in range(struct.unpack_from("<I", data, 24)[0]):
            name, flags, level, part, at, stored, raw, _ = struct.unpack_from("<4sIIIQQQQ", data, 64 + 48 * i)
            self.chunks.append({"name": name.decode(), "flags": flags, "level": level, "part": part,
                                "stored": data[at:at + stored], "raw": raw})

    def first(self, name, level=None):
        return next(chunk for chunk in self.chunks
                    if chunk["name"] == name and level in (None, chunk["level"]))

    def swell(self, name, size, level=None):
        """The first chunk of that name and level becomes a frame that really holds so many zeros."""
        chunk = self.first(name, level)
        chunk.update(stored=frame(b"", size, b""), raw=size, flags=chunk["flags"] | COMPRESSED)

    def build(self, size=None):
        """size: stated in the header in place of the file's."""
        end = 64 + 48 * len(self.chunks)
        index, body = [], b""
        for chunk in self.chunks:
            body += bytes(-(end + len(body)) % 64)
            index.append(struct.pack("<4sIIIQQQQ", chunk["name"].encode(), chunk["flags"], chunk["level"],
                                     chunk["part"], end + len(body), len(chunk["stored"]), chunk["raw"],
                                     xxh3_64(chunk["stored"])))
            body += chunk["stored"]
        size = size or end + len(body)
        header = IDENTIFIER + struct.pack("<HHQI", 1, 0, size, len(self.chunks)) + bytes(28)
        table = b"".join(index)
        return header + struct.pack("<Q", xxh3_64(header + bytes(8) + table)) + table + body


def solid():
    with open(HERE + "/../formats/golden/solid.kelp", "rb") as file:
        return Pack(file.read())


def with_size(size, grids):
    """Its first part has that many voxels each way, and grids that are frames of so many zeros."""
    pack = solid()
    table = pack.first("PART")
    parts = bytearray(Zstd().decode(table["stored"], table["raw"]))
    struct.pack_into("<III", parts, 8 + 12, *size)
    table.update(stored=bytes(parts), flags=table["flags"] & ~COMPRESSED)
    for level, bytes_of_grid in grids.items():
        pack.swell("GRID", bytes_of_grid, level)
    return pack


def crowd(count):
    """So many parts, each with a sound grid that takes 126 MB in memory, together more than a page has."""
    size, cells = (8192, 8192, 240), 1024 * 1024 * 30
    straight = struct.pack("<12f", 1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0)
    knots = struct.pack("<14f", 0, 0, 0, 0, 0, 1, 0, 1, 0, 1, 0, 0, 1, 0)
    pack = solid()
    table, bricks = pack.chunks[-2]["stored"][-32:], pack.chunks[-1]["stored"]  # one page of one brick
    part = struct.pack("<IiBBHIII", 0, -1, 0, 1, 0, *size) + 2 * straight
    rig = struct.pack("<IQfIf", 2, 0, -1, 0, 0)
    chunks = [("PART", 1, 0, struct.pack("<II", count, 0) + count * part),
              ("RIGS", 1, 0, struct.pack("<II", count, 2 * count) + count * rig + count * knots)]
    grid = frame(b"\x80", cells - 1, table)  # one stored brick
    levels = [chunk for i in range(count)
              for chunk in (("GRID", 3, i, grid, cells + 32), ("BRCK", 1, i, bricks))]
    made = [{"name": name, "flags": flags, "level": 0, "part": part, "stored": stored,
             "raw": raw[0] if raw else len(stored)} for name, flags, part, stored, *raw in chunks + levels]
    pack.chunks = [made[0], pack.first("MATL"), *made[1:]]
    return pack


def claims():
    """The claim, the name of a file, its bytes, words that refuse it, and the most that the module's
    memory, which never shrinks, may be after it."""
    page = 32  # bytes of a grid's table of one page
    grid, info = solid(), solid()
    grid.swell("GRID", 4 * GIB)
    info.swell("INFO", 4 * GIB)
    # Cells take a byte each in the file and four in memory; a brick has 8 voxels a side.
    huge = with_size((8192, 8192, 8192), {0: 1024 ** 3 + page})
    below = with_size((8192, 8192, 7680), {1: 512 * 512 * 480 + page})
    limit, little, most = "limit exceeded", 64 << 20, 768 << 20
    yield "a header that says 4 GB", "claim_header.kelp", solid().build(4 * GIB), "truncated", little
    yield "a grid that unpacks to 4 GB", "claim_grid.kelp", grid.build(), limit, little
    yield "a text that unpacks to 4 GB", "claim_info.kelp", info.build(), limit, little
    yield "a side of 32768 voxels", "claim_side.kelp", with_size((32768,) * 3, {}).build(), limit, little
    yield "a grid of 4 GB in memory", "claim_cells.kelp", huge.build(), limit, little
    yield "a grid of 480 MB in memory, 120 MB in a chunk", "claim_below.kelp", below.build(), limit, little
    yield "ten grids of 126 MB", "claim_crowd.kelp", crowd(10).build(), limit, most
