# SPDX-License-Identifier: MIT
"""Usage: check_picture.py game_loop|mirror|kelp-view PROGRAM PACK

Runs a sample on a pack of the kelp plant. Checks the picture it saves, and what it says about bad input."""

import os
import subprocess
import sys
import tempfile


def read_ppm(path):
    """Width, height and a list of (r, g, b)."""
    with open(path, "rb") as file:
        magic, size, depth, pixels = file.read().split(b"\n", 3)
    width, height = map(int, size.split())
    assert magic == b"P6" and depth == b"255" and len(
        pixels) == 3 * width * height, "not a whole PPM picture: " + path
    return width, height, list(zip(pixels[0::3], pixels[1::3], pixels[2::3]))


def share(pixels, test):
    return sum(1 for pixel in pixels if test(*pixel)) / len(pixels)


def is_olive(r, g, b):
    """The plant: more green than blue, and no more red than olive has."""
    return g > 1.35 * b and g > 0.6 * r and g > 30


def is_red(r, g, b):
    return r > 150 and r > 2 * g and r > 2 * b


def check_game_loop(width, height, pixels):
    assert share(pixels, is_olive) > 0.02, "the plant is missing"
    # The hoop goes round the stem at half height, before it and behind it.
    middle = pixels[width * (height // 3):width * (2 * height // 3)]
    assert share(middle, is_red) > 0.01 and share(middle, is_olive) > 0.01, "plant and hoop do not meet"
    column = [is_red(*pixels[width * y + width // 2]) for y in range(height)]
    assert any(column), "the hoop does not pass before the plant"
    lines = [sum(is_red(*pixel) for pixel in pixels[width * y:width * (y + 1)]) for y in range(height)]
    red = [y for y in range(height) if lines[y] > 0]
    far, near = sum(lines[red[0]:(red[0] + red[-1]) // 2]), sum(lines[(red[0] + red[-1]) // 2:])
    assert near > 1.35 * far, "the plant does not hide the hoop behind it: %d, %d" % (near, far)
    water = share(pixels, lambda r, g, b: max(abs(r - 148), abs(g - 188), abs(b - 200)) <= 3)
    assert water > 0.5, "the background is not encoded as sRGB: %.2f of it is" % water


def check_mirror(width, height, pixels):
    # The plant itself left of the middle, one image of it behind to the left, another to the right of the
    # mirrors' common edge.
    def olive(left, right, top, bottom):
        box = [pixels[width * y + x] for y in range(int(top * height), int(bottom * height))
               for x in range(int(left * width), int(right * width))]
        return share(box, is_olive)
    assert olive(0.40, 0.56, 0.35, 0.75) > 0.1, "the plant is missing"
    assert olive(0.28, 0.37, 0.30, 0.60) > 0.05, "the mirror behind shows no plant"
    assert olive(0.62, 0.74, 0.22, 0.55) > 0.05, "the mirror to the right shows no plant"


def check_view(width, height, pixels):
    assert share(pixels, is_olive) > 0.02, "the plant is missing"
    assert share(pixels, lambda r, g, b: (r, g, b) == (255, 200, 60)) > 0.0001, "the knots are missing"
    assert share(pixels, lambda r, g, b: (r, g, b) == (90, 200, 255)) > 0.0001, "the tangents are missing"


def expect(command, exit_code, word):
    done = subprocess.run(command, capture_output=True, text=True, timeout=120)
    lines = done.stderr.strip().splitlines()
    assert done.returncode == exit_code, "%s: exit code %d instead of %d\n%s" % (command, done.returncode,
                                                                                 exit_code, done.stderr)
    assert len(lines) >= 1 and word in lines[0], "%s says %r, which lacks %r" % (command, done.stderr, word)


def main(sample, program, pack):
    with tempfile.TemporaryDirectory() as folder:
        picture = os.path.join(folder, "picture.ppm")
        subprocess.run([program, pack, "--frames", "2", picture], check=True, timeout=240)
        {"game_loop": check_game_loop, "mirror": check_mirror,
         "kelp-view": check_view}[sample](*read_ppm(picture))

        truncated = os.path.join(folder, "truncated.kelp")
        with open(pack, "rb") as whole, open(truncated, "wb") as part:
            part.write(whole.read()[:-100])
        expect([program, truncated, "--frames", "1"], 3, truncated)
        absent = os.path.join(folder, "absent.kelp")
        expect([program, absent, "--frames", "1"], 2, absent)
        expect([program, pack, "--frames", "1", os.path.join(folder, "absent", "picture.ppm")], 2,
               "picture.ppm")
        expect([program, pack, "--frames", "none"], 1, "--help" if sample == "kelp-view" else "usage")


if __name__ == "__main__":
    main(*sys.argv[1:])
