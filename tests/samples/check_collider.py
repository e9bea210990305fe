# SPDX-License-Identifier: MIT
"""Usage: check_collider.py PROGRAM KELP_DUMP PACK

Makes a proxy of the kelp plant and lets balls fall on it. They must touch it, and the picture must show the
plant to the left, the proxy of the same shape to the right, and balls on both sides."""

import os
import subprocess
import sys
import tempfile

from check_picture import expect, is_olive, is_red, read_ppm, share


def main(program, dump, pack):
    with tempfile.TemporaryDirectory() as folder:
        proxy, picture = os.path.join(folder, "proxy.obj"), os.path.join(folder, "picture.ppm")
        subprocess.run([dump, "extract", pack, "--proxy", proxy], check=True, timeout=300)
        done = subprocess.run([program, pack, proxy, "--frames", "40", picture], check=True, timeout=300,
                              capture_output=True, text=True)
        triangles, touches = (int(word) for word in done.stdout.split() if word.isdigit())
        with open(proxy) as file:
            assert triangles == sum(line.startswith("f ") for line in file)
        assert touches > 20, "the balls fall through: %d touches" % touches
        width, height, pixels = read_ppm(picture)
        left = [pixels[width * y + x] for y in range(height) for x in range(width // 2)]
        right = [pixels[width * y + x] for y in range(height) for x in range(width // 2, width)]
        assert share(left, is_olive) > 0.02, "the plant is missing"
        assert share(left, is_red) > 0.005 and share(right, is_red) > 0.005, "the balls are missing"

        def is_water(r, g, b):
            return max(abs(r - 148), abs(g - 188), abs(b - 200)) <= 3
        differ = sum(is_water(*a) != is_water(*b) for a, b in zip(left, right)) / len(left)
        covered = 1 - share(left, is_water)
        assert differ < 0.3 * covered, "the proxy has another shape: %.3f of %.3f" % (differ, covered)

        expect([program, pack, os.path.join(folder, "absent.obj"), "--frames", "1"], 2, "absent.obj")
        expect([program, os.path.join(folder, "absent.kelp"), proxy, "--frames", "1"], 2, "absent.kelp")
        expect([program, pack, "--frames", "none"], 1, "usage")


if __name__ == "__main__":
    main(*sys.argv[1:])
