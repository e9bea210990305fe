# SPDX-License-Identifier: MIT
"""An orange with a dimpled peel, a calyx, a stem and two leaves; 10 cm tall, standing on the origin."""

import math

from geometry import Mesh, along, cross, dome, interpolate, normalize, rounded, sub, superellipse
from noise import cell_distance, fractal_noise, mix, shade, smoothstep, srgb, value_noise
from rig import rig as make_rig
from rig import travelling_wave

RADIUS = 0.042
CENTER = 0.0395

PEEL, PEEL_WARM, PEEL_LIGHT, PORE = srgb("#f98a0c"), srgb("#ee6a05"), srgb("#ffb02e"), srgb("#d9560a")
GREENISH, CALYX, CALYX_EDGE = srgb("#9aa324"), srgb("#5d7a2b"), srgb("#93a24c")
WOOD, CUT = srgb("#6e5a2e"), srgb("#cdb98a")
LEAF, LEAF_DEEP, LEAF_LIGHT, VEIN, UNDERSIDE = srgb("#2f7d2a"), srgb("#1c5a22"), srgb("#69a83a"), srgb(
    "#a9cf6a"), srgb("#6f9b55")


def pore(d):
    """0 on the peel between two pores, 1 at the bottom of one."""
    return 1.0 - smoothstep(0.10, 0.46, cell_distance(17.0 * d[0], 17.0 * d[1], 17.0 * d[2], 0.8))


def peel_radius(d):
    """Distance from the center without pores: a slightly flattened, slightly uneven ball with a dent for the
    stem and one below."""
    lumps = 0.012 * fractal_noise(1.6 * d[0], 1.6 * d[1], 1.6 * d[2], 2, 3)
    above = math.exp(-((1.0 - d[1]) / 0.055))
    below = math.exp(-((1.0 + d[1]) / 0.020))
    azimuth = math.atan2(d[2], d[0])
    folds = 0.010 * math.cos(5.0 * azimuth + 0.6) * math.exp(-((1.0 - d[1] - 0.06) / 0.06) ** 2)
    return RADIUS * (1.0 + lumps - 0.085 * above - 0.05 * below + folds)


def on_peel(d, lift=0.0):
    r = peel_radius(d) + lift
    return (d[0] * r, CENTER + 0.955 * d[1] * r, d[2] * r)


def peel(mesh):
    pores = {}

    def point(d):
        pores[d] = pore(d)
        return on_peel(d, -0.0008 * pores[d] * (1.0 - 0.7 * smoothstep(0.9, 0.99, d[1])))

    def color(d, p):
        patch = fractal_noise(2.2 * d[0], 2.2 * d[1], 2.2 * d[2], 3, 11)
        base = mix(PEEL_WARM, PEEL, smoothstep(-0.5, 0.3, patch))
        base = mix(base, PEEL_LIGHT, 0.55 * smoothstep(0.0, 0.6, patch + 0.35 * d[1]))
        base = mix(base, GREENISH, 0.75 * smoothstep(0.90, 0.995, d[1] + 0.05 * patch))
        base = mix(base, PEEL_WARM, 0.5 * smoothstep(0.96, 1.0, -d[1]))
        return mix(base, PORE, 0.45 * pores[d])

    mesh.ball(6, point, color)


def calyx(mesh):
    """The five-pointed star on which the fruit hung, draped over the dent; s runs from below to the rim at
    1/2 and back on top."""
    def section(s):
        r, v = superellipse(math.pi * (s - 0.5), 2.6)

        def point(angle):
            out = r * (0.0075 + 0.0050 * (0.5 + 0.5 * math.cos(5.0 * angle + 0.6)) ** 1.5)
            tilt = out / RADIUS
            d = (math.sin(tilt) * math.cos(angle), math.cos(tilt), math.sin(tilt) * math.sin(angle))
            curl = 0.0020 * smoothstep(0.55, 1.0, out / 0.0125)
            return on_peel(d, 0.0004 + 0.0015 * v + curl)

        def color(angle, p):
            edge = smoothstep(0.4, 1.0, math.hypot(p[0], p[2]) / 0.012)
            return shade(mix(CALYX, CALYX_EDGE, edge),
                         1.0 + 0.2 * value_noise(900 * p[0], 0.0, 900 * p[2], 21))

        return point, color

    mesh.skin([0.02 + 0.96 * s for s in rounded(24, 0.2)], 60, section)


def stem_path(s):
    return (0.0035 * s * s, 0.0725 + 0.0225 * s, -0.002 * s * s)


