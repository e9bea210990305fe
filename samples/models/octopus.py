# SPDX-License-Identifier: MIT
"""An octopus, brick red above and cream below, with two rows of suckers under each arm; 0.7 m from tip
to tip, 0.4 m tall.

Body and arms are one closed surface that a skeleton bends: two joints in the mantle, six in each arm. The
arms begin at windows in the body's grid of vertices.
"""

import math

from geometry import Mesh, along, dome, dot, interpolate, normalize, scale
from noise import cell_distance, fractal_noise, mix, smoothstep, srgb
from skeleton import Skeleton, along_chain, then, turn

WINE, BRICK, CORAL, SPOT = srgb("#5a1226"), srgb("#b3372a"), srgb("#ef7d4a"), srgb("#ffd596")
CREAM, ROSE, RIM, CUP = srgb("#f3d3ae"), srgb("#e0977f"), srgb("#fff0dc"), srgb("#a04556")
GOLD, INK, ICE = srgb("#f2c14a"), srgb("#0a0810"), srgb("#f4fbff")

ARMS, JOINTS, LENGTH = 8, 6, 0.33
GROUND = 0.19  # how high the middle of the crown of arms is

# The body from the mouth to the top of the mantle, without windows: radius and height above the crown.
RADIUS = ((0.0, 0.0), (0.06, 0.026), (0.14, 0.056), (0.22, 0.077), (0.30, 0.078), (0.38, 0.068),
          (0.48, 0.063), (0.58, 0.070), (0.70, 0.086), (0.80, 0.088), (0.90, 0.069), (0.96, 0.040),
          (0.985, 0.0185), (1.0, 0.0))
HEIGHT = ((0.0, -0.021), (0.06, -0.023), (0.14, -0.022), (0.22, -0.006), (0.30, 0.022), (0.38, 0.042),
          (0.48, 0.068), (0.58, 0.095), (0.70, 0.135), (0.80, 0.174), (0.90, 0.216), (0.96, 0.238),
          (0.985, 0.2445), (1.0, 0.246))
COLUMNS = 8  # of the body's grid, for each arm; a window is one narrower, and as high as ROWS
ROWS = (0.135, 0.17, 0.205, 0.24, 0.275, 0.31)
RINGS = (0.0, 0.03, 0.06, 0.10, *ROWS, *(0.31 + 0.69 * i / 26 for i in range(1, 27)))
WINDOW = 2 * (COLUMNS - 1 + len(ROWS) - 1)  # vertices around a window, and around an arm
EYE, EYE_SIZE = (0.78, 0.055, 0.626), 0.0235  # direction from the axis, and height

# An arm's radius by its place along the arm; it leaves the body steeply and levels out.
THICK = ((0.0, 0.0275), (0.12, 0.0255), (0.35, 0.0215), (0.7, 0.0140), (1.0, 0.0075))
STEEP, LEVEL = math.radians(-48.0), math.radians(-8.0)
SUCKER = 1.2  # from one sucker to the next in its row, in radii of the arm
MANTLE = (0.085, 0.155)  # heights of the mantle's joints


UP = (0.0, 1.0, 0.0)
STEPS = 200  # of an arm's line


def column_azimuth(j):
    return 2.0 * math.pi * (j + 0.5) / (ARMS * COLUMNS)


def lean(y):
    """The mantle leans back."""
    return -0.088 * smoothstep(0.03, 0.30, y)


def body_point(s, azimuth):
    """Point of the body's skin; +z is to the front."""
    r, y = interpolate(RADIUS, s), interpolate(HEIGHT, s)
    c, z = math.cos(azimuth), math.sin(azimuth)
    near = 0.0
    for side in (1.0, -1.0):
        way = (side * EYE[0] - c) ** 2 + (EYE[2] - z) ** 2 + ((EYE[1] - y) / 0.055) ** 2
        near += math.exp(-way / 0.20)
    r *= 1.0 + 0.16 * near
    wide = 1.0 + 0.06 * smoothstep(0.08, 0.15, y)
    return (wide * r * c, GROUND + y, r * z + lean(y))


