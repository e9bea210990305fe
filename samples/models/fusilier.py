# SPDX-License-Identifier: MIT
"""A fusilier, the slender fish of the open reef: silver below, blue above, a yellow back and forked tail;
0.24 m long, swimming along +x."""

import math

from fish import fin
from geometry import Mesh, dome, interpolate, rounded
from noise import fractal_noise, mix, ramp, shade, smoothstep, srgb, value_noise
from rig import bent_line, cycle, travelling_wave
from rig import rig as make_rig

BACK, BLUE, PALE, SILVER, BELLY = srgb("#f4c21b"), srgb("#1f74d6"), srgb("#6fc4ff"), srgb("#cfe6f2"), srgb(
    "#f3fafc")
INK, NAVY, ROSE = srgb("#05080f"), srgb("#0d2a63"), srgb("#e9b7b0")

NOSE, PEDUNCLE = 0.120, -0.072
TOP = ((0.0, 0.002), (0.04, 0.009), (0.12, 0.018), (0.28, 0.027), (0.45, 0.030), (0.65, 0.025), (0.85, 0.013),
       (0.95, 0.0085), (1.0, 0.008))
BOTTOM = ((0.0, -0.002), (0.04, -0.008), (0.12, -0.017), (0.28, -0.026), (0.45, -0.028), (0.65, -0.023),
          (0.85, -0.012), (0.95, -0.0085),
          (1.0, -0.008))
HALF = ((0.0, 0.003), (0.04, 0.008), (0.12, 0.0125), (0.28, 0.0165), (0.45, 0.0175), (0.65, 0.0145),
        (0.85, 0.0085), (0.95, 0.006), (1.0, 0.0055))
EYE = (0.096, 0.0045)


def at(table, x):
    return interpolate(table, (NOSE - x) / (NOSE - PEDUNCLE))


def body(mesh):
    def section(s):
        x, end = NOSE + (PEDUNCLE - NOSE) * s, dome(s / 0.025)
        upper, lower, half = interpolate(TOP, s) * end, -interpolate(BOTTOM,
                                                                     s) * end, interpolate(HALF, s) * end

        def point(angle):
            c, h = math.cos(angle), math.sin(angle)
            return (x, (upper if h > 0 else lower) * h, math.copysign(half * abs(c) ** 0.95, c))

        def color(angle, p):
            y = p[1] / max(upper if p[1] > 0 else lower, 1e-6)
            base = ramp(((-0.9, BELLY), (-0.35, SILVER), (-0.05, PALE), (0.18, BLUE), (0.9, BLUE)), y)
            # The yellow of the tail runs forward along the back in a wedge.
            base = mix(base, BACK, smoothstep(-0.08, 0.10, y - 0.55 + 1.35 * smoothstep(0.25, 1.0, s)))
            line = abs(y - 0.10 - 0.15 * math.sin(3.0 * s))
            base = mix(base, NAVY, 0.6 * (1.0 - smoothstep(0.02, 0.06, line)) * smoothstep(0.2, 0.3, s))
            base = mix(base, ROSE, 0.5 * smoothstep(0.10, 0.0, s))
            scale = math.hypot((x / 0.006 + 0.5 * (round(p[1] / 0.005) % 2)) % 1.0 - 0.5,
                               p[1] / 0.005 - round(p[1] / 0.005))
            light = 1.05 - 0.18 * smoothstep(0.3, 0.6, scale) * smoothstep(0.2, 0.25, s)
            return shade(base, light + 0.08 * fractal_noise(40 * x, 60 * p[1], 0.0, 2, 340))

        return point, color

    mesh.skin(rounded(150, 0.15), 72, section)


def fins(mesh):
    def ridge(table, first, last, sink):
        return lambda u: (first + (last - first) * u, at(table, first + (last - first) * u) - sink, 0.0)

    def paint(low, high):
        return lambda u, v, p: mix(low, high, smoothstep(0.1, 0.9, v))

    back = ridge(TOP, 0.050, -0.060, 0.005)
    fin(mesh, back,
        lambda u: (back(u)[0] - 0.012 - 0.010 * u,
                   back(u)[1] + interpolate(((0.0, 0.008), (0.2, 0.024), (0.6, 0.016), (1.0, 0.009)), u),
                   0.0),
        paint(BLUE, BACK), 14.0, 0.0025)
    keel = ridge(BOTTOM, -0.010, -0.060, -0.005)
    fin(mesh, keel,
        lambda u: (keel(u)[0] - 0.012,
                   keel(u)[1] - interpolate(((0.0, 0.008), (0.3, 0.020), (1.0, 0.008)), u), 0.0),
        paint(SILVER, PALE), 9.0, 0.0025)
    for sign in (1.0, -1.0):  # the two lobes of the tail
        def root(u, sign=sign):
            return (-0.066, sign * (0.001 + 0.0065 * u), 0.0)

        def tip(u, sign=sign):
            return (-0.083 - 0.036 * u ** 1.3, sign * (0.003 + 0.041 * u), 0.0)

        fin(mesh, root, tip, lambda u, v,
            p: mix(BACK, shade(BACK, 0.75), value_noise(20 * v, 6 * u, 0.0, 341)), 8.0, 0.0026)

    for side in (1.0, -1.0):
        def base(u, side=side):
            return (0.055 - 0.003 * u, 0.000 - 0.010 * u, side * 0.0145)

        def end(u, side=side):
            return (0.030 - 0.012 * u, 0.004 - 0.024 * u, side * (0.0145 + 0.017))

        fin(mesh, base, end, paint(PALE, SILVER), 6.0, 0.0024, 36, across=(0.5, 0.0, side * 0.86))


def eyes(mesh):
    for side in (1.0, -1.0):
        def color(d, p):
            iris = shade(mix(SILVER, BACK, 0.3 + 0.3 * d[1]), 0.8 + 0.3 * math.hypot(d[0], d[1]))
            return mix(INK, iris, smoothstep(0.5, 0.58, math.hypot(d[0], d[1])))

        mesh.ball(4, lambda d,
                  side=side: (EYE[0] + 0.0075 * d[0], EYE[1] + 0.0075 * d[1], side * 0.0112 + 0.0042 * d[2]),
                  color)


def surfaces():
    scales, wet = Mesh(), Mesh()
    body(scales)
    fins(scales)
    eyes(wet)
    return [("scales", 0.3, scales), ("eyes", 0.15, wet)]


KNOTS = (0, 0.35, 0.7, 1)


def turning(moment):
    """The angle of the center line by its place: the fish bends into a C within a fifth of the clip, strikes
    back over the straight line, and comes to rest."""
    bend = interpolate(((0.0, 0.0), (0.08, 0.0), (0.30, 1.0), (0.36, 1.0), (0.62, -0.38), (0.68, -0.38),
                        (0.92, 0.0), (1.0, 0.0)), moment)

    def angle(at):
        return 0.5 * math.pi * bend * (smoothstep(0.0, 1.0, at) - 0.4)

    return angle


def rig():
    """`swim`: like the larger fish's, but with shorter, quicker strokes. `turn`: a fast start, in which the
    body bends by 90 degrees. It is swept, so it bends as fish do."""
    def pose(moment):
        return bent_line(KNOTS, "-x", (0, 0, 1), turning(moment), still=0.4)

    swim = travelling_wave(KNOTS, (0, 0, 1), (0.015, -0.035, 0.13), 0.75, 0.5)
    return make_rig("-x", KNOTS, bend="sweep", swim=swim, turn=cycle(pose, 1.0, 16))
