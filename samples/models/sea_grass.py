# SPDX-License-Identifier: MIT
"""A tuft of sea grass: ribbons that rise from one root, the outer ones leaning out and curling over; 0.8 m
tall, its foot at the origin."""

import math

from geometry import Mesh, along, cross, dome, interpolate, normalize, rounded, sub, superellipse
from noise import between, mix, ramp, shade, smoothstep, srgb, value_noise
from rig import rig as make_rig
from rig import travelling_wave

HEIGHT = 0.8
SHEATH, DEEP, LEAF, LIGHT, TIP = srgb("#8a8a4a"), srgb("#1f6b3a"), srgb("#3f9a3c"), srgb("#8cc850"), srgb(
    "#c9d873")
ROOT, ROOT_LIGHT = srgb("#5a4630"), srgb("#9c8560")
RIBBONS = 17


def ribbon(mesh, i):
    """One blade of grass: half as thick as wide at the sheath, then a flat band with a rounded tip."""
    outer = (i / (RIBBONS - 1)) ** 0.7
    azimuth = 2.0 * math.pi * (0.382 * i + between(-0.06, 0.06, i, 300))
    length = HEIGHT * (1.0 if i == 0 else between(0.72, 1.0, i, 301) * (1.02 - 0.3 * outer))
    width = between(0.0125, 0.0165, i, 302)
    lean, curl = 0.05 + 0.42 * outer, between(0.3, 1.05, i, 303) * outer
    spin, warm = between(-1.2, 1.2, i, 304), between(-0.2, 0.3, i, 305)
    steps = rounded(60, 0.15)
    index = {s: k for k, s in enumerate(steps)}
    out, side = (math.cos(azimuth), 0.0, math.sin(azimuth)), (-math.sin(azimuth), 0.0, math.cos(azimuth))
    line = [along((0.0, 0.004, 0.0), (out, 0.028 * outer))]
    for before, s in zip(steps, steps[1:]):
        tilt = lean * smoothstep(-0.1, 0.35, s) + curl * s ** 2.2
        heading = along((0.0, math.cos(tilt), 0.0), (out, math.sin(tilt)),
                        (side, 0.08 * math.sin(7.0 * s + i)))
        line.append(along(line[-1], (normalize(heading), length * (s - before))))

    def section(s):
        k = index[s]
        tangent = normalize(sub(line[min(k + 1, len(line) - 1)], line[max(k - 1, 0)]))
        twist = spin * s
        across = along((0.0, 0.0, 0.0), (side, math.cos(twist)), (out, math.sin(twist)))
        normal = normalize(cross(across, tangent))
        across = cross(tangent, normal)
        end = dome(s / 0.02) * dome((1.0 - s) / 0.05)
        wide = width * interpolate(((0.0, 0.55), (0.2, 0.8), (0.5, 1.0), (0.85, 0.8), (1.0, 0.45)), s) * end
        thick = interpolate(((0.0, 0.0085), (0.25, 0.0066), (1.0, 0.0062)), s) * end

        def point(angle):
            u, v = superellipse(angle, 2.8)
            return along(line[k], (across, u * wide), (normal, v * thick - 0.12 * wide * u * u))

        def color(angle, p):
            u = math.cos(angle)
            base = ramp(((0.0, SHEATH), (0.14, DEEP), (0.5, LEAF), (0.85, LIGHT), (1.0, TIP)),
                        s + 0.25 * warm)
            base = mix(base, LIGHT, 0.35 * (1.0 - smoothstep(0.05, 0.3, abs(u))))
            return shade(base, 1.0 + 0.16 * value_noise(5.0 * u, 16.0 * s, i, 306))

        return point, color

    mesh.skin(steps, 16, section)


def root(mesh):
    """A low, knobbly cushion that the ribbons come out of."""
    def point(d):
        r = 1.0 + 0.25 * value_noise(3.0 * d[0], 3.0 * d[1], 3.0 * d[2], 307)
        y = 0.02 + 0.026 * d[1] * r
        return (0.055 * d[0] * r, y if y > 0.006 else 0.006 * math.exp((y - 0.006) / 0.006), 0.055 * d[2] * r)

    mesh.ball(4, point, lambda d,
              p: mix(ROOT, ROOT_LIGHT, 0.4 + 0.6 * value_noise(90 * p[0], 90 * p[1], 90 * p[2], 308)))


def surfaces():
    foot, leaves = Mesh(), Mesh()
    root(foot)
    for i in range(RIBBONS):
        ribbon(leaves, i)
    return [("root", 0.9, foot), ("grass", 0.4, leaves)]


def rig():
    """`sway`: slow and wide, with a ripple that runs up the ribbons. The foot never moves."""
    knots = (0, 0.3, 0.65, 1)
    sway = (travelling_wave(knots, (1, 0, 0.2), (0, 0, 0.24, 0.04), 0.30, 5)
            + travelling_wave(knots, (-0.2, 0, 1), (0, 0, 0.10), 0.40, 2.5, 0.3)
            + travelling_wave(knots, (1, 0, -0.3), (0, 0, 0.12, -0.09), 0.7, 1.25, 0.1))
    return make_rig("+y", knots, sway=sway)
