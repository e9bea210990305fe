# SPDX-License-Identifier: MIT
"""Pages of voxels of .kelp packs, written from formats/SPEC.md 5.3 alone, for read_pack.py."""

import collections


class Refused(Exception):
    """The pack breaks the specification; the text says where and how."""


def need(condition, why):
    if not condition:
        raise Refused(why)


AROUND = [(x, y, z) for z in (-1, 0, 1) for y in (-1, 0, 1) for x in (-1, 0, 1) if x or y or z]
# Section 5.3.2, in the order of AROUND: dx fastest, then dy, then dz.
WEIGHTS = [-4, 1, -10, 2, 10, 2, 3, 7, -2,
        4, 18, 7, 18, 4, 4, 4, 10,
        -2, 7, 3, 6, 10, 2, 2, 9, 7]
FIRST_P = [235, 495, 1037, 2158, 4429, 8849, 16889, 30001, 35535, 48647, 56687, 61107, 63378, 64499, 65041,
        65301]
EMPTY, SOLID = -1, 1  # what is known of a voxel; 0: nothing
MIDDLE = 2047 | 2047 << 12  # the normal before the first


class Bits:
    """The coded and the plain bits of a page (section 5.3.1). A model is a list of p and s."""

    def __init__(self, plain, coded, limit):
        self.plain, self.plain_at = plain, 0
        self.coded, self.at, self.limit = coded + bytes(4), 6, limit
        need(len(self.coded) >= 6, "coded bits are missing")
        self.range, self.code = (1 << 48) - 1, int.from_bytes(self.coded[:6], "big")
        need(self.code < self.range, "coded bits that no range begins with")

    def decide(self, model):
        p, s = model
        ones = (self.range >> 16) * p
        decision = int(self.code < ones)
        if decision:
            self.range = ones
            model[0] = p + (65536 - p >> s)
        else:
            self.range -= ones
            self.code -= ones
            model[0] = p - (p >> s)
        if s < self.limit:
            model[1] = s + 1
        if self.range < 1 << 32:
            at = self.at
            need(at < len(self.coded), "coded bits are missing")
            self.range <<= 16
            self.code = self.code << 16 | self.coded[at] << 8 | self.coded[at + 1]
            self.at = at + 2
        return decision

    def tree(self, models, name, size):
        place = 1
        for _ in range(size):
            place = 2 * place + self.decide(models[name + (place,)])
        return place - (1 << size)

    def number(self, size):
        """A number of that many plain bits, 16 at most."""
        at = self.plain_at
        self.plain_at += size
        need(self.plain_at <= 8 * len(self.plain), "plain bits are missing")
        three = int.from_bytes(self.plain[at // 8 : at // 8 + 3], "little")
        return three >> at % 8 & (1 << size) - 1

    def end(self):
        need(self.at == len(self.coded) and self.code < 1 << 32, "coded bits are left")
        left = 8 * len(self.plain) - self.plain_at
        need(left < 8 and self.number(left) == 0, "plain bits are left")


class Attribute:
    """Of a voxel that comes before."""

    def __init__(self, normal, new, index):
        self.normal, self.new, self.index = normal, new, index


class Page:
    """positions: of its bricks; size: of the level, in voxels; coarser: answers the 512 codes of a brick of
    the next coarser level, None if there is none; palette: number of its entries; raw: the page's raw size.
    Reads `codes` and `attributes`.

    A voxel (x, y, z) has the key x + 1 + (y + 1) * row + (z + 1) * layer, so that those beside the grid have
    keys too."""

    def __init__(self, data, positions, size, coarser, palette, raw):
        need(raw >= 512 * len(positions) and raw % 4 == 0, "raw size of a page")
        self.positions, self.size, self.coarser, self.palette = positions, size, coarser, palette
        self.surface = (raw - 512 * len(positions)) // 4
        self.read_header(data)
        self.grid = [(side + 7) // 8 for side in size]
        self.row = 8 * self.grid[0] + 2
        self.layer = self.row * (8 * self.grid[1] + 2)
        self.around = [x + y * self.row + z * self.layer for x, y, z in AROUND]
        self.keys = [[self.key_of(8 * p[0] + i % 8, 8 * p[1] + i // 8 % 8, 8 * p[2] + i // 64)
                for i in range(512)] for p in positions]
        self.codes = bytearray(512 * len(positions))
        self.state = {}  # what is known of the voxels, by key
        self.inner = set()  # keys of voxels whose block is solid and not surface
        self.know_from_the_start()
        self.find_solid()
        self.find_surface()
        self.read_attributes()
        self.bits.end()

    def key_of(self, x, y, z):
        return x + 1 + (y + 1) * self.row + (z + 1) * self.layer

    def read_header(self, data):
        need(len(data) >= 3, "a page is too short")
        need(data[0] & 8 == 0, "reserved bit of a page")
        self.exact = bool(data[0] & 4)
        self.dropped = data[0] >> 4
        need(self.dropped <= 11, "d of a page")
        plain = int.from_bytes(data[1:3], "little")
        self.low, at = 0, 3
        if self.dropped:
            need(len(data) >= 6, "a page is too short")
            self.low, at = int.from_bytes(data[3:6], "little"), 6
            may = (1 << self.dropped) - 1
            need(self.low & ~(may | may << 12) == 0, "normal of a page's header")
        need(at + plain <= len(data) and (len(data) - at - plain) % 2 == 0, "plain bytes of a page")
        self.bits = Bits(data[at : at + plain], data[at + plain :], 3 + (data[0] & 3))

    # Section 5.3.2
    def know_from_the_start(self):
        for position, keys in zip(self.positions, self.keys):
            blocks = self.coarser([p // 2 for p in position]) if self.coarser else None
            first = [p % 2 * 4 for p in position]
            room = [side - 8 * p for side, p in zip(self.size, position)]
            for i, key in enumerate(keys):
                x, y, z = i % 8, i // 8 % 8, i // 64
                if x >= room[0] or y >= room[1] or z >= room[2]:
                    self.state[key] = EMPTY
                elif blocks:
                    block = blocks[first[0] + x // 2 + 8 * (first[1] + y // 2) + 64 * (first[2] + z // 2)]
                    if block == 0:
                        self.state[key] = EMPTY
                    elif block == 128:
                        self.state[key] = SOLID
                        self.inner.add(key)
            self.know_outside(position)

    def know_outside(self, position):
        """Places outside the grid, beside a brick."""
        sides = [range(8 * p - 1, 8 * p + 9) for p in position]
        for axis in range(3):
            outside = [v for v in sides[axis] if v < 0 or v >= 8 * self.grid[axis]]
            if outside:
                x, y, z = sides[:axis] + [outside] + sides[axis + 1 :]
                self.state.update((self.key_of(i, j, k), EMPTY) for k in z for j in y for i in x)

    def find_solid(self):
        models = [[p, 4] for _ in range(8) for p in FIRST_P]
        weights = list(zip(self.around, WEIGHTS))
        rest_of_block = [o for o, place in zip(self.around, AROUND) if max(place) <= 0]
        state, get, decide = self.state, self.state.get, self.bits.decide
        for keys in self.keys:
            for i, key in enumerate(keys):
                if key in state:
                    continue
                odd = (i & 1) + (i >> 2 & 2) + (i >> 4 & 4)
                if odd == 7 and self.coarser and all(state[key + other] == EMPTY for other in rest_of_block):
                    state[key] = SOLID
                    continue
                w = 11
                for other, weight in weights:
                    w += weight * get(key + other, 0)
                model = models[16 * odd + min(max((w + 64) // 8, 0), 15)]
                state[key] = SOLID if decide(model) else EMPTY

    # Section 5.3.3
    def find_surface(self):
        models = [[32768, 1] for _ in range(14)]
        state, around = self.state, self.around
        total = 0
        for brick, keys in enumerate(self.keys):
            before = total
            for i, key in enumerate(keys):
                if state[key] == EMPTY:
                    continue
                known = [state.get(key + other, 0) for other in around]
                if key in self.inner:
                    code = 128
                elif EMPTY in known:
                    code = 64
                elif self.exact and 0 not in known:
                    code = 128
                else:
                    model = models[7 * (0 in known) + self.surface_beside(brick, i)]
                    code = 64 if self.bits.decide(model) else 128
                self.codes[512 * brick + i] = code
                total += code == 64
            need(total > before, "brick without surface voxel")
            need(total <= self.surface, "surface voxels of a page")
        need(total == self.surface, "surface voxels of a page")

    def surface_beside(self, brick, i):
        count = 0
        for step, along in ((1, i & 7), (8, i >> 3 & 7), (64, i >> 6)):
            if along > 0:
                count += self.codes[512 * brick + i - step] == 64
            if along < 7:
                key = self.keys[brick][i + step]
                count += self.state[key] == SOLID and any(
                        self.state.get(key + other) == EMPTY for other in self.around)
        return count

    # Sections 5.3.4 to 5.3.6
    def read_attributes(self):
        self.models = collections.defaultdict(lambda: [32768, 1])
        self.news = [0] * 16
        self.last = Attribute(MIDDLE, False, 0)
        self.attributes = []
        # The greater dz first, then dy, then dx: AROUND, backwards.
        touching = [(offset, 3 - sum(map(abs, place))) for offset, place in zip(self.around, AROUND)][::-1]
        touching = [(offset, votes) for offset, votes in touching if votes]
        before = {}
        for brick, keys in enumerate(self.keys):
            for i, key in enumerate(keys):
                if self.codes[512 * brick + i] != 64:
                    continue
                found = [(before[key + offset], votes) for offset, votes in touching
                        if key + offset in before]
                found = [(a, 2 * votes if a.new else votes) for a, votes in found]
                normal, new = self.read_normal(found)
                if new:
                    self.news.append(normal)
                self.last = before[key] = Attribute(normal, new, self.read_index(found, normal))
                self.attributes.append(normal << 8 | self.last.index)

    @staticmethod
    def ballot(values):
        """Values and their shares, of values and their votes."""
        votes = collections.Counter()
        for value, more in values:
            votes[value] += more
        order = list(votes)
        for place in range(min(2, len(order))):
            most = max(range(place, len(order)), key=lambda i: votes[order[i]])
            order[place], order[most] = order[most], order[place]
        whole = sum(votes.values()) + 1
        return [(value, 8 * votes[value] // whole) for value in order]

    def read_normal(self, found):
        """The normal, and if it is new."""
        models, decide = self.models, self.bits.decide
        n, fresh = len(found), sum(a.new for a, _ in found)
        k = 0 if fresh == 0 else 1 if 4 * fresh <= n else 2 if 2 * fresh <= n else 3 if fresh < n else 4
        ballot = self.ballot((a.normal, votes) for a, votes in found)
        told = False  # that it is not new
        if len(ballot) <= 1:
            if decide(models["A", k, min(n, 7)]):
                return (ballot[0][0] if ballot else self.last.normal), False
            ballot = []
        else:
            if k == 4:
                if not decide(models["D", 5]):
                    return self.read_new_normal(found), True
                told = True
            first = "B" if found[0][0].normal == ballot[0][0] else "A"
            if decide(models[first, k, 8 + ballot[0][1]]):
                return ballot[0][0], False
            if decide(models["C", k, ballot[1][1] + 4 * min(len(ballot), 5) - 8]):
                return ballot[1][0], False
        if not told and not decide(models["D", k]):
            return self.read_new_normal(found), True
        for i, (normal, _) in enumerate(ballot[2:]):
            if decide(models["E", min(i, 3)]):
                return normal, False
        return self.news[-1 - self.bits.tree(models, ("F",), 4)], False

    def read_new_normal(self, found):
        normal, size = self.low, 0
        whole = sum(votes for _, votes in found)
        for axis in (0, 1):
            value_of = lambda normal: (normal >> 12 * axis & 4095) >> self.dropped
            if found:
                values = [value_of(a.normal) for a, _ in found]
                scale = -(-(1 << 20) // whole)
                guess = sum(v * votes for v, (_, votes) in zip(values, found)) * scale + (1 << 19) >> 20
                spread = 14 if len(found) == 1 else (max(values) - min(values)).bit_length()
            else:
                guess, spread = value_of(self.last.normal), 15
            size = self.bits.tree(self.models, ("N", axis, size // 2, spread), 4)
            difference = 0
            if size:
                plain = self.bits.number(size)
                difference = plain & (1 << size - 1) - 1 | 1 << size - 1
                if plain >> size - 1:
                    difference = -difference
            value = (guess + difference) % (1 << 12 - self.dropped)
            normal |= value << self.dropped + 12 * axis
        return normal

    def read_index(self, found, normal):
        if self.palette == 1:
            return 0
        values = [(a.index, 4 * votes if a.normal == normal else votes) for a, votes in found]
        ballot = self.ballot(values or [(self.last.index, 0)])
        for i, (index, share) in enumerate(ballot):
            model = 8 + share if len(ballot) > 1 else min(len(found), 7)
            if self.bits.decide(self.models["G", min(i, 2), model]):
                return index
        index = self.bits.tree(self.models, ("P",), 8)
        need(index < self.palette, "palette index")
        return index
