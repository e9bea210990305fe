# SPDX-License-Identifier: MIT
"""Dulse, a red seaweed: a rosette of broad, ruffled leaves that fork into lobes; 0.5 m tall, its foot at the
origin."""

import math

from geometry import Mesh, along, cross, dome, interpolate, normalize, rounded, sub, superellipse
from noise import between, fractal_noise, mix, ramp, shade, smoothstep, srgb, value_noise
from rig import rig as make_rig
from rig import travelling_wave

HEIGHT = 0.5
DARK, WINE, ROSE, EDGE, FOOT = srgb("#4a0f22"), srgb("#8e1f3c"), srgb("#cf4a5c"), srgb("#f29a86"), srgb(
    "#5b4436")
LEAVES = 9


def leaf(mesh, azimuth, rise, droop, length, width, seed, root, depth=0):
    """A stalk that widens into a ruffled leaf; two lobes sprout from it, which have no lobes of their own."""
    steps = rounded(54, 0.25)
    index = {s: k for k, s in enumerate(steps)}
    line, wander = [root], between(-0.5, 0.5, seed, 320)
    for before, s in zip(steps, steps[1:]):
        turn, tilt = 2.0 * math.pi * azimuth + wander * s, 2.0 * math.pi * (
            rise - droop * smoothstep(0.15, 1.1, s))
        heading = (math.cos(turn) * math.cos(tilt), math.sin(tilt), math.sin(turn) * math.cos(tilt))
        line.append(along(line[-1], (heading, length * (s - before))))
    half = ((0.0, 0.10), (0.15, 0.12), (0.45, 0.80), (0.65, 1.0), (0.85, 0.85), (1.0, 0.45))
    waves, lag = between(3.2, 4.4, seed, 321), between(0.3, 0.6, seed, 322)

    def section(s):
        k = index[s]
        tangent = normalize(sub(line[min(k + 1, len(line) - 1)], line[max(k - 1, 0)]))
        side = normalize(cross(tangent,
                               (math.cos(2.0 * math.pi * azimuth), 0.35, math.sin(2.0 * math.pi * azimuth))))
        normal = cross(side, tangent)
        end = dome(s / 0.02) * dome((1.0 - s) / 0.06)
        wide, thick = (width * interpolate(half, s) + 0.002) * end, (0.0062
                                                                     - 0.0012 * smoothstep(0.1, 0.4, s)) * end
        ruffle = 0.34 * width * smoothstep(0.2, 0.6, s) * end
        notch = [1.0 - 0.10 * smoothstep(0.35, 0.6, s)
                 * (0.5 + 0.5 * math.sin(2.0 * math.pi * (2.6 * waves * s + 0.5 * j))) for j in (0, 1)]
        lift = [ruffle * math.sin(2.0 * math.pi * (waves * s + j * lag) + seed) for j in (0, 1)]

        def point(angle):
            u, v = superellipse(angle, 3.0)
            j = u > 0
            return along(line[k], (side, u * wide * notch[j]),
                         (normal, v * thick + lift[j] * abs(u) ** 1.6 + 0.25 * wide * u * u))

        def color(angle, p):
            u = abs(math.cos(angle))
            base = ramp(((0.0, DARK), (0.35, WINE), (0.8, ROSE), (1.0, EDGE)),
                        s + 0.15 * fractal_noise(20 * p[0], 20 * p[1], 20 * p[2], 2, 323))
            base = mix(base, EDGE, 0.55 * smoothstep(0.78, 1.0, u) * smoothstep(0.2, 0.5, s))
            vein = abs(math.sin(math.pi * (5.0 * s - 1.2 * u)))
            base = mix(base, DARK, 0.35 * (1.0 - smoothstep(0.0, 0.35, vein)))
            return shade(base, 1.0 + 0.15 * value_noise(4.0 * u, 9.0 * s, seed, 324))

        return point, color

    mesh.skin(steps, 26, section)
    if depth == 0:
        for j, sign in enumerate((-1.0, 1.0)):
            at = line[26 + 6 * j]
            leaf(mesh, azimuth + sign * between(0.09, 0.15, seed, 325 + j), rise - 0.35 * droop, 0.7 * droop,
                 0.52 * length,
                 0.62 * width, 31 * seed + j, at, 1)


def foot(mesh):
    def point(d):
        y = 0.012 + 0.02 * d[1]
        r = 0.035 * (1.0 + 0.3 * value_noise(2.5 * d[0], 2.5 * d[1], 2.5 * d[2], 326))
        return (r * d[0], y if y > 0.004 else 0.004 * math.exp((y - 0.004) / 0.004), r * d[2])

    mesh.ball(4, point, lambda d,
              p: shade(FOOT, 1.0 + 0.4 * value_noise(120 * p[0], 120 * p[1], 120 * p[2], 327)))


def surfaces():
    disc, leaves = Mesh(), Mesh()
    foot(disc)
    for i in range(LEAVES):
        outer, turn = i / (LEAVES - 1), 2.0 * math.pi * 0.382 * i
        leaf(leaves, 0.382 * i + between(-0.04, 0.04, i, 328), 0.235 - 0.13 * outer, 0.02 + 0.07 * outer,
             HEIGHT * (0.87 - 0.22 * outer) * (1.0 if i == 0 else between(0.92, 1.02, i, 329)),
             0.072 - 0.014 * outer, 10 + i,
             (0.012 * math.cos(turn), 0.012, 0.012 * math.sin(turn)))
    return [("foot", 0.9, disc), ("dulse", 0.35, leaves)]


def rig():
    """`sway`: short and soft. The foot never moves."""
    knots = (0, 0.5, 1)
    sway = (travelling_wave(knots, (1, 0, 0.3), (0, 0, 0.14), 0.25, 4)
            + travelling_wave(knots, (-0.3, 0, 1), (0, 0, 0.09), 0.35, 2, 0.2))
    return make_rig("+y", knots, sway=sway)
