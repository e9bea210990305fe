# SPDX-License-Identifier: MIT
"""Pictures without a library: PNG files, and how the page's picture differs from kelp-render's."""

import struct
import zlib


def read_png(path):
    """(width, height, rows of RGBA bytes), the top row first. 8 bits, RGB or RGBA, not interlaced."""
    with open(path, "rb") as file:
        data = file.read()
    at, packed = 8, b""
    while at < len(data):
        length, kind = struct.unpack(">I4s", data[at:at + 8])
        body = data[at + 8:at + 8 + length]
        if kind == b"IHDR":
            width, height, bits, color, _, _, interlaced = struct.unpack(">IIBBBBB", body)
            if bits != 8 or color not in (2, 6) or interlaced:
                raise ValueError(f"{path}: not a PNG of 8 bits, RGB or RGBA")
        elif kind == b"IDAT":
            packed += body
        at += 12 + length
    size = 3 if color == 2 else 4
    raw, rows, above = zlib.decompress(packed), [], bytearray(width * size)
    for y in range(height):
        start = y * (width * size + 1)
        kind, row = raw[start], bytearray(raw[start + 1:start + 1 + width * size])
        for i in range(len(row)):
            left = row[i - size] if i >= size else 0
            corner = above[i - size] if i >= size else 0
            row[i] = (row[i] + (0, left, above[i], (left + above[i]) // 2,
                                paeth(left, above[i], corner))[kind]) & 255
        rows.append(row if size == 4 else b"".join(row[i:i + 3] + b"\xff" for i in range(0, len(row), 3)))
        above = row
    return width, height, rows


def paeth(left, up, corner):
    guess = left + up - corner
    return min((left, up, corner), key=lambda value: abs(guess - value))


def to_linear(byte):
    value = byte / 255
    return value / 12.92 if value <= 0.04045 else ((value + 0.055) / 1.055) ** 2.4


LINEAR = [to_linear(byte) for byte in range(256)]


def displayed(red, green, blue):
    """The value of shaders/output.glsl for a color that kelp-render encoded without mapping its tones."""
    light = [LINEAR[red], LINEAR[green], LINEAR[blue]]
    peak = max(light)
    if peak >= 0.8:
        mapped = 1 - 0.04 / (peak - 0.8 + 0.2)
        white = 1 - 1 / (0.15 * (peak - mapped) + 1)
        light = [value * mapped / peak * (1 - white) + mapped * white for value in light]
    return [255 * (12.92 * v if v <= 0.0031308 else 1.055 * v ** (1 / 2.4) - 0.055) for v in light]


def compare(page, width, height, reference):
    """page: RGBA from the bottom row up. Counts pixels that both cover, that one covers, whose colors
    differ, and of these those whose color no neighbor has in the reference. The others' rays graze a voxel
    and met the one beside it, as they may where OpenGLs compute a pixel's ray in other precision."""
    rows = reference[2]
    hits = one_sided = other = strange = 0

    def alike(x, y, color):
        # A channel at 255 was cut in the reference: what it was is not known.
        pixel = rows[y][x:x + 4]
        return pixel[3] > 127 and (max(pixel[:3]) == 255 or max(
            abs(a - b) for a, b in zip(displayed(*pixel[:3]), color)) <= 4)

    for y in range(height):
        row, line = rows[y], page[4 * width * (height - 1 - y):4 * width * (height - y)]
        for x in range(0, 4 * width, 4):
            if (row[x + 3] > 127) != (line[x + 3] > 127):
                one_sided += 1
            elif row[x + 3] > 127:
                hits += 1
                if not alike(x, y, line[x:x + 3]):
                    other += 1
                    strange += not any(alike(max(x + i, 0), min(max(y + j, 0), height - 1), line[x:x + 3])
                                       for i in (-4, 0, 4) for j in (-1, 0, 1))
    return hits, one_sided, other, strange
