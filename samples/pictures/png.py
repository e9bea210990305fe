# SPDX-License-Identifier: MIT
"""PNG in and out, with nothing but the standard library: 8 bits, RGB or RGBA, not interlaced."""

import struct
import zlib

SIGNATURE = b"\x89PNG\r\n\x1a\n"


class Picture:
    """RGB rows from top to bottom."""

    def __init__(self, width, height, color=(255, 255, 255)):
        self.width, self.height = width, height
        self.rows = [bytearray(bytes(color) * width) for _ in range(height)]

    def paste(self, other, left, top):
        for y, row in enumerate(other.rows):
            self.rows[top + y][3 * left:3 * (left + other.width)] = row

    def blend(self, x, y, color, share):
        at = 3 * x
        row = self.rows[y]
        for i in range(3):
            row[at + i] = round(row[at + i] + (color[i] - row[at + i]) * share)


def paeth(a, b, c):
    p = a + b - c
    pa, pb, pc = abs(p - a), abs(p - b), abs(p - c)
    return a if pa <= pb and pa <= pc else b if pb <= pc else c


def unfilter(kind, row, above, step):
    if kind == 1:
        for i in range(step, len(row)):
            row[i] = (row[i] + row[i - step]) & 255
    elif kind == 2:
        row[:] = bytes((x + b) & 255 for x, b in zip(row, above))
    elif kind == 3:
        for i in range(len(row)):
            row[i] = (row[i] + ((row[i - step] if i >= step else 0) + above[i]) // 2) & 255
    elif kind == 4:
        for i in range(len(row)):
            a, c = (row[i - step], above[i - step]) if i >= step else (0, 0)
            row[i] = (row[i] + paeth(a, above[i], c)) & 255


def read(path):
    with open(path, "rb") as file:
        data = file.read()
    assert data[:8] == SIGNATURE, path + ": is no PNG"
    at, packed, header = 8, b"", None
    while at < len(data):
        size, kind = struct.unpack(">I4s", data[at:at + 8])
        body = data[at + 8:at + 8 + size]
        if kind == b"IHDR":
            header = struct.unpack(">IIBBBBB", body)
        elif kind == b"IDAT":
            packed += body
        at += 12 + size
    width, height, bits, color, _, _, interlaced = header
    assert bits == 8 and color in (2, 6) and not interlaced, path + ": is not 8-bit RGB or RGBA"
    step = 3 if color == 2 else 4
    raw = zlib.decompress(packed)
    picture = Picture(width, height)
    above = bytearray(step * width)
    for y in range(height):
        start = y * (step * width + 1)
        row = bytearray(raw[start + 1:start + 1 + step * width])
        unfilter(raw[start], row, above, step)
        for i in range(3):
            picture.rows[y][i::3] = row[i::step]
        above = row
    return picture


def write(path, picture):
    """Each row with the filter whose result is nearest to zero, as the specification advises."""
    packed = bytearray()
    above = bytes(3 * picture.width)
    for row in picture.rows:
        left = bytes(3) + row[:-3]
        corner = bytes(3) + above[:-3]
        kinds = (row,
                 bytes((x - a) & 255 for x, a in zip(row, left)),
                 bytes((x - b) & 255 for x, b in zip(row, above)),
                 bytes((x - (a + b) // 2) & 255 for x, a, b in zip(row, left, above)),
                 bytes((x - paeth(a, b, c)) & 255 for x, a, b, c in zip(row, left, above, corner)))
        best = min(range(5), key=lambda kind: sum(min(x, 256 - x) for x in kinds[kind]))
        packed += bytes((best,)) + kinds[best]
        above = bytes(row)

    def chunk(kind, body):
        return struct.pack(">I", len(body)) + kind + body + struct.pack(">I", zlib.crc32(kind + body))

    with open(path, "wb") as file:
        file.write(SIGNATURE
                   + chunk(b"IHDR", struct.pack(">IIBBBBB", picture.width, picture.height, 8, 2, 0, 0, 0)) +
                   chunk(b"sRGB", b"\0") + chunk(b"IDAT", zlib.compress(bytes(packed), 9))
                   + chunk(b"IEND", b""))
