# SPDX-License-Identifier: MIT
"""A reef fish, after the regal angelfish: golden, with white and blue bands; 0.3 m long, swimming along
+x."""

import math

from geometry import Mesh, along, dome, interpolate, normalize, rounded, superellipse
from noise import fractal_noise, mix, ramp, shade, smoothstep, srgb, value_noise
from rig import rig as make_rig
from rig import travelling_wave

GOLD, AMBER, LEMON = srgb("#f6a212"), srgb("#e8720c"), srgb("#ffd84a")
ICE, BLUE, NAVY, INK = srgb("#e4f6ff"), srgb("#2f8df0"), srgb("#12286b"), srgb("#060a18")
BELLY = srgb("#ffeeb8")

NOSE, PEDUNCLE = 0.149, -0.097
TOP = ((0.0, 0.002), (0.03, 0.010), (0.08, 0.019), (0.15, 0.032), (0.27, 0.055), (0.43, 0.070), (0.58, 0.068),
       (0.73, 0.051),
       (0.86, 0.029), (0.94, 0.019), (1.0, 0.0165))
BOTTOM = ((0.0, -0.003), (0.03, -0.010), (0.08, -0.018), (0.15, -0.030), (0.27, -0.049), (0.43, -0.062),
          (0.58, -0.061), (0.73, -0.047),
          (0.86, -0.027), (0.94, -0.0185), (1.0, -0.016))
HALF = ((0.0, 0.003), (0.03, 0.0085), (0.08, 0.0135), (0.15, 0.0195), (0.27, 0.0265), (0.43, 0.0290),
        (0.58, 0.0265), (0.73, 0.0190),
        (0.86, 0.0105), (0.94, 0.0070), (1.0, 0.0055))
EYE = (0.110, 0.0105)


def body_s(x):
    return (NOSE - x) / (NOSE - PEDUNCLE)


def top(x):
    return interpolate(TOP, body_s(x))


def bottom(x):
    return interpolate(BOTTOM, body_s(x))


def bands(x, y):
    """The body's color at x, y: five pale bands between dark lines, bowed like brackets, on gold."""
    base = ramp(((-0.06, BELLY), (-0.03, LEMON), (0.0, GOLD), (0.06, AMBER)),
                y + 0.012 * fractal_noise(30 * x, 30 * y, 0.0, 2, 4))
    for center, bow, reach, width in ((0.083, 2.2, 0.075, 0.0050), (0.046, 3.2, 0.080, 0.0058),
                                      (0.008, 3.8, 0.085, 0.0060),
                                      (-0.029, 4.0, 0.080, 0.0056), (-0.061, 3.6, 0.075, 0.0046),
                                      (-0.086, 2.6, 0.06, 0.0034)):
        d = abs(x - center + bow * (y - 0.004) ** 2 - 0.0018 * value_noise(55 * y, 9 * center, 0.0, 6))
        w = width * (1.0 - 0.55 * smoothstep(0.2, 1.0, abs(y) / reach))
        base = mix(base, NAVY, 1.0 - smoothstep(w + 0.0028, w + 0.0046, d))
        base = mix(base, mix(BLUE, ICE, 1.0 - smoothstep(0.25 * w, 0.95 * w, d)),
                   1.0 - smoothstep(w - 0.0006, w + 0.0010, d))
    return base


def head(base, x, y):
    """Mask, cheek line and lips over the bands' color."""
    face = smoothstep(0.084, 0.094, x - 1.2 * (y - 0.004) ** 2)
    base = mix(base, ramp(((-0.03, BELLY), (0.0, LEMON), (0.03, GOLD)), y), face)
    eye = math.hypot(x - EYE[0], y - EYE[1])
    # A dark bar runs through the eye, edged in blue.
    bar = abs(x - EYE[0] - 0.25 * (y - EYE[1]) + 3.0 * (y - EYE[1]) ** 2)
    reach = smoothstep(-0.036, -0.022, y)
    base = mix(base, BLUE, reach * (1.0 - smoothstep(0.0074, 0.0090, bar)))
    base = mix(base, NAVY, reach * (1.0 - smoothstep(0.0046, 0.0060, bar)))
    base = mix(base, BLUE, (1.0 - smoothstep(0.0150, 0.0165, eye)))
    return base


def scales_at(x, y):
    """0 in the middle of a scale, towards 1 between scales; rows are staggered like bricks."""
    row = round((y + 0.08) / 0.0062)
    return math.hypot(((x / 0.0075 + 0.5 * (row % 2)) % 1.0) - 0.5, 0.8 * ((y + 0.08) / 0.0062 - row))


