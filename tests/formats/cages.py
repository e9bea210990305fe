# SPDX-License-Identifier: MIT
"""Cages, written from formats/SPEC.md, section 4.9, alone: cells, nodes, neighbors and boundary faces of what
the table holds. It shares no code with kelp."""

import collections
import itertools

OUTSIDE, INSIDE = 0xFFFFFFFF, 0xFFFFFFFE
FULL = 255


class WrongCage(Exception):
    """The table breaks a rule; the text says which."""


def must(condition, why):
    if not condition:
        raise WrongCage(why)


class Cage:
    def __init__(self, cell, level, levels, size):
        self.side = side = cell if level == 0 else max(cell, 4) * 2**level
        self.level, self.last = level, min(level + 1, levels - 1)
        self.grid = [(n + side - 1) // side for n in size]
        must(max(self.grid) <= 256, "more than 256 cubes along an axis")
        self.cubes = self.grid[0] * self.grid[1] * self.grid[2]
        self.voxels = side >> level  # along an edge of a mask
        self.follows = ()
        self.influences = []  # of each node: part, weight, part, weight, ...
        self.morphs = []  # part, [(node, offset), ...]

    def block(self, place):
        """Of a cube; None beyond the lattice."""
        if any(not 0 <= p < g for p, g in zip(place, self.grid)):
            return None
        return self.blocks[place[0] + self.grid[0] * (place[1] + self.grid[1] * place[2])]

    def take_blocks(self, blocks):
        self.blocks = blocks
        places = [(i % self.grid[0], i // self.grid[0] % self.grid[1], i // self.grid[0] // self.grid[1])
                for i in range(self.cubes)]
        code = lambda place: sum((p >> bit & 1) << 3 * bit + axis for axis, p in enumerate(place)
                for bit in range(8))
        self.cells = []  # (place, number of pieces in its cube)
        for place in sorted(places, key=code):
            block = self.block(place)
            if block != FULL:
                self.cells += [(place, block)] * block
                continue
            for step in itertools.product((-1, 0, 1), repeat=3):
                must(self.block([p + s for p, s in zip(place, step)]), "an inside that is not wrapped")
        must(1 <= len(self.cells) < 1 << 27, "number of cells")
        self.masked = sum(pieces > 1 for _, pieces in self.cells)

    def mask_bytes(self):
        return self.masked * self.voxels**3 // 8

    def take_masks(self, data):
        self.masks = []
        each = self.voxels**3 // 8
        for i in range(self.masked):
            finest = int.from_bytes(data[each * i : each * (i + 1)], "little")
            must(finest, "a piece without voxels")
            for shift in range(self.last - self.level + 1):
                side, mask = self.voxels >> shift, 0
                for bit in range(self.voxels**3):
                    if finest >> bit & 1:
                        x, y, z = bit % self.voxels, bit // self.voxels % self.voxels, bit // self.voxels**2
                        mask |= 1 << (x >> shift) + side * ((y >> shift) + side * (z >> shift))
                self.masks += [mask >> 32 * word & 0xFFFFFFFF for word in range(max(side**3 // 32, 1))]

    def take_splits(self, points, numbers):
        corners = {}
        for cell, (place, _) in enumerate(self.cells):
            for corner in range(8):
                p = [place[axis] + (corner >> axis & 1) for axis in range(3)]
                number = p[0] + (self.grid[0] + 1) * (p[1] + (self.grid[1] + 1) * p[2])
                corners.setdefault(number, []).append((cell, corner, p))
        must(all(a < b for a, b in zip(points, points[1:])), "split points do not ascend")
        must(all(point in corners for point in points), "a split point is no corner")
        must(sum(len(corners[point]) for point in points) == len(numbers), "number of split numbers")
        self.corner_nodes = [[None] * 8 for _ in self.cells]
        self.places = []
        splits, numbers = set(points), list(numbers)
        for point in sorted(corners):
            here = corners[point]
            own = [0] * len(here)
            if point in splits:
                own, numbers = numbers[: len(here)], numbers[len(here) :]
                for i, number in enumerate(own):
                    must(number <= max(own[:i], default=-1) + 1, "split numbers in another order")
                must(max(own) >= 1, "a split point of one node")
            for (cell, corner, _), number in zip(here, own):
                self.corner_nodes[cell][corner] = len(self.places) + number
            self.places += [[self.side * v for v in here[0][2]]] * (max(own) + 1)

    def join(self):
        """What is beyond the six faces of each cell, and the boundary faces of tetrahedra."""
        quads = {}
        for cell, nodes in enumerate(self.corner_nodes):
            for face in range(6):
                quads.setdefault(self.quad(nodes, face), []).append(cell)
        self.beyond, self.faces = [], []
        for cell, (place, _) in enumerate(self.cells):
            beyond = []
            for face in range(6):
                to = list(place)
                to[face // 2] += 1 if face % 2 else -1
                sharing = quads[self.quad(self.corner_nodes[cell], face)]
                if self.block(to) == FULL:
                    beyond.append(INSIDE)
                elif len(sharing) == 2:
                    beyond.append(sharing[0] + sharing[1] - cell)
                else:
                    beyond.append(OUTSIDE)
            self.beyond.append(beyond)
            for tetrahedron, (a, _, c) in enumerate(itertools.permutations(range(3))):
                if beyond[2 * a + 1] == OUTSIDE:
                    self.faces.append(cell << 5 | tetrahedron << 2)
                if beyond[2 * c] == OUTSIDE:
                    self.faces.append(cell << 5 | tetrahedron << 2 | 3)

    def follow(self, finer, named):
        """Which finer cell each node follows. named: those that the table names."""
        ratio = self.side // finer.side
        holds = {tuple(place): [] for place, _ in self.cells}  # the finer cells in a cube
        for number, (place, _) in enumerate(finer.cells):
            cube = tuple(p // ratio for p in place)
            if cube in holds:
                holds[cube].append((number, place))
        nodes_at = collections.defaultdict(set)  # of each corner of each cube
        for (cube, _), nodes in zip(self.cells, self.corner_nodes):
            for corner, node in enumerate(nodes):
                nodes_at[tuple(cube), corner].add(node)
        cubes = [set() for _ in self.places]
        shared = [False] * len(self.places)
        for (cube, _), nodes in nodes_at.items():
            for node in nodes:
                cubes[node].add(cube)
                shared[node] = shared[node] or len(nodes) > 1
        named, self.follows = list(named), []
        for node, place in enumerate(self.places):
            point = [p // self.side for p in place]
            near = []
            for number, low in itertools.chain.from_iterable(holds[cube] for cube in cubes[node]):
                off = [max(l - ratio * p, ratio * p - l - 1, 0) for p, l in zip(point, low)]
                near.append((sum(d * d for d in off), number))
            if near and not shared[node]:
                self.follows.append(min(near)[1])
            else:
                must(named, "too few followed cells")
                self.follows.append(named.pop(0))
                must(self.follows[-1] >= 0, "a followed cell")
        must(not named, "too many followed cells")
        must(max(self.follows) < len(finer.cells), "a followed cell")
        for node, (cell, place) in enumerate(zip(self.follows, self.places)):
            off = [p // finer.side - low for p, low in zip(place, finer.cells[cell][0])]
            corner = sum(min(max(o, 0), 1) << axis for axis, o in enumerate(off))
            at = finer.corner_nodes[cell][corner]
            self.follows[node] = at if set(off) <= {0, 1} else 1 << 31 | cell
            if finer.influences:
                self.influences.append(finer.influences[at])

    @staticmethod
    def quad(nodes, face):
        return tuple(node for corner, node in enumerate(nodes) if corner >> face // 2 & 1 == face % 2)
