# SPDX-License-Identifier: MIT
"""Letters for labels: strokes of a round pen, so that no font has to be installed."""

import math

# Width, then strokes of points "xy"; the base line is y = 2, small letters reach 6, tall ones 8. "~": bent
# into a curve; a curve whose ends meet is closed.
GLYPHS = {
    "a": (4, "~02 42 46 06 02|46 42"), "b": (4, "08 02|~02 42 46 06 02"), "c": (4, "~45 46 06 02 42 43"),
    "d": (4, "48 42|~02 42 46 06 02"),
    "e": (4, "04 44|~44 46 06 02 42 43"), "f": (3, "~38 18 15 12|06 36"),
    "g": (4, "~02 42 46 06 02|~46 43 40 00 01"), "h": (4, "08 02|~04 06 46 44 42"),
    "i": (0, "06 02|08 08"), "j": (2, "~26 22 20 00|28 28"), "k": (4, "08 02|46 04|25 42"), "l": (0, "08 02"),
    "m": (6, "06 02|~04 06 36 34 32|~34 36 66 64 62"),
    "n": (4, "06 02|~04 06 46 44 42"), "o": (4, "~02 42 46 06 02"), "p": (4, "06 00|~02 42 46 06 02"),
    "q": (4, "46 40|~02 42 46 06 02"),
    "r": (3, "06 02|~04 06 36"), "s": (4, "~45 46 06 04 44 42 02 03"), "t": (3, "~18 14 12 32|06 36"),
    "u": (4, "~06 04 02 42 44|46 42"),
    "v": (4, "06 22 46"), "w": (6, "06 12 35 52 66"), "x": (4, "06 42|46 02"), "y": (4, "06 23|46 10"),
    "z": (4, "06 46 02 42"),
    "0": (4, "~02 42 48 08 02"), "1": (3, "06 28 22"), "2": (4, "~07 08 48 45 24 02|02 42"),
    "3": (4, "~07 08 48 45 15|~15 45 42 02 03"),
    "4": (4, "32 38 04 44"), "5": (4, "48 08 05|~05 45 42 02 03"),
    "6": (4, "~02 42 45 05 02|~47 48 08 05 03"), "7": (4, "08 48 12"),
    "8": (4, "~05 45 48 08 05|~02 42 45 05 02"), "9": (4, "~05 45 48 08 05|~47 45 42 02 03"),
    "(": (2, "~29 07 03 21"), ")": (2, "~09 27 23 01"), ",": (1, "12 01"), ".": (0, "02 02"),
    "-": (3, "04 34"), " ": (2, ""),
}
SPACING = 2.2  # between letters


def rounded(points):
    """Chaikin's corner cutting: a quadratic B-spline, near enough after three rounds."""
    closed = points[0] == points[-1]
    for _ in range(3):
        cut = [] if closed else [points[0]]
        for (ax, ay), (bx, by) in zip(points, points[1:]):
            cut += [(0.75 * ax + 0.25 * bx, 0.75 * ay + 0.25 * by),
                    (0.25 * ax + 0.75 * bx, 0.25 * ay + 0.75 * by)]
        points = cut + [cut[0] if closed else points[-1]]
    return points


def segments(glyph):
    lines = []
    for stroke in GLYPHS[glyph][1].split("|"):
        points = [(float(p[0]), float(p[1])) for p in stroke.lstrip("~").split()]
        points = rounded(points) if stroke.startswith("~") else points
        lines += zip(points, points[1:])
    return lines


def distance(x, y, line):
    (ax, ay), (bx, by) = line
    dx, dy = bx - ax, by - ay
    along = max(0.0, min(1.0, ((x - ax) * dx + (y - ay) * dy) / (dx * dx + dy * dy or 1.0)))
    return math.hypot(x - ax - along * dx, y - ay - along * dy)


def width(text, size):
    """Pixels that `text` takes when tall letters are `size` pixels high."""
    unit = size / 6.0
    return unit * (sum(GLYPHS[letter][0] + SPACING for letter in text) - SPACING)


def write(picture, text, left, base, size, color, bold=1.0):
    """Lays `text` on the picture with its base line at `base`."""
    unit, pen = size / 6.0, 0.5 * max(1.3, size / 9.0) * bold
    for letter in text:
        lines = segments(letter)
        reach = unit * GLYPHS[letter][0] + 2 * pen + 2
        for y in range(round(base - 1.3 * size), round(base + 0.5 * size) + 1):
            for x in range(int(left - pen - 1), int(left + reach) + 1):
                if not (lines and 0 <= y < picture.height and 0 <= x < picture.width):
                    continue
                near = unit * min(distance((x + 0.5 - left) / unit, 2 + (base - y - 0.5) / unit, line)
                                  for line in lines)
                if near < pen + 0.5:
                    picture.blend(x, y, color, min(1.0, pen + 0.5 - near))
        left += unit * (GLYPHS[letter][0] + SPACING)
