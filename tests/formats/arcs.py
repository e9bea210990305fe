#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""The arcs of a swept part, written from formats/SPEC.md, section 4.4.1, alone. It shares no code with kelp.

  arcs.py FILE   each line of FILE is a part: its size, the roll in radians, the number of knots, 7 numbers
                 a knot (at, position, tangent), 3 a point. Prints the points swept, or why it is refused.
"""

import math
import sys

MOST_ARCS = 256
MOST_CURVED = 0.98


class Folds(Exception):
    """No swept part has such a rest pose; the text says why."""


def add(a, b):
    return tuple(x + y for x, y in zip(a, b))


def sub(a, b):
    return tuple(x - y for x, y in zip(a, b))


def mul(a, factor):
    return tuple(x * factor for x in a)


def dot(a, b):
    return sum(x * y for x, y in zip(a, b))


def cross(a, b):
    return (a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0])


def unit(a):
    length = math.sqrt(dot(a, a))
    if not length > 0:
        raise Folds("a direction of no length")
    return mul(a, 1 / length)


class Arc:
    def __init__(self, start, direction, end):
        self.start, self.direction, self.end = start, direction, end
        chord = sub(end, start)
        along, square = dot(chord, direction), dot(chord, chord)
        aside = sub(chord, mul(direction, along))
        height = math.sqrt(dot(aside, aside))
        if not square > 0:
            raise Folds("an arc of no length")
        self.curvature = 2 * height / square
        self.half = math.atan2(height, along)
        self.length = math.sqrt(square) * (self.half / math.sin(self.half) if self.half > 0 else 1)
        self.inward = mul(aside, 1 / height) if height > 0 else (0.0, 0.0, 0.0)  # at the start
        self.end_direction = sub(mul(chord, 2 * along / square), direction)
        size = math.sqrt(square)
        inward = mul(sub(mul(self.inward, along), mul(direction, height)), 1 / size)
        self.middle = sub(add(start, mul(chord, 0.5)), mul(inward, 0.5 * size * math.tan(0.5 * self.half)))
        self.middle_direction = unit(chord)

    def cut(self):
        """Arcs of at most 60 degrees."""
        if 2 * self.half <= math.radians(60):
            return [self]
        first = Arc(self.start, self.direction, self.middle)
        second = Arc(self.middle, self.middle_direction, self.end)
        return first.cut() + second.cut()

    def at(self, length):
        """Place and direction after a length."""
        if self.curvature * self.length < 1e-12:
            return add(self.start, mul(self.direction, length)), self.direction
        angle = self.curvature * length
        place = add(self.start, add(mul(self.direction, math.sin(angle) / self.curvature),
                mul(self.inward, 2 * math.sin(angle / 2) ** 2 / self.curvature)))
        return place, add(mul(self.direction, math.cos(angle)), mul(self.inward, math.sin(angle)))


def biarc(a, out, b, into):
    """Two arcs from a in the direction `out` to b, arriving in the direction `into`."""
    v, both, apart = sub(b, a), add(out, into), sub(out, into)
    forward = dot(v, both)
    if not forward > 0:
        raise Folds("a tangent points away from where the spline goes")
    d = dot(v, v) / (forward + math.sqrt(forward**2 + dot(apart, apart) * dot(v, v)))
    middle = mul(sub(add(a, b), mul(sub(into, out), d)), 0.5)
    first = Arc(a, out, middle)
    return [first, Arc(middle, first.end_direction, b)]


class Sweep:
    def __init__(self, knots, size, roll):
        self.size = size
        scale, middle = size[1], (0.5 * size[0], 0.0, 0.5 * size[2])
        self.spans = []  # (height at its start, its rise, arcs, the axes x, z at the start of each)
        x, z = self.first_section(unit(knots[0][4:7]), roll)
        total = 0
        for a, b in zip(knots, knots[1:]):
            w = (b[0] - a[0]) * scale
            points = [add(mul(k[1:4], scale), middle) for k in (a, b)]
            if not dot(sub(points[1], points[0]), sub(points[1], points[0])) > 0:
                raise Folds("two knots on one point")
            arcs = self.arcs_of(points[0], mul(a[4:7], w), points[1], mul(b[4:7], w), len(knots) - 1)
            sections = []
            for arc in arcs:
                sections.append((x, z))
                self.check(arc, x, z)
                x, z = self.carried(arc, arc.end, x)
            total += len(arcs)
            self.spans.append((a[0] * scale, w, arcs, sections))
        if total > MOST_ARCS:
            raise Folds("too many arcs")

    @staticmethod
    def first_section(to, roll):
        x, z = (math.cos(roll), 0.0, -math.sin(roll)), (math.sin(roll), 0.0, math.cos(roll))
        if to[1] <= -1:
            return tuple(-c for c in x[:2]) + (x[2],), tuple(-c for c in z[:2]) + (z[2],)
        axis = cross((0.0, 1.0, 0.0), to)  # its length is the sine
        turn = lambda v: add(add(mul(v, to[1]), cross(axis, v)), mul(axis, dot(axis, v) / (1 + to[1])))
        return turn(x), turn(z)

    @staticmethod
    def carried(arc, place, x):
        """The section's axes at a place of the arc, from those at its start."""
        c = sub(place, arc.start)
        square = dot(c, c)
        if square > 0:
            x = sub(x, mul(c, 2 * dot(c, x) / square))
            direction = sub(mul(c, 2 * dot(c, arc.direction) / square), arc.direction)
        else:
            direction = arc.direction
        return x, cross(x, direction)

    def arcs_of(self, a, da, b, db, spans):
        def point(t):
            return add(add(mul(a, 2 * t**3 - 3 * t**2 + 1), mul(da, t**3 - 2 * t**2 + t)),
                    add(mul(b, 3 * t**2 - 2 * t**3), mul(db, t**3 - t**2)))

        def direction(t):
            return unit(add(add(mul(a, 6 * t**2 - 6 * t), mul(da, 3 * t**2 - 4 * t + 1)),
                    add(mul(b, 6 * t - 6 * t**2), mul(db, 3 * t**2 - 2 * t))))

        n = 16
        try:
            first, second = biarc(a, unit(da), b, unit(db))
            planes = [mul(cross(arc.direction, arc.inward), arc.curvature) for arc in (first, second)]
            bend = sub(planes[1], planes[0])
            chords = sum(math.dist(arc.start, arc.end) for arc in (first, second))
            error = math.sqrt(dot(bend, bend)) * chords**2 / 48
            error = max([error] + [self.distance(point(t), first, second) for t in (0.25, 0.5, 0.75)])
            slope = sub(mul(sub(b, a), 1.5), mul(add(da, db), 0.25))  # halfway
            n = 1 if dot(slope, sub(b, a)) > 0 else 16
            while n < 16 and n**3 < error / (self.size[1] / 1024):
                n *= 2
        except Folds:
            pass
        n = min(n, 1 << ((MOST_ARCS // 2 // spans).bit_length() - 1))
        if n == 1:
            try:
                whole = Arc(a, unit(da), b)
                if math.dist(whole.end_direction, unit(db)) <= 1e-9:
                    return whole.cut()
            except Folds:
                pass
        arcs = []
        for i in range(n):
            t0, t1 = i / n, (i + 1) / n
            for arc in biarc(point(t0), direction(t0), point(t1), direction(t1)):
                arcs += arc.cut()
        return arcs

    @staticmethod
    def distance(point, first, second):
        """From a point to the circle of the arc on its side of where the two meet."""
        arc = first if dot(sub(point, first.end), second.direction) < 0 else second
        off = sub(point, arc.start)
        if arc.curvature * arc.length < 1e-12:
            return math.dist(mul(arc.direction, dot(off, arc.direction)), off)
        radius = 1 / arc.curvature
        off = sub(off, mul(arc.inward, radius))  # from the center of curvature
        across = dot(off, cross(arc.direction, arc.inward))
        within = math.sqrt(max(dot(off, off) - across**2, 0))
        return math.hypot(within - radius, across)

    def check(self, arc, x, z):
        reach = 0.5 * (abs(dot(arc.inward, x)) * self.size[0] + abs(dot(arc.inward, z)) * self.size[2])
        if arc.curvature * reach > MOST_CURVED:
            raise Folds("folds")

    def point(self, rest):
        for start, rise, arcs, sections in self.spans:
            if rest[1] <= start + rise or arcs is self.spans[-1][2]:
                break
        left = (rest[1] - start) / rise * sum(arc.length for arc in arcs)
        for arc, (x, _) in zip(arcs, sections):
            if left <= arc.length or arc is arcs[-1]:
                break
            left -= arc.length
        place, _ = arc.at(left)
        x, z = self.carried(arc, place, x)
        return add(place, add(mul(x, rest[0] - 0.5 * self.size[0]), mul(z, rest[2] - 0.5 * self.size[2])))


def main():
    with open(sys.argv[1], encoding="utf-8") as file:
        for line in file:
            numbers = [float(word) for word in line.split()]
            take = lambda start, stop, n: [numbers[i : i + n] for i in range(start, stop, n)]
            points = 5 + 7 * int(numbers[4])
            try:
                sweep = Sweep(take(5, points, 7), numbers[:3], numbers[3])
                swept = [sweep.point(point) for point in take(points, len(numbers), 3)]
                print(" ".join("%.9g" % number for point in swept for number in point))
            except Folds as why:
                print("refused:", why)


if __name__ == "__main__":
    main()
