#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""ppm_to_png.py IN.ppm OUT.png: a picture that a sample saved with --frames, as one that everything opens."""

import sys

sys.dont_write_bytecode = True  # leave no __pycache__ in the source tree

import png  # noqa: E402


def main(arguments):
    if len(arguments) != 2:
        print(__doc__, file=sys.stderr)
        return 1
    try:
        with open(arguments[0], "rb") as file:
            magic, size, depth, pixels = file.read().split(b"\n", 3)
        width, height = map(int, size.split())
        if magic != b"P6" or depth != b"255" or len(pixels) != 3 * width * height:
            raise ValueError
        picture = png.Picture(width, height)
        picture.rows = [bytearray(pixels[3 * width * y:3 * width * (y + 1)]) for y in range(height)]
        png.write(arguments[1], picture)
    except OSError as error:
        print("ppm_to_png.py: %s: %s" % (error.filename, error.strerror), file=sys.stderr)
        return 2
    except ValueError:
        print("ppm_to_png.py: %s: is no binary PPM picture of 8 bits" % arguments[0], file=sys.stderr)
        return 3
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
