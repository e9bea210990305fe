# SPDX-License-Identifier: MIT
"""Giant kelp on its stone: fronds of ruffled blades, each held up by a gas bladder; 1.2 m tall, its foot at
the origin."""

import math

from geometry import (Mesh, add, along, cross, dome, dot, interpolate, normalize, rounded, scale, sub,
                      superellipse)
from noise import between, fractal_noise, mix, ramp, shade, smoothstep, srgb, value_noise
from rig import rig as make_rig
from rig import travelling_wave

HEIGHT = 1.2

# Blades, from the old ones at the foot to the young ones in the light.
OLD, MATURE, YOUNG, TIP = srgb("#6b5412"), srgb("#6f7a18"), srgb("#8fa326"), srgb("#e6d253")
RIB, BLADDER, BLADDER_TOP = srgb("#74480f"), srgb("#c4811b"), srgb("#f6cf62")
STIPE_LOW, STIPE_HIGH = srgb("#5b3413"), srgb("#b48a2e")
ROOT, ROOT_TIP = srgb("#6f3f17"), srgb("#c99a55")
STONE, STONE_DARK, CRUST = srgb("#9a98a2"), srgb("#55535f"), srgb("#b7577a")

# (height, azimuth in turns, lean at the top in meters, pairs of blades, seed)
FRONDS = ((1.00, 0.02, 0.02, 6, 1), (0.71, 0.44, 0.16, 4, 2), (0.46, 0.93, 0.16, 3, 3))


def direction(azimuth, elevation):
    """Unit vector; azimuth in turns about y, elevation in turns above the horizon."""
    a, e = 2.0 * math.pi * azimuth, 2.0 * math.pi * elevation
    return (math.cos(a) * math.cos(e), math.sin(e), math.sin(a) * math.cos(e))


def tube(mesh, path, radius, color, steps, around=12):
    """A round skin about path(s) with radius(s); color(s, angle, position)."""
    frames, side = {}, (0.31, 0.17, 0.93)
    for s in steps:  # each frame follows from the one before, so that the skin does not twist
        tangent = normalize(sub(path(min(s + 1e-3, 1.0)), path(max(s - 1e-3, 0.0))))
        side = normalize(along(side, (tangent, -dot(side, tangent))))
        frames[s] = side, cross(tangent, side)

    def section(s):
        center, (side, other) = path(s), frames[s]
        r = radius(s) * dome(20.0 * s) * dome(20.0 * (1.0 - s))
        return (lambda angle: along(center, (side, r * math.cos(angle)), (other, r * math.sin(angle))),
                lambda angle, p: color(s, angle, p))

    mesh.skin(steps, around, section)


def stone_radius(d, octaves=3):
    return 1.0 + 0.22 * fractal_noise(1.6 * d[0] + 5.0, 1.6 * d[1], 1.6 * d[2], octaves, 40)


def stone(mesh):
    def point(d):
        r = stone_radius(d)
        x, y, z = 0.165 * d[0] * r, 0.062 * d[1] * r + 0.038, 0.135 * d[2] * r
        # it lies on the ground, almost flat
        return (x, y if y > 0.012 else 0.012 * math.exp((y - 0.012) / 0.012), z)

    def color(d, p):
        grain = fractal_noise(45 * p[0], 45 * p[1], 45 * p[2], 3, 50)
        base = mix(STONE_DARK, STONE, 0.25 + 0.5 * smoothstep(0.0, 0.09, p[1]) + 0.6 * grain)
        patch = fractal_noise(17 * p[0], 17 * p[1], 17 * p[2], 3, 60) + 0.12 * d[1]
        return mix(base, shade(CRUST, 1.0 + 0.5 * grain), 0.85 * smoothstep(0.12, 0.24, patch))

    mesh.ball(5, point, color)


def holdfast(mesh):
    """A crown that gathers the stipes, and root-like haptera that drape from it over the stone and grip
    it."""
    def bark(s, angle, p):
        return shade(mix(ROOT, STIPE_LOW, s),
                     1.0 + 0.3 * value_noise(2.5 * math.cos(angle), 14 * p[1], 2.5 * math.sin(angle), 79))

    crown = ((0.0, 0.056), (0.5, 0.036), (1.0, 0.017))
    tube(mesh, lambda s: (0.0, 0.06 + 0.11 * s, 0.0), lambda s: interpolate(crown, s), bark, rounded(24, 0.3),
         24)

    count = 21
    for i in range(count):
        azimuth = (i + between(-0.35, 0.35, i, 70)) / count
        reach = (0.80, 0.55, 0.95)[i % 3] * between(0.9, 1.1, i, 71)
        start = between(0.145, 0.185, i, 72)
        curl = between(-0.06, 0.06, i, 73)

        def path(s, azimuth=azimuth, reach=reach, start=start, curl=curl, i=i):
            """From the stipe down to the stone, then along its surface."""
            turn = 2.0 * math.pi * (azimuth + curl * s * s + 0.012 * math.sin(8.0 * s + i))
            tilt = 0.5 * math.pi * (0.02 + 0.92 * reach * s ** 1.25)
            d = (math.sin(tilt) * math.cos(turn), math.cos(tilt), math.sin(tilt) * math.sin(turn))
            r = stone_radius(d, 1)  # over the stone's bumps, not into each
            lift = (start - 0.1) * (1.0 - smoothstep(-0.25, 0.62, s)) / 0.86 + 0.004
            return (0.165 * d[0] * r, 0.062 * d[1] * r + 0.038 + lift, 0.135 * d[2] * r)

        def color(s, angle, p, i=i):
            return shade(mix(ROOT, ROOT_TIP, s ** 1.5),
                         1.0 + 0.3 * value_noise(70 * p[0], 70 * p[1], 70 * p[2], 80 + i))

        tube(mesh, path, lambda s: 0.0135 - 0.0035 * s, color, rounded(30, 0.3), 10)