def stem(mesh):
    def section(s):
        x, y, z = stem_path(s)
        thick = interpolate(((0.0, 0.0036), (0.35, 0.0025), (0.85, 0.0024), (1.0, 0.0029)),
                            s) * dome(20.0 * (1.0 - s))

        def point(angle):
            r = thick * (1.0 + 0.06 * math.cos(5 * angle))
            return (x + r * math.cos(angle), y, z + r * math.sin(angle))

        def color(angle, p):
            grain = value_noise(6 * math.cos(angle), 500 * p[1], 6 * math.sin(angle), 23)
            return mix(shade(mix(CALYX, WOOD, smoothstep(0.0, 0.45, s)), 1.0 + 0.25 * grain), CUT,
                       smoothstep(0.955, 0.97, s))

        return point, color

    mesh.skin(rounded(30, 0.6), 20, section)


def leaf(mesh, start, azimuth, lift, droop, length, width, seed):
    """A glossy leaf folded along its rib, petiole included."""
    steps = rounded(72, 0.4)
    index = {s: i for i, s in enumerate(steps)}
    line = [start]
    for before, s in zip(steps, steps[1:]):
        turn, rise = 2.0 * math.pi * azimuth + 0.25 * s, 2.0 * math.pi * (
            lift - droop * smoothstep(0.05, 1.0, s))
        heading = (math.cos(turn) * math.cos(rise), math.sin(rise), math.sin(turn) * math.cos(rise))
        line.append(along(line[-1], (heading, length * (s - before))))
    half = ((0.0, 0.0016), (0.13, 0.0016), (0.2, 0.004), (0.48, width), (0.62, 0.93 * width),
            (0.86, 0.45 * width), (1.0, 0.0014))

    def section(s):
        i = index[s]
        tangent = normalize(sub(line[min(i + 1, len(line) - 1)], line[max(i - 1, 0)]))
        side = normalize(cross(tangent, (0.0, 1.0, 0.0)))
        normal = cross(side, tangent)
        blade, end = smoothstep(0.13, 0.3, s), dome((1.0 - s) / 0.04)
        wide, thick = interpolate(half, s) * end, (0.0016 - 0.00030 * blade) * end

        def point(angle):
            u, v = superellipse(angle, 2.0 + blade)
            fold = 0.34 * abs(u) ** 1.3 + 0.10 * u * u * math.sin(13.0 * s + (1.3 if u > 0 else 0.0) + seed)
            groove = 0.0004 * blade * end * math.exp(-(u / 0.1) ** 2)  # along the rib above, a ridge below
            return along(line[i], (side, u * wide), (normal, v * thick + blade * fold * wide - groove))

        def color(angle, p):
            u, v = superellipse(angle, 2.0 + blade)
            body = mix(LEAF_DEEP, LEAF, 0.5 + 0.5 * value_noise(3 * u, 6 * s, 0.0, seed))
            body = mix(body, LEAF_LIGHT,
                       0.45 * smoothstep(0.55, 1.0, abs(u)) + 0.25 * smoothstep(0.6, 1.0, s))
            side_vein = abs(math.sin(math.pi * (9.0 * s - 1.7 * abs(u))))
            body = mix(body, LEAF_LIGHT,
                       0.6 * (1.0 - smoothstep(0.0, 0.42, side_vein)) * smoothstep(0.0, 0.15, abs(u)))
            if v < 0:
                body = mix(body, UNDERSIDE, 0.7)
            body = mix(body, VEIN, 0.85 * (1.0 - smoothstep(0.05, 0.16, abs(u))))
            return mix(mix(CALYX, VEIN, 0.4), body, smoothstep(0.1, 0.22, s))

        return point, color

    mesh.skin(steps, 40, section)


def surfaces():
    skin, green = Mesh(), Mesh()
    peel(skin)
    calyx(green)
    stem(green)
    leaf(green, stem_path(0.62), 0.04, 0.115, 0.17, 0.066, 0.0165, 31)
    leaf(green, stem_path(0.48), 0.40, 0.10, 0.16, 0.046, 0.0125, 32)
    return [("peel", 0.4, skin), ("green", 0.5, green)]


def rig():
    """Like jelly: the crown circles while the waist lags behind."""
    knots = (0, 0.5, 1)
    wobble = (travelling_wave(knots, (1, 0, 0), (0, 0.10, 0.06), 0.12, 1.2)
              + travelling_wave(knots, (0, 0, 1), (0, 0.10, 0.06), 0.12, 1.2, 0.25)
              + travelling_wave(knots, (1, 0, 0.4), (0, 0.20, -0.20), 0.1, 0.6, 0.1))
    return make_rig("+y", knots, wobble=wobble)
