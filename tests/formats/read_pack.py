#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""A second reader of .kelp packs, written from formats/SPEC.md alone. It shares no code with kelp and
reads every byte, as a validator must.

  read_pack.py PACK            prints all that the pack holds, one thing a line: names in hexadecimal,
                               floats as their bits, voxels as CRC-32
  read_pack.py --damage PACK   changes every byte of the (small) pack in turn; each change must be refused

Needs the zstd library (libzstd.so.1). Exit codes: 0 good, 1 usage, 3 refused, 7 a changed byte was not seen,
77 no zstd here.
"""

import ctypes
import ctypes.util
import functools
import itertools
import math
import struct
import sys
import zlib

from arcs import Folds, Sweep
from cages import Cage, WrongCage
from read_page import Page, Refused, need
from xxh3 import xxh3_64


class Zstd:
    def __init__(self):
        self.lib = ctypes.CDLL(ctypes.util.find_library("zstd") or "libzstd.so.1")
        for name, result in (("ZSTD_getFrameContentSize", ctypes.c_ulonglong),
                ("ZSTD_findFrameCompressedSize", ctypes.c_size_t), ("ZSTD_decompress", ctypes.c_size_t)):
            getattr(self.lib, name).restype = result

    def decode(self, frame, raw):
        """The one frame that fills `frame`, which must decode to `raw` bytes (section 2)."""
        need(frame[:4] == b"\x28\xb5\x2f\xfd", "not a zstd frame")
        size = ctypes.c_size_t(len(frame))
        need(self.lib.ZSTD_getFrameContentSize(frame, size) == raw, "the frame does not state the raw size")
        need(self.lib.ZSTD_findFrameCompressedSize(frame, size) == len(frame),
                "the frame does not fill its place")
        out = ctypes.create_string_buffer(max(raw, 1))
        need(self.lib.ZSTD_decompress(out, ctypes.c_size_t(raw), frame, size) == raw,
                "the frame does not decode")
        return out.raw[:raw]


class Table:
    """Takes little-endian values off a chunk; must be used up."""

    def __init__(self, data, what):
        self.data, self.what, self.at = data, what, 0

    def take(self, form):
        size = struct.calcsize("<" + form)
        need(self.at + size <= len(self.data), self.what + " is too short")
        values = struct.unpack_from("<" + form, self.data, self.at)
        self.at += size
        for value in values:
            need(not isinstance(value, float) or math.isfinite(value),
                    self.what + " holds a number that is not finite")
        return values

    def one(self, form):
        return self.take(form)[0]

    def planes(self, count):
        """Numbers of four bytes: all lowest bytes first."""
        planes = [self.take("%dB" % count) for _ in range(4)]
        return [a | b << 8 | c << 16 | d << 24 for a, b, c, d in zip(*planes)]

    def name(self, size):
        need(size <= 255, "a name is too long")
        text = self.text(self.data[self.at : self.at + size])
        need(self.at + size <= len(self.data), "a name is beyond its table")
        need(not any(ord(c) < 0x20 or 0x7F <= ord(c) <= 0x9F for c in text), "a name has control characters")
        self.at += size
        return text

    @staticmethod
    def text(data):
        try:
            text = data.decode("utf-8", "strict")
        except UnicodeDecodeError:
            raise Refused("a text is not UTF-8") from None
        need("\0" not in text, "a text holds a null")
        return text

    def end(self):
        need(self.at == len(self.data), self.what + " is longer than its counts say")


def regular(m):
    """The first three columns of a 4 x 3 matrix have a determinant that is finite and not zero."""
    a, b, c = m[0:3], m[3:6], m[6:9]
    cross = (b[1] * c[2] - b[2] * c[1], b[2] * c[0] - b[0] * c[2], b[0] * c[1] - b[1] * c[0])
    determinant = sum(x * y for x, y in zip(a, cross))
    return math.isfinite(determinant) and determinant != 0


def single(number):
    return struct.unpack("<f", struct.pack("<f", number))[0]


PI = single(math.pi)
METADATA = ["INFO", "PART", "MATL", "FOGS", "RIGS", "CLIP", "SOCK", "JNTS", "CAGE"]
REQUIRED = {"INFO": 0, "PART": 1, "MATL": 1, "FOGS": 1, "RIGS": 1, "CLIP": 0, "SOCK": 0, "JNTS": 0, "CAGE": 0,
        "GRID": 1, "BRCK": 1, "FOGB": 1, "DGRD": 0, "DIST": 0}


class Pack:
    def __init__(self, data, zstd):
        self.data, self.zstd = data, zstd
        self.read_header()
        self.read_index()
        self.read_metadata()
        self.read_levels()

    # Section 3.1
    def read_header(self):
        data = self.data
        need(data[:12] == bytes.fromhex("AB4B454C50414BBB0D0A1A0A"), "not a pack")
        need(len(data) >= 64, "truncated")
        major, self.minor, size, self.count = struct.unpack_from("<HHQI", data, 12)
        need(major == 1, "unsupported version")
        need(len(data) == size, "truncated or too long")
        need(not any(data[28:56]), "reserved bytes of the header")
        need(self.count >= 1 and 64 + 48 * self.count <= size, "the index does not fit")
        (stated,) = struct.unpack_from("<Q", data, 56)
        need(xxh3_64(data[:56] + bytes(8) + data[64 : 64 + 48 * self.count]) == stated, "header checksum")

    # Section 3.2
    def read_index(self):
        self.chunks = []
        end = 64 + 48 * self.count
        for i in range(self.count):
            fourcc, flags, level, part, offset, stored, raw, checksum = struct.unpack_from("<4sIIIQQQQ",
                    self.data, 64 + 48 * i)
            need(offset == (end + 63) // 64 * 64, "a chunk is not where it belongs")
            need(stored >= 1 and offset + stored <= len(self.data), "a chunk is beyond the end")
            need(not any(self.data[end:offset]), "padding is not zero")
            end = offset + stored
            content = self.data[offset:end]
            need(xxh3_64(content) == checksum, "chunk checksum")
            name = fourcc.decode("latin-1")
            if name not in REQUIRED:
                need(not flags & 1, "unsupported feature: required chunk")
                continue
            need(flags & ~3 == 0, "unsupported feature: flag")
            need(flags & 1 == REQUIRED[name], "required flag")
            need(raw >= 1, "empty chunk")
            if flags & 2:
                need(name not in ("BRCK", "FOGB", "DIST") and raw <= 32768 * stored + 32767, "zstd flag")
                content = self.zstd.decode(content, raw)
            need(len(content) == raw, "raw size")
            if name in METADATA:
                need(level == 0 and part == 0, "level or part of metadata")
            self.chunks.append((name, level, part, content))
        need(end == len(self.data), "bytes after the last chunk")

    # Sections 3.3 and 4
    def read_metadata(self):
        names = [chunk[0] for chunk in self.chunks]
        count = next((i for i, name in enumerate(names) if name not in METADATA), len(names))
        found = names[:count]
        need(found == [n for n in METADATA if n in found] and {"PART", "MATL", "RIGS"} <= set(found),
                "order of metadata")
        content = {chunk[0]: chunk[3] for chunk in self.chunks[:count]}
        self.level_chunks = self.chunks[count:]
        self.info = Table.text(content["INFO"]) if "INFO" in content else ""
        self.read_parts(Table(content["PART"], "PART"))
        self.read_palette(Table(content["MATL"], "MATL"))
        need(("FOGS" in content) == any(part["kind"] == 1 for part in self.parts),
                "FOGS is there if a part is fog, and only then")
        if "FOGS" in content:
            self.read_fogs(Table(content["FOGS"], "FOGS"))
        self.read_rigs(Table(content["RIGS"], "RIGS"))
        self.clips = []
        if "CLIP" in content:
            self.read_clips(Table(content["CLIP"], "CLIP"))
        self.sockets = []
        if "SOCK" in content:
            self.read_sockets(Table(content["SOCK"], "SOCK"))
        self.joints = []
        if "JNTS" in content:
            self.read_joints(Table(content["JNTS"], "JNTS"))
        for part in self.parts:
            part["cages"] = []
        if "CAGE" in content:
            try:
                self.read_cages(Table(content["CAGE"], "CAGE"))
            except WrongCage as why:
                raise Refused(str(why)) from why

    def read_parts(self, table):
        count, text_bytes = table.take("II")
        need(count >= 1, "no parts")
        self.parts, sizes = [], []
        for i in range(count):
            name_bytes, parent, kind, levels, reserved = table.take("IiBBH")
            size, to_object, pivot = table.take("III"), table.take("12f"), table.take("12f")
            need(-1 <= parent < i, "parent")
            need(kind <= 2, "unsupported feature: kind of part")
            need((levels == 0 if kind == 2 else 1 <= levels <= 16) and reserved == 0,
                    "levels or reserved field")
            need(all(1 <= side <= 32768 for side in size), "size of a part")
            need(regular(to_object) and regular(pivot), "a matrix cannot be inverted")
            sizes.append(name_bytes)
            self.parts.append({"parent": parent, "kind": kind, "levels": levels, "size": size,
                    "to_object": to_object, "pivot": pivot})
        need(any(part["kind"] != 2 for part in self.parts), "all parts are empty")
        need(sum(sizes) == text_bytes, "bytes of names")
        for part, name_bytes in zip(self.parts, sizes):
            part["name"] = table.name(name_bytes)
        table.end()

    def read_palette(self, table):
        count = table.one("I")
        need(1 <= count <= 256, "size of the palette")
        self.palette = []
        for _ in range(count):
            entry = table.take("9f")
            need(all(0 <= v <= 1 for v in entry[0:4] + entry[7:9]) and min(entry[4:7]) >= 0,
                    "a material is out of range")
            self.palette.append(entry)
        table.end()

    def read_fogs(self, table):
        fogs = [part for part in self.parts if part["kind"] == 1]
        need(table.one("I") == len(fogs), "fog of another number of parts")
        for part in fogs:
            part["fog"] = table.take("5f")
            red, green, blue, anisotropy, glow = part["fog"]
            part["ramp"], reserved = table.take("II")
            need(all(0 <= v <= 1 for v in (red, green, blue)) and -1 < anisotropy < 1 and glow >= 0
                    and reserved == 0, "a fog is out of range")
            need(part["ramp"] == 0 or 2 <= part["ramp"] <= 256, "colors of a ramp")
        for part in fogs:
            part["extinction"] = table.take("%df" % part["levels"])
            need(min(part["extinction"]) > 0, "extinction")
        for part in fogs:
            part["ramp"] = [table.take("3f") for _ in range(part["ramp"])]
            need(all(min(color) >= 0 for color in part["ramp"]), "color of a ramp")
        table.end()

    def read_rigs(self, table):
        count, total = table.take("II")
        need(count == len(self.parts), "rigs of another number of parts")
        heads = [table.take("IQfIf") for _ in range(count)]
        need(all(2 <= h[0] <= 64 for h in heads) and sum(h[0] for h in heads) == total, "number of knots")
        for part, (n, automatic, place, bend, roll) in zip(self.parts, heads):
            need(automatic >> n == 0, "automatic tangents of knots that are not there")
            part["automatic"] = automatic
            need(place == -1 or (0 <= place <= 1 and part["parent"] >= 0), "place on the parent's spline")
            part["parent_at"] = place
            need(bend <= 1, "another way to bend")
            need(-PI <= roll <= PI and (bend == 1 or roll == 0), "roll")
            part["bend"], part["roll"] = bend, roll
            knots = part["knots"] = [table.take("7f") for _ in range(n)]
            need(knots[0][0] == 0 and knots[-1][0] == 1, "ends of a rig")
            for a, b in zip(knots, knots[1:]):
                need(b[0] > a[0], "knots do not ascend")
                if bend == 0:
                    self.check_monotone(a, b)
            if bend == 1:
                try:
                    Sweep(knots, part["size"], roll)
                except Folds as why:
                    raise Refused(str(why)) from why
        table.end()

    @staticmethod
    def check_monotone(a, b):
        """By sampling, which is another way than the library's."""
        w = b[0] - a[0]
        height = lambda t: (
            (2 * t**3 - 3 * t**2 + 1) * a[2] + (t**3 - 2 * t**2 + t) * w * a[5]
            + (3 * t**2 - 2 * t**3) * b[2] + (t**3 - t**2) * w * b[5])
        rise, highest = b[2] - a[2], a[2]
        need(rise > 0, "a spline does not rise")
        for i in range(1, 201):
            y = height(i / 200)
            need(highest - y <= 2e-5 * rise, "a spline turns back")
            highest = max(highest, y)

    def read_clips(self, table):
        clips, waves, tracks, keys, text_bytes = table.take("5I")
        records = [table.take("IfII") for _ in range(clips)]
        need(all(r[1] > 0 for r in records), "duration of a clip")
        need(sum(r[0] for r in records) == text_bytes and sum(r[2] for r in records) == waves
                and sum(r[3] for r in records) == tracks, "counts of clips")
        knot_exists = lambda part, knot: part < len(self.parts) and knot < len(self.parts[part]["knots"])
        all_waves = []
        for _ in range(waves):
            wave = table.take("III5f")
            need(knot_exists(wave[0], wave[1]) and wave[2] <= 1 and wave[6] > 0, "a wave")
            all_waves.append(wave)
        all_tracks = []
        for _ in range(tracks):
            part, knot, target, interpolation, reserved, count = table.take("IIBBHI")
            need(knot_exists(part, knot) and target <= 4 and interpolation <= 2 and reserved == 0
                    and count >= 1, "a track")
            need(target <= 1 or knot == 0, "a track of a part names a knot")
            all_tracks.append((part, knot, target, interpolation, count))
        need(sum(t[4] for t in all_tracks) == keys, "number of keys")
        planes = [table.take("%dB" % keys) for _ in range(52)]
        all_keys = [struct.unpack("<13f", bytes(record)) for record in zip(*planes)]
        for i, (part, knot, target, interpolation, count) in enumerate(all_tracks):
            track_keys, all_keys = all_keys[:count], all_keys[count:]
            need(track_keys[0][0] >= 0 and all(b[0] > a[0] for a, b in zip(track_keys, track_keys[1:])),
                    "times of keys")
            for key in track_keys:
                need(interpolation == 2 or not any(key[5:]), "slopes of a track that is not cubic")
                if target == 3:
                    need(0.998 < sum(v * v for v in key[1:5]) < 1.002, "a rotation")
                else:
                    need(key[4] == 0 and key[8] == 0 and key[12] == 0, "fourth component")
            all_tracks[i] = (part, knot, target, interpolation, track_keys)
        names = [table.name(r[0]) for r in records]
        table.end()
        for name, (_, duration, wave_count, track_count) in zip(names, records):
            self.clips.append({"name": name, "duration": duration, "waves": all_waves[:wave_count],
                    "tracks": all_tracks[:track_count]})
            del all_waves[:wave_count], all_tracks[:track_count]

    def read_sockets(self, table):
        count, text_bytes = table.take("II")
        records = [table.take("II7f") for _ in range(count)]
        need(all(r[0] >= 1 for r in records) and sum(r[0] for r in records) == text_bytes, "names of sockets")
        for record in records:
            need(record[1] < len(self.parts) and 0 <= record[2] <= 1, "a socket")
            need(0.998 < sum(v * v for v in record[5:9]) < 1.002, "a socket's rotation")
            self.sockets.append((table.name(record[0]),) + record[1:])
        table.end()

    def read_joints(self, table):
        count, listed, text_bytes = table.take("III")
        records = [table.take("Ii12fI") for _ in range(count)]
        need(all(r[0] >= 1 for r in records) and sum(r[0] for r in records) == text_bytes, "names of joints")
        need(sum(r[14] for r in records) == listed, "lists of parts of joints")
        lists = [table.take("%dI" % r[14]) for r in records]
        for index, (record, parts) in enumerate(zip(records, lists)):
            need(-1 <= record[1] < index, "a joint's parent")
            need(regular(record[2:14]), "a joint's inverse bind matrix")
            need(all(a < b for a, b in zip(parts, parts[1:] + (len(self.parts),))), "a joint's parts")
            self.joints.append((table.name(record[0]), record[1], record[2:14], parts))
        table.end()

    def read_cages(self, table):
        need(table.one("I") == len(self.parts), "cages of another number of parts")
        kinds = table.take("%dB" % len(self.parts))
        need(any(kinds) and all(k == 0 or k & 15 in (1, 2, 3, 4) for k in kinds), "sides of cells")
        need(all(k & ~15 in (0, 16, 48, 64) for k in kinds), "movers of nodes")
        cages = []
        for part, log in zip(self.parts, [k & 15 for k in kinds]):
            need(log == 0 or part["kind"] == 0, "a cage of a part that is not solid")
            for level in range(part["levels"] if log else 0):
                part["cages"].append(Cage(1 << log, level, part["levels"], part["size"]))
            cages += part["cages"]
        numbers = table.planes(5 * len(cages))
        counts = [tuple(numbers[5 * i : 5 * i + 5]) for i in range(len(cages))]
        for cage in cages:
            cage.take_blocks(table.take("%dB" % cage.cubes))
        for cage in cages:
            cage.take_masks(bytes(table.take("%dB" % cage.mask_bytes())))
        steps = iter(table.planes(sum(count[2] for count in counts)))
        points = [[p - 1 for p in itertools.accumulate(next(steps) + 1 for _ in range(count[2]))]
                for count in counts]
        for cage, point, count in zip(cages, points, counts):
            cage.take_splits(point, table.take("%dB" % count[3]))
            cage.join()
            need((len(cage.places), len(cage.faces)) == count[:2], "number of nodes or faces")
        steps = iter(table.planes(sum(count[4] for count in counts)))
        back = lambda step: -(step + 1) // 2 if step % 2 else step // 2
        named = [list(itertools.accumulate(back(next(steps)) for _ in range(count[4]))) for count in counts]
        moved = [(own, part["cages"][0]) for own, part in enumerate(self.parts) if kinds[own] & 16]
        numbers = [table.take("%dB" % len(cage.places)) for _, cage in moved]
        need(all(1 <= n <= 4 for n in itertools.chain(*numbers)), "parts that a node follows")
        total = sum(map(sum, numbers))
        parts, weights = iter(table.planes(total)), iter(table.take("%dB" % (total - sum(map(len, numbers)))))
        for (own, cage), counts in zip(moved, numbers):
            for n in counts:
                its, shares = [next(parts) for _ in range(n)], [next(weights) for _ in range(n - 1)]
                shares.append(255 - sum(shares))
                least = its + [min(len(self.parts), 65536)]
                need(all(a < b for a, b in zip(least, least[1:])), "order of parts")
                need(own not in its and min(shares) > 0, "a node's own part, or weights")
                cage.influences.append(list(itertools.chain(*zip(its, shares))) + [0, 0] * (4 - n))
        self.read_morphs(table, [part["cages"] for part, kind in zip(self.parts, kinds) if kind & 32])
        sectioned = [part for part, kind in zip(self.parts, kinds) if kind & 64]
        for part, of in zip(sectioned, table.planes(len(sectioned))):
            need(of < len(self.parts) and self.parts[of]["kind"] == 2, "the part of sections")
            part["sections"] = of
        table.end()
        for part in self.parts:
            for finer, cage in zip([None] + part["cages"], part["cages"]):
                if finer:
                    cage.follow(finer, named.pop(0))
                else:
                    need(not named.pop(0), "the finest cage follows cells")

    def read_morphs(self, table, caged):
        targets = table.planes(len(caged))
        records = iter(table.planes(2 * sum(targets)))
        lists = [cage for cages, count in zip(caged, targets) for cage in cages for _ in range(count)]
        counts = table.planes(len(lists))
        steps, offsets = iter(table.planes(sum(counts))), iter(table.planes(3 * sum(counts)))
        counts = iter(counts)
        for cages, count in zip(caged, targets):
            need(count >= 1, "morph targets of a part")
            its = [(next(records), struct.unpack("<f", struct.pack("<I", next(records)))[0])
                    for _ in range(count)]
            least = [part for part, _ in its] + [len(self.parts)]
            need(all(a < b for a, b in zip(least, least[1:])), "order of morph targets")
            need(all(self.parts[part]["kind"] == 2 for part, _ in its), "a morph target that is not empty")
            need(all(0 < step < math.inf for _, step in its), "step of a morph target")
            for cage in cages:
                for part, step in its:
                    n = next(counts)
                    nodes = [p - 1 for p in itertools.accumulate(next(steps) + 1 for _ in range(n))]
                    need(not nodes or nodes[-1] < len(cage.places), "nodes that a morph target moves")
                    back = lambda v: -(v + 1) // 2 if v % 2 else v // 2
                    moved = [[step * single(back(next(offsets))) for _ in range(3)] for _ in range(n)]
                    need(all(abs(v) < 2.0**128 for offset in moved for v in offset), "offset of a node")
                    cage.morphs.append((part, list(zip(nodes, moved))))

    # Section 5
    def read_levels(self):
        left = list(self.level_chunks)
        for part in self.parts:
            part["level"] = [None] * part["levels"]
        for level in reversed(range(max(part["levels"] for part in self.parts))):
            for index, part in enumerate(self.parts):
                if level >= part["levels"]:
                    continue
                bricks = "FOGB" if part["kind"] == 1 else "BRCK"
                need(len(left) >= 2 and left[0][:3] == ("GRID", level, index)
                        and left[1][:3] == (bricks, level, index), "order of levels")
                part["level"][level] = self.read_level(part, level, left.pop(0)[3], left.pop(0)[3])
        for part in self.parts:
            part["distances"] = []
        if left and left[0][0] == "DGRD":
            self.read_distances(left)
        need(not left, "more levels than parts have")

    # Section 5.4
    def read_distances(self, left):
        for part in self.parts:
            if part["kind"] == 0:
                halvings, side = 0, max(part["size"])
                while side > 8:
                    halvings, side = halvings + 1, (side + 1) // 2
                part["distances"] = [None] * max(part["levels"], halvings + 1)
        for level in reversed(range(max(len(part["distances"]) for part in self.parts))):
            for index, part in enumerate(self.parts):
                if level >= len(part["distances"]):
                    continue
                need(len(left) >= 2 and left[0][:3] == ("DGRD", level, index)
                        and left[1][:3] == ("DIST", level, index), "order of distances")
                part["distances"][level] = self.read_distance_level(part, level, left.pop(0)[3],
                        left.pop(0)[3])

    def read_distance_level(self, part, level, grid_chunk, pages_chunk):
        size = [-(-side // (1 << level)) for side in part["size"]]
        grid = [-(-side // 8) for side in size]
        count = grid[0] * grid[1] * grid[2]
        table = Table(grid_chunk, "DGRD")
        band = table.take("BB")
        need(16 <= band[0] <= 225 and 4 <= band[1] <= 28, "band")
        need(not any(table.take("6B")), "reserved bytes of DGRD")
        cells = table.take("%dB" % count)
        need(max(cells) <= 2, "cell of distances")
        if (8 + count) % 8:
            need(not any(table.take("%dB" % (-count % 8))), "padding of DGRD")
        number = iter(range(count))
        by_morton = sorted(range(count), key=lambda c: self.morton(c, grid))
        slot_of = {cell: next(number) for cell in by_morton if cells[cell] == 2}
        stored = list(slot_of)
        meaning = [0 if c == 0 else 255 if c == 1 else 1 << 31 | slot_of[i] for i, c in enumerate(cells)]
        codes = bytearray()
        for first, bricks, page, size_of_raw in self.pages(table, grid_chunk, pages_chunk, len(stored), 113):
            raw = self.zstd.decode(page, size_of_raw)
            need(len(raw) == 576 * bricks, "raw size of a page of distances")
            positions = [(c % grid[0], c // grid[0] % grid[1], c // grid[0] // grid[1])
                    for c in stored[first : first + bricks]]
            codes += self.decode_distances(raw, positions, size, band)
        return {"band": band, "cells": meaning, "codes": codes}

    @staticmethod
    @functools.lru_cache
    def offsets(reach):
        span = range(-reach, reach + 1)
        return sorted((x * x + y * y + z * z, x, y, z) for x in span for y in span for z in span)

    def decode_distances(self, raw, positions, size, band):
        """Codes of a page. Nearest voxels are found by trying offsets, the nearest first, or all voxels of
        the other kind if there are few."""
        sums = {x * x + y * y + z * z for x in range(16) for y in range(x, 16) for z in range(y, 16)}
        solid = {}
        for brick, position in enumerate(positions):
            for z, word in enumerate(struct.unpack_from("<8Q", raw, 64 * brick)):
                for i in range(64):
                    voxel = (8 * position[0] + i % 8, 8 * position[1] + i // 8, 8 * position[2] + z)
                    solid[voxel] = word >> i & 1
                    need(not solid[voxel] or all(v < side for v, side in zip(voxel, size)),
                            "solid voxel of distances outside")
        of_kind = [[v for v, s in solid.items() if s == kind] for kind in (0, 1)]
        corrections = raw[64 * len(positions) :]
        codes = bytearray()
        for (x, y, z), kind in solid.items():
            limit = band[kind]
            squared = 0
            if len(of_kind[1 - kind]) < 100:
                nearest = min(((x - a) ** 2 + (y - b) ** 2 + (z - c) ** 2 for a, b, c in of_kind[1 - kind]),
                        default=limit + 1)
                squared = nearest if nearest <= limit else 0
            else:
                for near, dx, dy, dz in self.offsets(int(max(band) ** 0.5)):
                    if near > limit:
                        break
                    if solid.get((x + dx, y + dy, z + dz), kind) != kind:
                        squared = near
                        break
            correction = corrections[len(codes)]
            if correction:
                need(correction <= limit and correction in sums and (squared == 0 or correction < squared),
                        "correction")
                squared = correction
            codes.append(255 - squared if kind else squared)
        for brick in range(len(positions)):
            need(set(codes[512 * brick :][:512]) not in ({0}, {255}), "a brick beyond the band is stored")
        return codes

    def read_level(self, part, level, grid_chunk, bricks_chunk):
        size = [-(-side // (1 << level)) for side in part["size"]]
        grid = [-(-side // 8) for side in (
                size if part["kind"] == 0 else [max(side - 1, 1) for side in size])]
        count = grid[0] * grid[1] * grid[2]
        table = Table(grid_chunk, "GRID")
        cells, stored = self.read_cells(table, grid, None if part["kind"] else size)
        content = {"grid": grid, "cells": cells, "codes": bytearray(), "attributes": [],
                "density": bytearray(), "heat": bytearray()}
        for first, bricks, page, raw in self.pages(table, grid_chunk, bricks_chunk, len(stored), 128):
            positions = stored[first : first + bricks]
            if part["kind"] == 0:
                coarser = None
                if level + 1 < part["levels"]:
                    coarser = functools.partial(self.codes_of_brick, part["level"][level + 1])
                decoded = Page(page, positions, size, coarser, len(self.palette), raw)
                content["codes"] += decoded.codes
                content["attributes"] += decoded.attributes
            else:
                self.take_fog(self.zstd.decode(page, raw), positions, size, 2 if part["ramp"] else 1, content)
        return content

    # Section 5.2
    @staticmethod
    def read_cells(table, grid, size):
        """Cells, as u32: 1 << 31 | slot of a stored brick, 3 << 30 if it is inside, else its clearance << 24;
        and the positions of the stored bricks, by slot. size: of a level of voxels; None: it is fog."""
        count = grid[0] * grid[1] * grid[2]
        stated = table.take("%dB" % count)
        if count % 8:
            need(not any(table.take("%dB" % (-count % 8))), "padding of a grid")
        clearance = {}
        cells, stored = [0] * count, []
        for cell, value in enumerate(stated):
            x, y, z = place = (cell % grid[0], cell // grid[0] % grid[1], cell // grid[0] // grid[1])
            need(value <= 129, "cell of a grid")
            if value == 128:
                stored.append(cell)
            elif value == 129:
                need(size and all(8 * p + 8 <= side for p, side in zip(place, size)), "brick that is inside")
                cells[cell] = 3 << 30
            else:
                before = lambda i, j, k: clearance.get((x - i, y - j, z - k), 0)
                a, b, c = before(1, 0, 0), before(0, 1, 0), before(0, 0, 1)
                predicted = sorted((a + b - before(1, 1, 0), a + c - before(1, 0, 1),
                        b + c - before(0, 1, 1)))[1]
                clearance[place] = (value + predicted) % 128
                cells[cell] = clearance[place] << 24
        stored.sort(key=lambda cell: Pack.morton(cell, grid))
        need(1 <= len(stored) <= 1 << 24, "number of stored bricks")
        for slot, cell in enumerate(stored):
            cells[cell] = 1 << 31 | slot
        return cells, [(c % grid[0], c // grid[0] % grid[1], c // grid[0] // grid[1]) for c in stored]

    @staticmethod
    def codes_of_brick(level, position):
        grid = level["grid"]
        cell = level["cells"][position[0] + grid[0] * (position[1] + grid[1] * position[2])]
        if cell >> 31 == 0:
            return bytes(512)
        if cell == 3 << 30:
            return bytes([128]) * 512
        slot = cell & 0x7FFFFFFF
        return level["codes"][512 * slot : 512 * slot + 512]

    @staticmethod
    def pages(table, grid_chunk, pages_chunk, stored, most):
        """First slot, number of bricks, stored bytes and raw size of each page of the rest of the table."""
        offset = slot = 0
        while table.at < len(grid_chunk):
            page_offset, page_stored, page_raw, checksum, first, bricks = table.take("QIIQII")
            need(page_offset == offset and first == slot, "a page is not where the one before ends")
            need(1 <= page_stored <= 131072 and page_raw <= 65536 and 1 <= bricks <= most,
                    "numbers of a page")
            page = pages_chunk[offset : offset + page_stored]
            need(len(page) == page_stored, "a page is beyond its chunk")
            need(xxh3_64(page) == checksum, "page checksum")
            need(slot + bricks <= stored, "pages do not cover the bricks")
            yield slot, bricks, page, page_raw
            offset += page_stored
            slot += bricks
        need(offset == len(pages_chunk) and slot == stored and slot >= 1, "pages do not cover the bricks")

    # Section 6
    @staticmethod
    def take_fog(raw, positions, size, channels, content):
        bricks = len(positions)
        need(len(raw) == 729 * bricks * channels, "raw size of a page of fog")
        for brick, position in enumerate(positions):
            clear = True
            for channel in range(channels):
                samples = raw[729 * (bricks * channel + brick) :][:729]
                clear = clear and not any(samples)
                for i, sample in enumerate(samples):
                    place = [8 * p + v for p, v in zip(position, (i % 9, i // 9 % 9, i // 81))]
                    need(sample == 0 or all(p < side for p, side in zip(place, size)),
                            "a sample beyond the level")
            need(not clear, "a stored brick is clear")
        content["density"] += raw[: 729 * bricks]
        content["heat"] += raw[729 * bricks :]

    @staticmethod
    def morton(cell, grid):
        x, y, z = cell % grid[0], cell // grid[0] % grid[1], cell // grid[0] // grid[1]
        return sum((x >> i & 1) << 3 * i | (y >> i & 1) << 3 * i + 1 | (z >> i & 1) << 3 * i + 2
                for i in range(13))


def bits(values):
    return " ".join("%08x" % struct.unpack("<I", struct.pack("<f", v)) for v in values)


def crc_words(words):
    return zlib.crc32(struct.pack("<%dI" % len(words), *words))


def dump_cage(cage):
    flat = lambda lists: [value for values in lists for value in values]
    tables = [flat(place for place, _ in cage.cells), flat(cage.corner_nodes), flat(cage.beyond), cage.faces,
            cage.masks, flat(cage.places), cage.follows, flat(cage.influences)]
    return "cage side %d levels %d %d cells %d nodes %d faces %d crc " % (
            cage.side, cage.level, cage.last, len(cage.cells), len(cage.places),
            len(cage.faces)) + " ".join("%08x" % crc_words(table) for table in tables) + "".join(
            "\nmorph %d" % part + "".join(" %d %s" % (node, bits(offset)) for node, offset in moved)
            for part, moved in cage.morphs)


def dump(pack):
    out = ["minor %d" % pack.minor, "info " + pack.info]
    out += ["material " + bits(entry) for entry in pack.palette]
    for part in pack.parts:
        out.append("part %s parent %d kind %d size %d %d %d levels %d" %
                ((part["name"].encode().hex(), part["parent"], part["kind"]) + part["size"]
                + (part["levels"],)))
        out += ["object " + bits(part["to_object"]), "pivot " + bits(part["pivot"])]
        out += ["knot " + bits(knot) for knot in part["knots"]]
        out.append("automatic %x parent at %s" % (part["automatic"], bits([part["parent_at"]])))
        out.append("bend %d roll %s" % (part["bend"], bits([part["roll"]])))
        out += [dump_cage(cage) for cage in part["cages"]]
        out += ["sections %d" % part["sections"]] if "sections" in part else []
        if part["kind"] == 1:
            out += ["fog " + bits(part["fog"])] + ["color " + bits(color) for color in part["ramp"]]
            for level, extinction in zip(part["level"], part["extinction"]):
                crc = [zlib.crc32(struct.pack("<%dI" % len(level["cells"]), *level["cells"])),
                        zlib.crc32(level["density"]), zlib.crc32(level["heat"])]
                out.append("fog level bricks %d extinction %s crc %08x %08x %08x" %
                        ((len(level["density"]) // 729, bits([extinction])) + tuple(crc)))
            continue
        for level in part["level"]:
            crc = [zlib.crc32(struct.pack("<%dI" % len(level["cells"]), *level["cells"])),
                    zlib.crc32(level["codes"])]
            crc.append(zlib.crc32(struct.pack("<%dI" % len(level["attributes"]), *level["attributes"])))
            out.append("level bricks %d surface %d crc %08x %08x %08x" %
                    ((len(level["codes"]) // 512, len(level["attributes"])) + tuple(crc)))
        for level in part["distances"]:
            out.append("distances band %d %d bricks %d crc %08x %08x" % (level["band"] + (
                    len(level["codes"]) // 512,
                    zlib.crc32(struct.pack("<%dI" % len(level["cells"]), *level["cells"])),
                    zlib.crc32(level["codes"]))))
    for clip in pack.clips:
        out.append("clip %s duration %s" % (clip["name"].encode().hex(), bits([clip["duration"]])))
        out += ["wave %d %d %d %s" % (wave[0], wave[1], wave[2], bits(wave[3:])) for wave in clip["waves"]]
        for part, knot, target, interpolation, keys in clip["tracks"]:
            out.append("track %d %d %d %d" % (part, knot, target, interpolation))
            out += ["key " + bits(key) for key in keys]
    out += ["socket %s %d %s" % (s[0].encode().hex(), s[1], bits(s[2:])) for s in pack.sockets]
    for name, parent, matrix, parts in pack.joints:
        out.append(" ".join(["joint", name.encode().hex(), str(parent), bits(matrix), "parts"]
                + [str(part) for part in parts]))
    return "\n".join(out) + "\n"


def damage(data, zstd):
    """Every byte is covered by a checksum or must be zero: no change may go unseen."""
    for at in range(len(data)):
        changed = bytearray(data)
        changed[at] ^= 1 << at % 8
        try:
            Pack(bytes(changed), zstd)
        except Refused:
            continue
        print("the change of byte %d was not seen" % at, file=sys.stderr)
        return 7
    return 0


def main(arguments):
    damaging = arguments[:1] == ["--damage"]
    paths = arguments[1:] if damaging else arguments
    if len(paths) != 1:
        print(__doc__, file=sys.stderr)
        return 1
    try:
        zstd = Zstd()
    except OSError:
        return 77
    with open(paths[0], "rb") as file:
        data = file.read()
    try:
        pack = Pack(data, zstd)
    except Refused as why:
        print("%s: %s" % (paths[0], why), file=sys.stderr)
        return 3
    if damaging:
        return damage(data, zstd)
    sys.stdout.write(dump(pack))
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