def stipe_path(frond):
    height, azimuth, lean, _, seed = frond
    out = direction(azimuth, 0.0)

    def path(s):
        swing = 2.0 * math.pi * (1.15 * s + 0.13 * seed)
        wind = 0.026 * smoothstep(0.0, 0.6, s)
        reach = 0.010 + lean * s ** 1.3
        return (out[0] * reach + wind * math.sin(swing), 0.085 + (height - 0.085) * s,
                out[2] * reach + wind * (math.cos(1.3 * swing) - 1.0))

    return path


def stipe(mesh, frond):
    def color(s, angle, p):
        streak = value_noise(1.6 * math.cos(angle), 22 * p[1], 1.6 * math.sin(angle), 90)
        return shade(mix(STIPE_LOW, STIPE_HIGH, p[1] / HEIGHT), 1.0 + 0.2 * streak)

    tube(mesh, stipe_path(frond), lambda s: 0.0155 - 0.0055 * s, color, rounded(56, 0.3), 12)


def mid_line(root, azimuth, elevation, droop, length, steps, roll, seed):
    """Points and cross-section frames of a blade: it rises with its bladder, then bends over in an arc while
    it twists."""
    turn = between(-0.09, 0.09, seed, 3)
    line = [root]
    for before, s in zip(steps, steps[1:]):
        middle = 0.5 * (before + s)
        heading = direction(azimuth + turn * middle, elevation - droop * smoothstep(0.12, 1.05, middle))
        line.append(along(line[-1], (heading, length * (s - before))))
    frames = []
    for i, s in enumerate(steps):
        tangent = normalize(sub(line[min(i + 1, len(steps) - 1)], line[max(i - 1, 0)]))
        # in the upright plane of the blade, across it
        flat = normalize(cross(tangent, direction(azimuth + 0.25, 0.0)))
        normal = cross(flat, tangent)
        angle = roll * (1.0 - 0.75 * s) + 0.5 * math.sin(3.6 * s + seed) * smoothstep(0.1, 0.5, s)
        frames.append((add(scale(flat, math.cos(angle)), scale(normal, math.sin(angle))),
                       sub(scale(normal, math.cos(angle)), scale(flat, math.sin(angle)))))
    return line, frames


