# SPDX-License-Identifier: MIT
"""A patch of sea floor: rippled sand with pebbles, 2.5 m wide, for things to stand on. It does not bend."""

import math

from geometry import Mesh
from noise import between, cell_distance, fractal_noise, mix, ramp, shade, smoothstep, srgb
from rig import rig as make_rig

HALF_WIDTH, HALF_DEPTH, THICKNESS = 1.25, 0.72, 0.045
SHADE, SAND, SUN = srgb("#a98f62"), srgb("#d8c08c"), srgb("#f0e0b4")
GRIT = srgb("#7d6a4c")
PEBBLES = (srgb("#6f757c"), srgb("#9aa0a2"), srgb("#b98d78"), srgb("#4d555e"), srgb("#d5cdbd"),
           srgb("#8f6f72"))


def ripple(x, z):
    """-1 in a trough, 1 on a crest; the crests wander and fork."""
    bend = 0.9 * fractal_noise(1.3 * x, 1.3 * z, 0.0, 2, 200)
    return math.sin(2.0 * math.pi * (7.5 * z + 1.1 * x + bend)) * (0.55
                                                                   + 0.45 * fractal_noise(2.2 * x, 2.2 * z,
                                                                                          1.0, 2, 210))


def height(x, z):
    """Of the sand above the ground, inside its edge."""
    return THICKNESS + 0.006 * ripple(x, z) + 0.016 * fractal_noise(0.9 * x, 0.9 * z, 2.0, 2, 220)


def sand(mesh):
    def point(d):
        # The sphere's upper half becomes the top, its lower half the bottom; a rounded rectangle, and a soft
        # edge where they meet.
        flat = math.hypot(d[0], d[2])
        reach = math.sqrt(1.0 - abs(d[1]))
        c, s = (d[0] / flat, d[2] / flat) if flat > 1e-9 else (1.0, 0.0)
        square = (abs(c) ** 5 + abs(s) ** 5) ** -0.2
        x, z = HALF_WIDTH * reach * square * c, HALF_DEPTH * reach * square * s
        rim = math.sqrt(1.0 - reach ** 8)
        edge = 0.6 * THICKNESS
        return (x, edge + (height(x, z) - edge) * rim if d[1] > 0 else edge * (1.0 - rim), z)

    def color(d, p):
        x, y, z = p
        grain = fractal_noise(60 * x, 60 * z, 0.0, 2, 230)
        base = ramp(((-1.0, SHADE), (0.0, SAND), (1.0, SUN)), 0.75 * ripple(x, z) + 0.5 * grain)
        return mix(base, GRIT, 0.7 * (1.0 - smoothstep(0.10, 0.22, cell_distance(38 * x, 38 * y, 38 * z))))

    mesh.ball(6, point, color)


def pebbles(mesh):
    for i in range(44):
        x, z = between(-0.92, 0.92, i, 240) * HALF_WIDTH, between(-0.9, 0.9, i, 241) * HALF_DEPTH
        size = 0.014 + 0.030 * between(0.0, 1.0, i, 242) ** 3
        wide, long = size * between(0.9, 1.4, i, 243), size * between(0.8, 1.2, i, 244)
        base = shade(PEBBLES[i % len(PEBBLES)], between(0.8, 1.15, i, 245))

        def point(d, i=i, x=x, z=z, size=size, wide=wide, long=long):
            r = 1.0 + 0.18 * fractal_noise(1.4 * d[0] + 3.1 * i, 1.4 * d[1], 1.4 * d[2], 2, 246)
            return (x + wide * d[0] * r, height(x, z) + 0.2 * size + 0.65 * size * d[1] * r,
                    z + long * d[2] * r)

        def color(d, p, i=i, base=base):
            return shade(base, 1.0 + 0.25 * fractal_noise(3.0 * d[0] + i, 3.0 * d[1], 3.0 * d[2], 2, 247))

        mesh.ball(2, point, color)


def surfaces():
    ground, stones = Mesh(), Mesh()
    sand(ground)
    pebbles(stones)
    return [("sand", 0.9, ground), ("pebbles", 0.6, stones)]


def rig():
    return make_rig("+y", (0, 1))