def skin_color(p, up, tip=0.0):
    """Mottled above, cream below; up: the height of the normal, tip: from 0 at the body to 1."""
    patch = fractal_noise(24 * p[0], 24 * p[1], 24 * p[2], 2, 451)
    back = mix(BRICK, WINE, smoothstep(-0.15, 0.40, patch))
    back = mix(back, CORAL, max(0.75 * smoothstep(0.05, 0.45, -patch), 0.7 * smoothstep(0.45, 1.0, tip)))
    freckle = cell_distance(55.0 * p[0], 55.0 * p[1], 55.0 * p[2])
    back = mix(back, SPOT, 0.85 * (1.0 - smoothstep(0.20, 0.34, freckle)))
    return mix(back, CREAM, smoothstep(0.30, 0.55, -up + 0.15 * patch))


def window_of(index):
    """The (ring, column) of an arm's window, around it from below on the left."""
    low, left = RINGS.index(ROWS[0]), index * COLUMNS
    high, right = low + len(ROWS) - 1, left + COLUMNS - 1
    return ([(low, j) for j in range(left, right)] + [(i, right) for i in range(low, high)]
            + [(high, j) for j in range(right, left, -1)] + [(i, left) for i in range(high, low, -1)])


class Arm:
    """One of the arms: its window, and its line, from the middle of the window outward."""

    def __init__(self, index):
        azimuth = 2.0 * math.pi * (index + 0.5) / ARMS
        self.out = (math.cos(azimuth), 0.0, math.sin(azimuth))
        self.across = (-self.out[2], 0.0, self.out[0])  # a positive turn about it raises the arm
        self.window = window_of(index)
        self.corners = [body_point(RINGS[i], column_azimuth(j)) for i, j in self.window]
        self.line = [scale(tuple(map(sum, zip(*self.corners))), 1.0 / WINDOW)]
        for step in range(STEPS):
            rise = self.rise((step + 0.5) / STEPS)
            self.line.append(along(self.line[-1], (self.out, LENGTH / STEPS * math.cos(rise)),
                                   (UP, LENGTH / STEPS * math.sin(rise))))

    def rise(self, u):
        return STEEP + (LEVEL - STEEP) * u

    def upward(self, u):
        rise = self.rise(u)
        return along((0.0, 0.0, 0.0), (self.out, -math.sin(rise)), (UP, math.cos(rise)))

    def place(self, u):
        step = min(int(STEPS * u), STEPS - 1)
        return mix(self.line[step], self.line[step + 1], STEPS * u - step)


def rings_of_arm():
    """(u, distance from the body in radii) of each ring: four for each sucker of a row."""
    rings, u, far = [], 0.0, 0.0
    while u < 0.985:
        far += SUCKER / 4.0
        u += SUCKER / 4.0 * interpolate(THICK, u) / LENGTH
        rings.append((min(u, 0.985), far))
    return rings + [(0.996, far)]


def sucker(far, angle):
    """How near the middle of a sucker is: 0 in the middle, 1 at its rim. angle: from straight below."""
    nearest = 9.0
    for row in (1.0, -1.0):
        place = far / SUCKER + (0.25 if row > 0.0 else -0.25)
        nearest = min(nearest, math.hypot(SUCKER * (place - math.floor(place) - 0.5), angle - 0.62 * row))
    return nearest / 0.44


def arm_ring(arm, u, far):
    """Positions and colors of a ring; the first ones pass from the window's shape to a round section."""
    center, up = arm.place(u), arm.upward(u)
    thick = interpolate(THICK, u) * dome((1.0 - u) / 0.03)
    shaped = smoothstep(0.0, 0.14, u)
    positions, colors = [], []
    for k, corner in enumerate(arm.corners):
        angle = 2.0 * math.pi * (k - 0.5 * (COLUMNS - 1)) / WINDOW  # from straight below
        side, high = math.sin(angle), -math.cos(angle)
        cup = sucker(far, math.remainder(angle, 2.0 * math.pi))
        grown = smoothstep(0.06, 0.16, u) * (1.0 - smoothstep(0.93, 0.97, u))
        bump = 0.20 * grown * (1.0 - smoothstep(0.75, 1.15, cup)) * (0.4 + 0.6 * smoothstep(0.2, 0.7, cup))
        round_point = along(center, (arm.across, thick * side * (1.0 + bump)),
                            (up, thick * high * (0.92 + bump)))
        kept = tuple(p + q - o for p, q, o in zip(corner, center, arm.line[0]))
        point = mix(kept, round_point, shaped)
        below = mix(mix(CREAM, ROSE, 0.6 * smoothstep(1.1, 1.4, cup)), RIM, 1.0 - smoothstep(0.9, 1.15, cup))
        below = mix(below, CUP, 1.0 - smoothstep(0.25, 0.6, cup))
        color = skin_color(point, high, u)
        positions.append(point)
        colors.append(mix(color, below, grown * smoothstep(0.30, 0.50, -high)))
    return positions, colors