def blade(mesh, root, azimuth, elevation, droop, length, width, young, seed, bladder=0.0215):
    """One blade from the stipe outward: petiole, bladder, neck and a ruffled, tapering leaf, in a single
    closed skin."""
    steps = rounded(66, 0.35)
    index = {s: i for i, s in enumerate(steps)}
    roll = between(0.35, 0.8, seed, 1) * (1.0 if between(0.0, 1.0, seed, 6) < 0.5 else -1.0)
    line, frames = mid_line(root, azimuth, elevation, droop, length, steps, roll, seed)
    waves, edge_lag = length * between(15.0, 18.5, seed, 2), between(0.25, 0.45, seed, 4)

    # Petiole and bladder keep their size on every blade: lengths in meters over the blade's own.
    a, b, c, d = 0.014 / length, 0.038 / length, 0.062 / length, 0.078 / length
    half_width = ((0.0, 0.0092), (c, 0.0102), (d, 0.0118), (0.42, width), (0.58, 0.93 * width),
                  (0.82, 0.62 * width), (0.94, 0.36 * width), (1.0, 0.24 * width))
    half_thick = ((0.0, 0.0092), (c, 0.0104), (d, 0.0104), (1.0, 0.0096))

    leaf_at = ramp(((0.0, OLD), (0.35, MATURE), (0.72, YOUNG), (1.0, mix(YOUNG, TIP, 0.4))),
                   young + 0.1 * between(-1, 1, seed, 5))

    def section(s):
        center, (side, normal) = line[index[s]], frames[index[s]]
        leafy = smoothstep(c, c + 0.2, s)
        end = dome(s / 0.012) * dome((1.0 - s) / 0.05)
        egg = bladder * math.sqrt(max(0.0, 1.0 - (2.0 * (s - b) / (c - a)) ** 2))
        thick = math.hypot(interpolate(half_thick, s) ** 2, egg ** 2) ** 0.5 * end
        wide = math.hypot(interpolate(half_width, s) ** 2, egg ** 2) ** 0.5 * end
        ruffle = 0.30 * width * leafy * end * (1.0 - 0.6 * smoothstep(0.65, 1.0, s))
        serration = [1.0 + 0.045 * leafy * math.sin(2.0 * math.pi * (2.0 * waves * s + lag))
                     for lag in (0.0, 0.4)]
        lift = [ruffle * math.sin(2.0 * math.pi * (waves * s + lag) + seed) for lag in (0.0, edge_lag)]

        def point(angle):
            u, v = superellipse(angle, 2.0 + 1.2 * leafy)
            k = u > 0
            return along(center, (side, u * wide * serration[k]),
                         (normal, v * thick + lift[k] * abs(u) ** 1.7))

        base = mix(leaf_at, TIP, 0.8 * smoothstep(0.3, 1.0, s) ** 1.6)
        rib = 0.6 * (1.0 - 0.75 * s)
        stalk = smoothstep(0.7 * a, 1.3 * a, s)
        leaf_part = smoothstep(0.95 * c, 1.5 * c, s)

        def color(angle, p):
            u = math.cos(angle)
            leaf = mix(base, TIP, 0.5 * smoothstep(0.70, 1.0, abs(u)))  # light shines through the thin edge
            leaf = mix(leaf, RIB, rib * (1.0 - smoothstep(0.02, 0.24, abs(u))))
            leaf = shade(leaf,
                         1.0 + 0.18 * value_noise(4.0 * u, 24.0 * s, 0.0, seed)
                         + 0.12 * value_noise(9.0 * u, 7.0 * s, 3.0, seed + 7))
            float_color = mix(BLADDER, BLADDER_TOP, smoothstep(-0.6, 0.9, (p[1] - center[1]) / bladder))
            return mix(mix(RIB, float_color, stalk), leaf, leaf_part)

        return point, color

    mesh.skin(steps, 22, section)


def frond_blades(mesh, frond):
    height, azimuth, _, pairs, seed = frond
    path = stipe_path(frond)
    count = 2 * pairs
    low = 0.16 if seed == 1 else 0.30
    for i in range(count):
        t = i / (count - 1)
        root = path(low + (0.955 - low) * t ** 0.95)
        key = 100 * seed + i
        # Two ranks that wind slowly around the stipe: full from every side, open from the front.
        turn = azimuth + 0.5 * (i % 2) + 0.06 * i + between(-0.04, 0.04, key, 11)
        length = interpolate(((0.0, 0.32), (0.4, 0.42), (0.75, 0.37), (1.0, 0.27)),
                             t) * between(0.92, 1.06, key, 12) * (0.78 + 0.2 * height)
        blade(mesh, root, turn, 0.155 + 0.045 * t + between(-0.015, 0.015, key, 13),
              between(0.17, 0.25, key, 15) * (1.0 - 0.5 * t),
              length, length * between(0.092, 0.106, key, 14), root[1] / HEIGHT, key)
    # The growing tip: two young blades that part.
    for k, (turn, lift, size) in enumerate(((azimuth + 0.06, 0.205, 0.25), (azimuth + 0.55, 0.19, 0.20))):
        blade(mesh, path(0.985 - 0.012 * k), turn, lift, 0.06, size * (0.8 + 0.2 * height), 0.021, 1.0,
              100 * seed + 90 + k, 0.0165)


def surfaces():
    rock, plant = Mesh(), Mesh()
    stone(rock)
    holdfast(plant)
    for frond in FRONDS:
        stipe(plant, frond)
        frond_blades(plant, frond)
    return [("stone", 0.9, rock), ("kelp", 0.45, plant)]


def rig():
    """`sway`: the swell rocks it; `current`: it is dragged to and fro, and ripples run up the blades. The
    foot never moves."""
    knots = (0, 0.3, 0.65, 1)
    sway = (travelling_wave(knots, (1, 0, 0.15), (0, 0, 0.16, 0.02), 0.22, 6)
            + travelling_wave(knots, (-0.2, 0, 1), (0, 0, 0.07), 0.30, 3, 0.2)
            + travelling_wave(knots, (1, 0, 0), (0, 0, 0.09, -0.07), 0.55, 2, 0.4))
    current = (travelling_wave(knots, (1, 0, 0.25), (0, 0, 0.26), 0.25, 4)
               + travelling_wave(knots, (-0.25, 0, 1), (0, 0, 0.08, 0.02), 0.45, 2, 0.1)
               + travelling_wave(knots, (1, 0, -0.2), (0, 0, 0.12, -0.08), 0.8, 1, 0.3))
    return dict(make_rig("+y", knots, sway=sway, current=current), sockets={"tip": {"at": 1}})
