# SPDX-License-Identifier: MIT
"""An octopus's arm: a tapering column, rust and cream, with two rows of suckers along its inner side; 0.6 m
tall, its foot at the origin. It is swept along its spline, so it rolls up as it is, without being sheared."""

import math

from geometry import Mesh, along, cross, dome, interpolate, normalize, rounded
from noise import cell_distance, fractal_noise, mix, shade, smoothstep, srgb
from rig import bent_line, cycle, travelling_wave
from rig import rig as make_rig

HEIGHT = 0.6
WINE, RUST, CORAL, SPOT = srgb("#6b1630"), srgb("#c2452d"), srgb("#f08a4b"), srgb("#ffd08a")
CREAM, ROSE, RIM, CUP = srgb("#f6dcb6"), srgb("#e5a58c"), srgb("#fff0dc"), srgb("#a8495a")

# The column's half thickness along z; along x it is a little less, and flatter on the side of the suckers.
THICK = ((0.0, 0.050), (0.03, 0.046), (0.10, 0.041), (0.30, 0.0345), (0.55, 0.0250), (0.80, 0.0150),
         (0.95, 0.0088), (1.0, 0.0070))
ROWS = 0.62  # the two rows of suckers, radians from +x


def thick(s):
    return interpolate(THICK, s) * dome((s + 0.001) / 0.02) * dome((1.0 - s) / 0.012)


def on_arm(s, angle):
    """Point of the skin; +x is the inner side."""
    c, r = math.cos(angle), thick(s)
    return ((0.78 if c > 0.0 else 0.92) * r * c, HEIGHT * s, r * math.sin(angle))


def skin(mesh):
    def section(s):
        r = max(thick(s), 1e-4)

        def point(angle):
            x, y, z = on_arm(s, angle)
            folds = 1.0 + 0.030 * fractal_noise(260 * x, 130 * y, 260 * z, 2, 351)
            return (folds * x, y, folds * z)

        def color(angle, p):
            inner = math.cos(angle) + 0.18 * fractal_noise(90 * p[0], 40 * p[1], 90 * p[2], 2, 352)
            back = mix(RUST, WINE, smoothstep(-0.25, 0.35, fractal_noise(22 * p[0], 22 * p[1], 22 * p[2], 2,
                                                                         353)))
            back = mix(back, CORAL, 0.8 * smoothstep(0.45, 1.0, s))
            freckle = cell_distance(75.0 * p[0], 75.0 * p[1], 75.0 * p[2])
            back = mix(back, SPOT, 0.75 * (1.0 - smoothstep(0.16, 0.30, freckle)))
            front = mix(CREAM, ROSE, 0.5 + 0.5 * math.sin(2.0 * math.pi * 26.0 * s ** 1.25))
            return mix(back, front, smoothstep(0.25, 0.45, inner))

        return point, color

    mesh.skin(rounded(300, 0.25), 72, section)


# A sucker from its root inside of the arm over the rim into the cup: (radius, height), in its own radii.
PROFILE = ((0.0, -1.1), (0.55, -1.0), (0.72, -0.5), (0.80, -0.1), (0.95, 0.12), (1.0, 0.30), (0.93, 0.44),
           (0.78, 0.46), (0.62, 0.36), (0.48, 0.18), (0.26, 0.08), (0.0, 0.05))


def sucker(mesh, s, side):
    angle = side * ROWS
    root = on_arm(s, angle)
    out = normalize((math.cos(angle) / 0.78, 0.0, math.sin(angle)))
    up = (0.0, 1.0, 0.0)
    across = cross(up, out)
    size = 0.40 * thick(s)

    def section(k):
        radius, height = PROFILE[k]

        def point(turn):
            return along(root, (out, size * height), (up, size * radius * math.cos(turn)),
                         (across, size * radius * math.sin(turn)))

        def color(turn, p):
            bowl = mix(mix(ROSE, RIM, smoothstep(3.0, 5.0, k)), CUP, smoothstep(7.2, 9.5, k))
            return shade(bowl, 1.0 + 0.12 * fractal_noise(150 * p[0], 150 * p[1], 150 * p[2], 2, 354))

        return point, color

    mesh.skin(range(len(PROFILE)), 20, section)


def surfaces():
    arm, cups = Mesh(), Mesh()
    skin(arm)
    s, count = 0.075, 0
    while s < 0.975:
        sucker(cups, s, 1.0 if count % 2 else -1.0)
        count += 1
        s += 0.46 * thick(s) / HEIGHT
    return [("skin", 0.35, arm), ("suckers", 0.3, cups)]


KNOTS = (0, 0.2, 0.4, 0.55, 0.7, 0.85, 1)


def curled(amount):
    """The angle of the center line by its place: it leans back below, and rolls up from the tip down."""
    front = 1.0 - 0.70 * amount

    def angle(at):
        lean = -0.45 * amount * smoothstep(0.2, 0.5, at)
        roll = max(0.0, at - front)
        return lean + 5.16 * (roll / 0.70) ** 1.6

    return angle


def rig():
    """`curl`: rolls up until the tip has turned by 270 degrees, and unrolls. `sway`: in a slow current. The
    foot never moves."""
    duration = 5.0

    def pose(moment):
        return bent_line(KNOTS, "+y", (1, 0, 0), curled(0.5 - 0.5 * math.cos(2.0 * math.pi * moment)))

    sway = (travelling_wave(KNOTS, (1, 0, 0.15), (0, 0, 0.16, 0.05), 0.45, 5)
            + travelling_wave(KNOTS, (-0.2, 0, 1), (0, 0, 0.08, 0.05), 0.6, 5, 0.3))
    clips = {"curl": cycle(pose, duration, 12), "sway": sway}
    return dict(make_rig("+y", KNOTS, bend="sweep", **clips), sockets={"tip": {"at": 1}})