def grow_arm(shape, arm, window, root, chain):
    """Adds the arm to the surface: rings from the window's vertices to the tip."""
    positions, colors, triangles, influences = shape
    before = window
    for u, far in rings_of_arm():
        ring, paint = arm_ring(arm, u, far)
        first = len(positions)
        positions += ring
        colors += paint
        influences += [along_chain(root, chain, JOINTS * u - 0.5)] * WINDOW
        for k in range(WINDOW):
            a, b, c, d = before[k], before[(k + 1) % WINDOW], first + k, first + (k + 1) % WINDOW
            triangles += ((a, d, b), (a, c, d)) if k % 2 else ((a, c, b), (b, c, d))
        before = range(first, first + WINDOW)
    positions.append(arm.place(1.0))
    colors.append(paint[0])
    influences.append(along_chain(root, chain, JOINTS))
    triangles += [(before[(k + 1) % WINDOW], before[k], len(positions) - 1) for k in range(WINDOW)]


def mantle_weights(p, root, mantle):
    return along_chain(root, mantle, (p[1] - GROUND - MANTLE[0]) / (MANTLE[1] - MANTLE[0]))


def body_color(p, s):
    c = skin_color(p, 12.0 * (s - 0.17))
    for side in (1.0, -1.0):
        way = math.dist(p, eye_center(side)) / EYE_SIZE
        c = mix(c, WINE, 0.8 * (1.0 - smoothstep(1.05, 1.5, way)))
    return c


def eye_center(side):
    r = 0.064
    return (side * EYE[0] * r, GROUND + EYE[1], EYE[2] * r + lean(EYE[1]))


def skin(arms, root, mantle, chains):
    """The closed surface of body and arms."""
    around, vertices = ARMS * COLUMNS, {}
    positions, colors, triangles, influences = shape = ([], [], [], [])

    def at(ring, column):
        """The vertex there, which is made when it is first asked for: there are none inside of windows."""
        column = 0 if ring in (0, len(RINGS) - 1) else column % around
        if (ring, column) not in vertices:
            p = body_point(RINGS[ring], column_azimuth(column))
            vertices[ring, column] = len(positions)
            positions.append(p)
            colors.append(body_color(p, RINGS[ring]))
            influences.append(mantle_weights(p, root, mantle))
        return vertices[ring, column]

    low, last = RINGS.index(ROWS[0]), len(RINGS) - 2
    for j in range(around):
        triangles += [(at(0, 0), at(1, j), at(1, j + 1)),
                      (at(last + 1, 0), at(last, j + 1), at(last, j))]
        for i in range(1, last):
            if low <= i < low + len(ROWS) - 1 and j % COLUMNS != COLUMNS - 1:
                continue  # a window
            a, b, c, d = at(i, j), at(i, j + 1), at(i + 1, j), at(i + 1, j + 1)
            triangles += ((a, d, b), (a, c, d)) if (i + j) % 2 else ((a, c, b), (b, c, d))
    for arm, chain in zip(arms, chains):
        grow_arm(shape, arm, [at(i, j) for i, j in arm.window], root, chain)
    mesh = Mesh()
    mesh.append(positions, colors, triangles)
    mesh.influences = influences
    return mesh


def eyes(root):
    """Golden, with slit pupils, wholly moved by the body."""
    mesh = Mesh()
    for side in (1.0, -1.0):
        center = eye_center(side)
        ahead = normalize((side * EYE[0], 0.10, EYE[2]))
        along_slit = normalize((-ahead[2], 0.0, ahead[0]))

        def point(d, center=center):
            return along(center, (d, EYE_SIZE))

        def color(d, p, ahead=ahead, along_slit=along_slit):
            x, y, front = dot(d, along_slit), d[1] - 0.10, dot(d, ahead)
            pupil = math.hypot(x / 0.62, y / 0.28)
            c = mix(INK, GOLD, smoothstep(0.9, 1.15, pupil))
            c = mix(c, ICE, 1.0 - smoothstep(0.16, 0.24, math.hypot(x - 0.25, y - 0.38)))
            return mix(BRICK, c, smoothstep(0.1, 0.3, front))

        mesh.ball(4, point, color)
    mesh.influences = [[(root, 1.0)]] * len(mesh.positions)
    return mesh


