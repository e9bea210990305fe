# SPDX-License-Identifier: MIT
"""Usage: check_kelp_view_parts.py KELP_VIEW PACK

Shows the parts of a pack that has one part and no skin, by --view and by the key P."""

import os
import subprocess
import sys
import tempfile

import check_picture
import x11_input

WIDTH, HEIGHT = 1280, 800


def is_first_part(r, g, b):
    """The hue of the first part: a light red, in any light."""
    return r > 130 and 1.25 * g < r < 2 * g and abs(g - b) < 30


def is_grey(r, g, b):
    return r == g == b and 90 < r < 145


def in_picture(pixels):
    """Right of the panel."""
    return [pixel for y in range(HEIGHT) for pixel in pixels[y * WIDTH + 350:(y + 1) * WIDTH]]


def picture_of(view, pack, surface, folder):
    path = os.path.join(folder, surface + ".ppm")
    subprocess.run([view, "--view", surface, pack, "--frames", "2", path], check=True, timeout=240)
    width, height, pixels = check_picture.read_ppm(path)
    assert (width, height) == (WIDTH, HEIGHT)
    return in_picture(pixels)


def check_key(view, pack):
    try:
        screen = x11_input.Screen()
    except x11_input.Absent as absent:
        print("SKIPPED: the keys: %s" % absent)
        return
    program = subprocess.Popen([view, pack])
    screen.find(WIDTH, HEIGHT)

    def shows_parts(wanted):
        for _ in range(60):
            screen.settle(1)
            pixels = in_picture(screen.picture(WIDTH, HEIGHT))
            if (check_picture.share(pixels, is_first_part) > 0.02) == wanted:
                return True
        return False

    assert shows_parts(False), "the plant has the colour of its part from the start"
    screen.key("p")
    assert shows_parts(True), "P shows no parts"
    screen.key("p")  # no fit is known, so the shaded plant comes next
    assert shows_parts(False), "P does not go back"
    assert program.poll() is None
    program.terminate()
    program.wait(timeout=120)


def main(view, pack):
    share = check_picture.share
    with tempfile.TemporaryDirectory() as folder:
        parts = picture_of(view, pack, "parts", folder)
        assert share(parts, is_first_part) > 0.02, "the part has not its colour"
        assert share(parts, check_picture.is_olive) < 0.001, "the plant has its own colours"
        assert any(pixel == (235, 238, 240) for pixel in parts), "the joint is missing"
        assert not any(pixel == (255, 200, 60) for pixel in parts), "knots hide the parts"
        assert share(picture_of(view, pack, "fit", folder), is_grey) > 0.02, "a fit, and no skin"
        check_picture.expect([view, "--view", "nonsense", pack], 1, "--view")
    check_key(view, pack)


if __name__ == "__main__":
    main(*sys.argv[1:])
