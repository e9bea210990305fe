# SPDX-License-Identifier: MIT
"""A flat plate with a rim, 60 cm wide. Things land on it; it does not bend."""

import math

from geometry import Mesh, interpolate
from noise import mix, smoothstep, srgb
from rig import rig as make_rig

CHINA, BLUE = srgb("#e8e4d8"), srgb("#2f5f8f")

# Radius and height, in meters, from the middle of the bottom round the rim to that of the top.
RADIUS = ((0.0, 0.002), (0.1, 0.2), (0.5, 0.297), (0.52, 0.3), (0.54, 0.297),
          (0.7, 0.262), (0.99, 0.01), (1.0, 0.002))
RISE = ((0.0, 0.0), (0.1, 0.0), (0.5, 0.036), (0.52, 0.04), (0.54, 0.044),
        (0.7, 0.024), (0.71, 0.024), (1.0, 0.024))


def surfaces():
    mesh = Mesh()

    def section(s):
        radius, y = interpolate(RADIUS, s), interpolate(RISE, s)

        def point(angle):
            return (radius * math.cos(angle), y, radius * math.sin(angle))

        def color(angle, p):
            out = math.hypot(p[0], p[2])
            return mix(CHINA, BLUE, smoothstep(0.268, 0.272, out) * (1.0 - smoothstep(0.285, 0.289, out)))

        return point, color

    mesh.skin([i / 100 for i in range(101)], 120, section)
    return [("plate", 0.35, mesh)]


def rig():
    return make_rig("+y", (0, 1))