def joints(arms):
    """The skeleton at rest, and its joints: the body's, the mantle's, those of each arm."""
    skeleton = Skeleton()
    root = skeleton.add("body", None, (0.0, GROUND, 0.0))
    mantle, chains = [], []
    for number, y in enumerate(MANTLE):
        mantle.append(skeleton.add("mantle.%d" % number, mantle[-1] if mantle else root,
                                   (0.0, GROUND + y, lean(y))))
    for index, arm in enumerate(arms):
        chain = []
        for number in range(JOINTS):
            chain.append(skeleton.add("arm.%d.%d" % (index, number), chain[-1] if chain else root,
                                      arm.place((number + 0.5) / JOINTS)))
        chains.append(chain)
    return skeleton, (root, mantle, chains)


def bent(arms, chains, raised, sideways):
    """Rotations of the arms' joints. raised(arm, u): by how much the arm is raised there, in radians;
    sideways(arm, u): by how much it is turned about the vertical."""
    moves = {}
    for index, (arm, chain) in enumerate(zip(arms, chains)):
        before = (0.0, 0.0)
        for number, joint in enumerate(chain):
            now = tuple(way(index, (number + 1) / JOINTS) for way in (raised, sideways))
            up, aside = (angle - last for angle, last in zip(now, before))
            moves[joint, "rotation"] = then(turn(UP, aside), turn(arm.across, up))
            before = now
    return moves


def wave(moment):
    return math.sin(2.0 * math.pi * moment)


def swim(arms, root, mantle, chains):
    """pose(moment): the arms open slowly and close fast, the tips last; each stroke lifts the body."""
    def pose(moment):
        def raised(index, u):
            late = moment - 0.34 * u
            stroke = wave(late + 0.10 * wave(late))
            return math.radians(-8.0 + 32.0 * stroke * (1.0 + 1.2 * u) - 8.0 * u)

        squeeze = wave(moment - 0.28)
        moves = bent(arms, chains, raised, lambda index, u: 0.0)
        moves[root, "translation"] = (0.0, 0.035 * wave(moment - 0.45), 0.0)
        moves[root, "rotation"] = turn((1.0, 0.0, 0.0), math.radians(4.0 * wave(moment - 0.1)))
        moves[mantle[0], "translation"] = (0.0, 0.006 * squeeze, 0.0)
        moves[mantle[0], "rotation"] = turn((1.0, 0.0, 0.0), math.radians(5.0 * wave(moment - 0.2)))
        moves[mantle[1], "translation"] = (0.0, 0.006 * squeeze, 0.0)
        moves[mantle[1], "rotation"] = turn((1.0, 0.0, 0.0), math.radians(8.0 * wave(moment - 0.3)))
        return moves

    return pose


def idle(arms, root, mantle, chains):
    """pose(moment): one arm after another rolls up and unrolls, the others wave a little."""
    def pose(moment):
        def raised(index, u):
            mine = moment + 3.0 * index / ARMS
            roll = max(0.0, wave(mine)) ** 1.4
            ripple = u * wave(2.0 * mine - 0.5 * u)
            return math.radians(270.0 * roll * u ** 1.7 - 12.0 * (1.0 - roll) * ripple)

        def sideways(index, u):
            return math.radians(26.0) * u * wave(moment + 0.37 * index - 0.35 * u)

        moves = bent(arms, chains, raised, sideways)
        breath = wave(2.0 * moment)
        moves[root, "translation"] = (0.0, 0.004 * breath, 0.0)
        moves[mantle[0], "rotation"] = turn((0.0, 0.0, 1.0), math.radians(4.0 * wave(moment)))
        moves[mantle[1], "translation"] = (0.0, 0.004 * breath, 0.0)
        moves[mantle[1], "rotation"] = turn((1.0, 0.0, 0.0), math.radians(6.0 * breath))
        return moves

    return pose


ALL_ARMS = [Arm(index) for index in range(ARMS)]


def surfaces():
    _, parts = joints(ALL_ARMS)
    return [("skin", 0.4, skin(ALL_ARMS, *parts)), ("eyes", 0.15, eyes(parts[0]))]


def skeleton():
    """`swim`: strokes of all arms, 2.4 s. `idle`: the arms roll up in turn, 8 s."""
    bones, parts = joints(ALL_ARMS)
    bones.clip("swim", 2.4, 24, swim(ALL_ARMS, *parts))
    bones.clip("idle", 8.0, 48, idle(ALL_ARMS, *parts))
    return bones
