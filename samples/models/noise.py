# SPDX-License-Identifier: MIT
"""Repeatable randomness and color: the same numbers on every run."""

import math


def hash01(*keys):
    """A number in [0, 1) from integers: a small avalanche hash, independent of Python's own hashing."""
    h = 0x9E3779B9
    for key in keys:
        h = (h ^ (key & 0xFFFFFFFF)) * 0x85EBCA6B & 0xFFFFFFFF
        h = (h ^ (h >> 13)) * 0xC2B2AE35 & 0xFFFFFFFF
        h ^= h >> 16
    return h / 4294967296.0


def between(low, high, *keys):
    return low + (high - low) * hash01(*keys)


def smoothstep(low, high, x):
    t = (x - low) / (high - low)
    return 0.0 if t <= 0.0 else 1.0 if t >= 1.0 else t * t * (3.0 - 2.0 * t)


# One random permutation and one random value for each of 256 lattice points: noise repeats every 256 units,
# which no model reaches.
SHUFFLED = sorted(range(256), key=lambda i: hash01(i, 1)) * 2
VALUES = [2.0 * hash01(i, 2) - 1.0 for i in range(256)]


def value_noise(x, y, z, seed=0):
    """Smooth noise in [-1, 1], one feature per unit of length."""
    xi, yi, zi = math.floor(x), math.floor(y), math.floor(z)
    u, v, w = x - xi, y - yi, z - zi
    u, v, w = u * u * (3.0 - 2.0 * u), v * v * (3.0 - 2.0 * v), w * w * (3.0 - 2.0 * w)
    xi, yi, zi, shuffled, values = (xi + 37 * seed) & 255, yi & 255, zi & 255, SHUFFLED, VALUES
    yj, zj = (yi + 1) & 255, (zi + 1) & 255
    planes = []
    for i in (xi, (xi + 1) & 255):
        near, far = shuffled[shuffled[i] + yi], shuffled[shuffled[i] + yj]
        a, b = values[shuffled[near + zi]], values[shuffled[near + zj]]
        c, d = values[shuffled[far + zi]], values[shuffled[far + zj]]
        a, c = a + (b - a) * w, c + (d - c) * w
        planes.append(a + (c - a) * v)
    return planes[0] + (planes[1] - planes[0]) * u


def fractal_noise(x, y, z, octaves=3, seed=0):
    """Sum of octaves of value_noise, about [-1, 1]."""
    total, gain = 0.0, 0.5
    for octave in range(octaves):
        total += gain * value_noise(x, y, z, seed + octave)
        x, y, z, gain = 2.03 * x, 2.03 * y, 2.03 * z, 0.5 * gain
    return total


def cell_distance(x, y, z, jitter=1.0):
    """Distance to the nearest of the points scattered one per unit cell (Worley's F1); jitter 0 is a regular
    grid."""
    xi, yi, zi = math.floor(x), math.floor(y), math.floor(z)
    shuffled, values, half, best = SHUFFLED, VALUES, 0.5 * jitter, 9.0
    for i in (xi - 1, xi, xi + 1):
        for j in (yi - 1, yi, yi + 1):
            column = shuffled[shuffled[i & 255] + (j & 255)]
            for k in (zi - 1, zi, zi + 1):
                cell = shuffled[column + (k & 255)]
                dx = i + 0.5 + half * values[cell] - x
                dy = j + 0.5 + half * values[shuffled[cell + 1]] - y
                dz = k + 0.5 + half * values[shuffled[cell + 2]] - z
                square = dx * dx + dy * dy + dz * dz
                if square < best:
                    best = square
    return math.sqrt(best)


def srgb(hex_color):
    """'#rrggbb' as artists pick it, to the linear color that glTF stores."""
    channels = (int(hex_color[i:i + 2], 16) / 255.0 for i in (1, 3, 5))
    return tuple(c / 12.92 if c <= 0.04045 else ((c + 0.055) / 1.055) ** 2.4 for c in channels)


def mix(a, b, t):
    t = 0.0 if t <= 0.0 else 1.0 if t >= 1.0 else t
    (r, g, b), (to_r, to_g, to_b) = a, b
    return (r + (to_r - r) * t, g + (to_g - g) * t, b + (to_b - b) * t)


def shade(color, factor):
    return tuple(min(max(c * factor, 0.0), 1.0) for c in color)


def ramp(stops, x):
    """Color at x along [(position, color), ...]."""
    for (x0, c0), (x1, c1) in zip(stops, stops[1:]):
        if x <= x1:
            return mix(c0, c1, smoothstep(x0, x1, x))
    return stops[-1][1]
