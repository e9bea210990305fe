# SPDX-License-Identifier: MIT
"""check_underwater.py PROGRAM PACKS PICTURES: runs the underwater sample small and short, looks at the
pictures that it saves, and at what it says of bad input. PICTURES is samples/pictures."""

import os
import shutil
import struct
import subprocess
import sys
import tempfile

from check_picture import expect, read_ppm, share

SIZE = (320, 240)


def is_water(r, g, b):
    return b > 1.03 * g and g > 1.4 * r and b > 60


def is_leaf(r, g, b):
    return g > 1.2 * r and g > 1.25 * b


def is_sand(r, g, b):
    return min(r, g, b) > 95 and max(r, g, b) - min(r, g, b) < 60


def is_warm(r, g, b):
    """Fish and dulse: what is neither water, sand nor leaf."""
    return r > 1.35 * b and r > 1.1 * g and r > 60


def picture(program, packs, path, *options):
    size = ["--size", "%dx%d" % SIZE]
    subprocess.run([program, packs, "--plants", "60", *size, *options, path], check=True, timeout=240)
    width, height, pixels = read_ppm(path)
    assert (width, height) == SIZE, (width, height)
    return pixels


def check(pixels):
    middle = len(pixels) // 2
    assert share(pixels[:middle // 2], is_water) > 0.8, "there is no water above"
    assert share(pixels[middle:], is_sand) > 0.15, "there is no sand below"
    assert share(pixels, is_leaf) > 0.03, "the plants are missing"
    assert share(pixels, is_warm) > 0.003, "the fish are missing"


def main(program, packs, pictures):
    with tempfile.TemporaryDirectory() as folder:
        first = picture(program, packs, os.path.join(folder, "first.ppm"), "--start", "2", "--frames", "1")
        check(first)
        again = picture(program, packs, os.path.join(folder, "again.ppm"), "--start", "2", "--frames", "1")
        assert first == again, "the same moment looks different the second time"
        later = picture(program, packs, os.path.join(folder, "later.ppm"), "--start", "2", "--frames", "12")
        check(later)
        moved = sum(1 for p, q in zip(first, later)
                    if max(abs(a - b) for a, b in zip(p, q)) > 12) / len(first)
        assert 0.02 < moved < 0.6, "a third of a second changes %.3f of the picture" % moved

        converted = os.path.join(folder, "first.png")
        subprocess.run([sys.executable, "-B", os.path.join(pictures, "ppm_to_png.py"),
                        os.path.join(folder, "first.ppm"), converted], check=True, timeout=60)
        sys.path.insert(0, pictures)
        import png
        assert b"".join(png.read(converted).rows) == bytes(c for pixel in first
                                                           for c in pixel), "the PNG shows something else"

        damaged = os.path.join(folder, "damaged")
        shutil.copytree(packs, damaged)
        small = ["--plants", "0", "--size", "64x48", "--frames", "1"]
        with open(os.path.join(damaged, "dulse.kelp"), "r+b") as pack:  # in the last page of voxels
            index = pack.read(64 + 48 * 64)
            entries = [struct.unpack_from("<4s12xQQ", index, 64 + 48 * i)
                       for i in range(struct.unpack_from("<I", index, 24)[0])]
            at = max(offset + stored for kind, offset, stored in entries if kind == b"BRCK") - 200
            pack.seek(at)
            byte = pack.read(1)[0]
            pack.seek(at)
            pack.write(bytes((byte ^ 1,)))
        expect([program, damaged, *small], 3, "dulse.kelp")
        os.truncate(os.path.join(damaged, "dulse.kelp"),
                    os.path.getsize(os.path.join(damaged, "dulse.kelp")) - 100)
        expect([program, damaged, "--frames", "1"], 3, "dulse.kelp")
        os.remove(os.path.join(damaged, "dulse.kelp"))
        expect([program, damaged, "--frames", "1"], 2, "dulse.kelp")
        expect([program, packs, *small, os.path.join(folder, "absent", "picture.ppm")], 2, "picture.ppm")
        expect([program, packs, "--plants", "many"], 1, "usage")
        expect([program], 1, "usage")


if __name__ == "__main__":
    main(*sys.argv[1:])
