# SPDX-License-Identifier: MIT
"""A jelly, turned out of a fluted mold: 24 cm tall, standing on the origin."""

import math

from geometry import Mesh, interpolate
from noise import fractal_noise, mix, smoothstep, srgb
from rig import rig as make_rig

HEIGHT, FLUTES = 0.24, 9
DEEP, RED, LIGHT = srgb("#a3142c"), srgb("#e0243c"), srgb("#ff8a7a")

# Radius over height, in meters, from the middle of the bottom to that of the top, which has a dent.
OUTLINE = ((0.0, 0.02, 0.0), (0.02, 0.165, 0.0), (0.2, 0.18, 0.016), (0.6, 0.155, 0.12), (0.78, 0.13, 0.205),
           (0.9, 0.09, 0.24), (0.97, 0.045, 0.225), (1.0, 0.01, 0.215))
RADIUS = tuple((s, r) for s, r, _ in OUTLINE)
RISE = tuple((s, y) for s, _, y in OUTLINE)


def surfaces():
    mesh = Mesh()

    def section(s):
        radius, y = interpolate(RADIUS, s), interpolate(RISE, s)
        fluted = 0.09 * smoothstep(0.05, 0.3, s) * (1.0 - smoothstep(0.85, 0.97, s))

        def point(angle):
            r = radius * (1.0 + fluted * (abs(math.cos(0.5 * FLUTES * angle)) - 0.5))
            return (r * math.cos(angle), y, r * math.sin(angle))

        def color(angle, p):
            groove = 1.0 - abs(math.cos(0.5 * FLUTES * angle))
            base = mix(DEEP, RED, smoothstep(0.0, 0.6, p[1] / HEIGHT + 0.2 * fractal_noise(9 * p[0], 9 * p[1],
                                                                                        9 * p[2], 2, 300)))
            return mix(mix(base, LIGHT, 0.5 * smoothstep(0.6, 1.0, p[1] / HEIGHT)), DEEP, 0.6 * fluted * 11
                       * smoothstep(0.5, 1.0, groove))

        return point, color

    mesh.skin([i / 80 for i in range(81)], 20 * FLUTES, section)
    return [("jelly", 0.25, mesh)]


def rig():
    return make_rig("+y", (0, 1))