def body(mesh):
    def section(s):
        x = NOSE + (PEDUNCLE - NOSE) * s
        end = dome(s / 0.02)
        upper, lower, half = interpolate(TOP, s) * end, -interpolate(BOTTOM,
                                                                     s) * end, interpolate(HALF, s) * end
        scaly = 1.0 - smoothstep(0.07, 0.085, x)

        def point(angle):
            c, h = math.cos(angle), math.sin(angle)
            y = (upper if h > 0 else lower) * h
            cheek = 0.0022 * math.exp(-((x - 0.073 - 2.6 * (y + 0.004) ** 2) / 0.006) ** 2) * (
                1.0 - smoothstep(0.024, 0.036, abs(y + 0.004)))
            return (x, y, math.copysign(half * abs(c) ** 0.92 + cheek * abs(c), c))

        def color(angle, p):
            y = p[1]
            light = 1.06 - 0.22 * smoothstep(0.30, 0.62, scales_at(x, y)) * scaly
            return shade(head(bands(x, y), x, y), light * (0.95 + 0.10 * smoothstep(-0.05, 0.06, y)))

        return point, color

    mesh.skin(rounded(230, 0.15), 108, section)


def lips(mesh):
    for lift, size in ((0.0030, 0.0052), (-0.0042, 0.0046)):
        mesh.ball(3, lambda d, lift=lift,
                  size=size: (NOSE - 0.002 + 1.05 * size * d[0], lift + 0.72 * size * d[1],
                              1.25 * size * d[2]),
                  lambda d, p: mix(GOLD, LEMON, 0.5 + 0.5 * d[1]))


def eyes(mesh):
    for side in (1.0, -1.0):
        def point(d, side=side):
            return (EYE[0] + 0.0115 * d[0], EYE[1] + 0.0115 * d[1], side * (0.0160 + 0.0066 * d[2] * side))

        def color(d, p):
            r = math.hypot(d[0], d[1])
            iris = ramp(((0.50, AMBER), (0.62, LEMON), (0.85, GOLD), (0.99, AMBER)), r)
            eye = mix(INK, iris, smoothstep(0.50, 0.56, r))
            glint = math.hypot(d[0] - 0.20, d[1] - 0.26)
            return mix(eye, ICE, 1.0 - smoothstep(0.15, 0.21, glint))

        mesh.ball(5, point, color)


def fin(mesh, base, tip, color, rays, thick=0.0029, count=70, around=48, across=(0.0, 0.0, 1.0)):
    """A fin between the curves base(u) and tip(u): a sheet 2 * thick strong with rounded edges and rays,
    closed in a pole at either end.

    color(u, v, position): v runs from 0 at the base to 1 at the tip.
    """
    def section(u):
        a, b = base(u), tip(u)
        close = dome(u / 0.05) * dome((1.0 - u) / 0.05)
        span = 0.25 + 0.75 * close
        ray = math.cos(2.0 * math.pi * rays * u)
        sheet = thick * close * (1.0 + 0.16 * ray)

        def point(angle):
            w, v = superellipse(angle, 3.0)
            out = 0.5 + 0.5 * w * span
            return along(tuple(p + (q - p) * out for p, q in zip(a, b)),
                         (across, v * sheet * (1.0 - 0.15 * out)))

        def paint(angle, p):
            w, _ = superellipse(angle, 3.0)
            return shade(color(u, 0.5 + 0.5 * w, p), 1.0 + 0.12 * ray)

        return point, paint

    mesh.skin(rounded(count, 0.35), around, section)


def dorsal(mesh):
    def base(u):
        x = 0.070 - 0.150 * u
        return (x, top(x) - 0.007, 0.0)

    def tip(u):
        x, y, _ = base(u)
        rise = interpolate(((0.0, 0.010), (0.12, 0.022), (0.45, 0.032), (0.76, 0.054), (0.90, 0.040),
                            (1.0, 0.014)), u)
        spines = 0.0040 * abs(math.sin(math.pi * 11.0 * u)) * (1.0 - smoothstep(0.5, 0.65, u))
        trail = interpolate(((0.0, 0.004), (0.5, 0.016), (0.8, 0.044), (0.92, 0.048), (1.0, 0.032)), u)
        return (x - trail, y + rise + spines, 0.0)

    def color(u, v, p):
        front = mix(AMBER, GOLD, v)
        speckle = 1.0 - smoothstep(0.10, 0.34,
                                   math.hypot((26.0 * u + 2.0 * v) % 1.0 - 0.5,
                                              0.9 * ((6.0 * v) % 1.0 - 0.5)))
        rear = mix(mix(NAVY, BLUE, 0.45), mix(BLUE, ICE, 0.35), speckle)
        # The blue of the rear begins at a slanting line with a dark rim.
        line = u + 0.45 * v - 0.62
        c = mix(front, NAVY, smoothstep(-0.045, -0.02, line))
        c = mix(c, rear, smoothstep(0.01, 0.04, line))
        c = mix(c, NAVY, smoothstep(0.80, 0.85, v))
        return mix(c, BLUE, smoothstep(0.89, 0.94, v))

    fin(mesh, base, tip, color, 22.0, count=110, around=72)


