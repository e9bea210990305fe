# SPDX-License-Identifier: MIT
"""Closed surfaces: everything a sample model is made of is a skin between two poles or a subdivided
icosahedron."""

import math


def add(a, b):
    return (a[0] + b[0], a[1] + b[1], a[2] + b[2])


def sub(a, b):
    return (a[0] - b[0], a[1] - b[1], a[2] - b[2])


def scale(a, f):
    return (a[0] * f, a[1] * f, a[2] * f)


def dot(a, b):
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


def cross(a, b):
    return (a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0])


def normalize(a):
    return scale(a, 1.0 / math.sqrt(dot(a, a)))


def along(origin, *terms):
    """origin + sum of vector * factor."""
    x, y, z = origin
    for vector, factor in terms:
        x, y, z = x + vector[0] * factor, y + vector[1] * factor, z + vector[2] * factor
    return (x, y, z)


def interpolate(table, x):
    """Smooth curve through ((x, y), ...): cubic Hermite with slopes that never overshoot the data (Fritsch
    and Butland)."""
    def rise(k):
        (x0, y0), (x1, y1) = table[k], table[k + 1]
        return (y1 - y0) / (x1 - x0)

    def slope(k):
        if k == 0 or k == len(table) - 1:
            return rise(min(k, len(table) - 2))
        a, b = rise(k - 1), rise(k)
        return 0.0 if a * b <= 0.0 else 2.0 * a * b / (a + b)

    x = min(max(x, table[0][0]), table[-1][0])
    i = next(i for i in range(len(table) - 1) if x <= table[i + 1][0])
    (x0, y0), (x1, y1) = table[i], table[i + 1]
    h, t = x1 - x0, (x - x0) / (x1 - x0)
    return (y0 * (1 + 2 * t) + slope(i) * h * t) * (1 - t) ** 2 + (y1 * (3 - 2 * t)
                                                                   - slope(i + 1) * h * (1 - t)) * t * t


def superellipse(angle, exponent):
    """Point of the unit superellipse: 2 is the circle, larger is boxier, so that a thin leaf keeps its
    thickness up to the edge."""
    c, s = math.cos(angle), math.sin(angle)
    return (math.copysign(abs(c) ** (2.0 / exponent), c), math.copysign(abs(s) ** (2.0 / exponent), s))


def dome(distance):
    """Height of a quarter circle: 0 at distance 0, 1 from distance 1 on; rounds off an end."""
    return math.sqrt(1.0 - (1.0 - min(max(distance, 0.0), 1.0)) ** 2)


def rounded(count, ends=0.04):
    """count + 1 positions in [0, 1], denser towards both ends, where a skin closes."""
    return [(1.0 - ends) * i / count + ends * 0.5 * (1.0 - math.cos(math.pi * i / count))
            for i in range(count + 1)]


class Mesh:
    """Triangles with one position and one linear color per vertex; vertices are shared, normals are
    smooth. influences: of a mesh that joints move, [(joint, weight), ...] of each vertex."""

    def __init__(self):
        self.positions, self.colors, self.triangles, self.influences = [], [], [], []

    def append(self, positions, colors, triangles):
        """Takes one closed surface in, turned so that it faces outward."""
        volume = sum(dot(positions[a], cross(positions[b], positions[c])) for a, b, c in triangles)
        first = len(self.positions)
        self.positions += positions
        self.colors += colors
        for a, b, c in triangles:
            self.triangles.append((first + a, first + b, first + c) if volume > 0
                                  else (first + a, first + c, first + b))

    def skin(self, steps, around, section):
        """A closed surface of cross sections, one for each of `steps`; it closes in a pole at the first and
        the last of them.

        section(s) -> (point, color); point(angle) -> position; color(angle, position) -> linear color. A
        pole is its section's mean.
        """
        angles = [2.0 * math.pi * j / around for j in range(around)]
        positions, colors, triangles = [], [], []
        for s in (steps[0], steps[-1]):
            point, color = section(s)
            pole = scale(tuple(map(sum, zip(*map(point, angles)))), 1.0 / around)
            positions.append(pole)
            colors.append(color(0.0, pole))
        for s in steps[1:-1]:
            point, color = section(s)
            ring = list(map(point, angles))
            positions += ring
            colors += map(color, angles, ring)
        last = len(steps) - 3
        for j in range(around):
            k = (j + 1) % around
            triangles.append((0, 2 + k, 2 + j))
            triangles.append((1, 2 + last * around + j, 2 + last * around + k))
            for i in range(last):
                a, b = 2 + i * around + j, 2 + i * around + k
                c, d = a + around, b + around
                triangles += ((a, b, d), (a, d, c)) if (i + j) % 2 else ((a, b, c), (b, d, c))
        self.append(positions, colors, triangles)

    def ball(self, subdivisions, point, color):
        """An icosphere: point(direction) -> position, color(direction, position) -> linear color."""
        directions, triangles = icosphere(subdivisions)
        positions = [point(d) for d in directions]
        self.append(positions, [color(d, p) for d, p in zip(directions, positions)], triangles)

    def normals(self):
        """Smooth normals: the sum of the adjoining triangles' area vectors."""
        sums = [(0.0, 0.0, 0.0)] * len(self.positions)
        for a, b, c in self.triangles:
            pa = self.positions[a]
            n = cross(sub(self.positions[b], pa), sub(self.positions[c], pa))
            sums[a], sums[b], sums[c] = add(sums[a], n), add(sums[b], n), add(sums[c], n)
        return [normalize(n) for n in sums]


def icosphere(subdivisions):
    """Unit directions and triangles of an icosahedron whose edges were halved that many times."""
    g = (1.0 + math.sqrt(5.0)) / 2.0
    corners = [(-1, g, 0), (1, g, 0), (-1, -g, 0), (1, -g, 0), (0, -1, g), (0, 1, g),
               (0, -1, -g), (0, 1, -g), (g, 0, -1), (g, 0, 1), (-g, 0, -1), (-g, 0, 1)]
    triangles = [(0, 11, 5), (0, 5, 1), (0, 1, 7), (0, 7, 10), (0, 10, 11), (1, 5, 9), (5, 11, 4),
                 (11, 10, 2), (10, 7, 6), (7, 1, 8),
                 (3, 9, 4), (3, 4, 2), (3, 2, 6), (3, 6, 8), (3, 8, 9), (4, 9, 5), (2, 4, 11), (6, 2, 10),
                 (8, 6, 7), (9, 8, 1)]
    directions = [normalize(c) for c in corners]
    for _ in range(subdivisions):
        middles, finer = {}, []

        def middle(a, b):
            key = (a, b) if a < b else (b, a)
            if key not in middles:
                middles[key] = len(directions)
                directions.append(normalize(add(directions[a], directions[b])))
            return middles[key]

        for a, b, c in triangles:
            ab, bc, ca = middle(a, b), middle(b, c), middle(c, a)
            finer += ((a, ab, ca), (b, bc, ab), (c, ca, bc), (ab, bc, ca))
        triangles = finer
    return directions, triangles