def anal(mesh):
    def base(u):
        x = 0.018 - 0.100 * u
        return (x, bottom(x) + 0.007, 0.0)

    def tip(u):
        x, y, _ = base(u)
        drop = interpolate(((0.0, 0.010), (0.25, 0.020), (0.65, 0.044), (0.85, 0.038), (1.0, 0.013)), u)
        trail = interpolate(((0.0, 0.004), (0.5, 0.020), (0.8, 0.042), (1.0, 0.030)), u)
        return (x - trail, y - drop, 0.0)

    def color(u, v, p):
        stripe = 0.5 + 0.5 * math.cos(2.0 * math.pi * (3.0 * v - 0.1))
        inside = smoothstep(0.10, 0.2, v)
        c = mix(mix(GOLD, AMBER, v), NAVY, smoothstep(0.34, 0.52, stripe) * inside)
        c = mix(c, mix(BLUE, ICE, 0.25), smoothstep(0.62, 0.85, stripe) * inside)
        c = mix(c, NAVY, smoothstep(0.82, 0.88, v))
        return mix(c, BLUE, smoothstep(0.91, 0.96, v))

    fin(mesh, base, tip, color, 18.0, count=90, around=72)


def tail(mesh):
    def spread(u):
        return 2.0 * u - 1.0

    def base(u):
        return (-0.088, 0.0125 * spread(u), 0.0)

    def tip(u):
        k = spread(u)
        reach = 0.0580 + 0.0085 * abs(k) ** 2.2 - 0.004 * (1
                                                           - abs(k)) + 0.0012 * math.cos(
                                                               2.0 * math.pi * 8.0 * u)
        angle = 0.80 * k
        return (-0.088 - reach * math.cos(0.75 * angle), 0.0125 * k + reach * math.sin(angle), 0.0)

    def color(u, v, p):
        c = ramp(((0.0, AMBER), (0.3, GOLD), (0.75, LEMON), (1.0, BELLY)), v)
        edge = max(smoothstep(0.76, 0.84, abs(spread(u))) * smoothstep(0.15, 0.4, v), 0.0)
        c = mix(c, BLUE, 0.9 * edge)
        c = mix(c, NAVY, smoothstep(0.86, 0.90, v))
        return mix(c, ICE, smoothstep(0.93, 0.97, v))

    fin(mesh, base, tip, color, 13.0, 0.0030, 90)


def paired(mesh):
    """Pectoral fins that stand off the flanks, and long pelvic fins below."""
    for side in (1.0, -1.0):
        def base(u, side=side):
            return (0.052 - 0.003 * u, -0.004 - 0.018 * u, side * 0.0245)

        def tip(u, side=side):
            angle = math.pi * (0.14 - 0.50 * u)
            reach = 0.046 - 0.010 * (2 * u - 1) ** 2
            return (0.052 - reach * math.cos(angle), -0.006 - 0.010 * u + reach * math.sin(angle) * 0.85,
                    side * (0.0245 + 0.024))

        outward = normalize((0.45, 0.0, side * 0.9))
        fin(mesh, base, tip, lambda u, v,
            p: ramp(((0.0, AMBER), (0.25, LEMON), (0.8, BELLY), (1.0, LEMON)), v), 9.0, 0.0028, 50,
            across=outward)

        def root(u, side=side):
            return (0.046 - 0.016 * u, bottom(0.046 - 0.016 * u) + 0.007, side * 0.009)

        def end(u, side=side):
            length = interpolate(((0.0, 0.030), (0.25, 0.058), (0.55, 0.046), (1.0, 0.016)), u)
            x, y, z = root(u)
            return (x - 0.66 * length, y - 0.72 * length, side * (0.009 + 0.10 * length))

        fin(mesh, root, end, lambda u, v, p: ramp(((0.0, GOLD), (0.5, LEMON), (0.8, ICE), (1.0, BLUE)), v),
            6.0, 0.0029, 44)


def surfaces():
    scales, wet = Mesh(), Mesh()
    for part in (body, lips, dorsal, anal, tail, paired):
        part(scales)
    eyes(wet)
    return [("scales", 0.4, scales), ("eyes", 0.15, wet)]


def rig():
    """A wave runs from the head to the tail and grows on its way; the axis runs that way too."""
    knots = (0, 0.35, 0.7, 1)
    swim = travelling_wave(knots, (0, 0, 1), (0.022, -0.045, 0.16), 0.62, 0.9)
    return make_rig("-x", knots, swim=swim)
