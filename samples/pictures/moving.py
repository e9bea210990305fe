#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Draws the moving picture of README.md, moving.webp: an octopus, an arm that rolls up, a kelp plant and
fish, in voxels large enough to be seen. It plays for ever, without a jump.

python3 samples/pictures/moving.py --bin build/release/bin --models samples/out/models --out samples/out/m
(programs: kelp-bake, kelp-render; img2webp, of Debian's package webp)
"""

import os
import shutil
import subprocess
import sys

sys.dont_write_bytecode = True  # leave no __pycache__ in the source tree

import figures  # noqa: E402
import png  # noqa: E402

FRAMES, RATE = 72, 12  # pictures, and how many a second: it plays for 6 s
# Voxels along the longest side, in 16ths of --resolution.
VOXELS = {"octopus": 7, "tentacle": 4, "kelp_plant": 6, "fusilier": 3, "seabed": 20}
# Models: the place in meters, the clip, the clip's duration in seconds, and how often it is played.
SCENE = (
    ("octopus", "--at=0.03,0.13,0.1 --turn 10", "idle", 8, 1),
    ("tentacle", "--at=-0.42,-0.01,0.16 --turn -25 --scale 0.95", "curl", 5, 1),
    ("kelp_plant", "--at=0.40,-0.02,-0.10 --scale 0.52", "current", 4, 2),
)
# Fish swim from left to right through the whole picture and beyond: where they are at the beginning, as a
# share of the way, how high, how far in front, and their scale.
FISH, WAY, STROKES = ((0.0, 0.45, -0.26, 1.0), (0.42, 0.37, -0.36, 0.85)), (-0.95, 0.95), 12
STROKE = 0.5  # seconds of the clip "swim"
SEABED = "--at=0,-0.03,-0.15 --scale 0.8"
LOOK = "--shading faces --samples 2 --yaw 0 --pitch 9 --background 120,190,210:20,66,98"
# The seabed keeps the camera where it is. Of what it sees, the middle is shown: left, top, width and height,
# in widths of the whole.
WHOLE, SHOWN = 13 / 36, (0.257, 0.03, 0.489, 0.275)


def frame(studio, packs, share, width):
    """The picture at that share of the loop, cut out of the whole."""
    words = []
    for name, place, clip, duration, times in SCENE:
        words += ["--and", packs[name], *place.split(), "--clip", clip, "--time",
                  "%.6f" % (share * times % 1 * duration)]
    for begin, height, front, scale in FISH:
        at = WAY[0] + (WAY[1] - WAY[0]) * ((share + begin) % 1)
        words += ["--and", packs["fusilier"], "--at=%.5f,%g,%g" % (at, height, front), "--scale", scale,
                  "--clip", "swim", "--time", "%.6f" % (share * STROKES % 1 * STROKE)]
    words += ["--and", packs["seabed"], *SEABED.split()]
    whole = studio.path("whole.png")
    full = round(width / SHOWN[2])
    studio.run("kelp-render", words[1], "-o", whole, "--size", "%dx%d" % (full, round(full * WHOLE)),
               *LOOK.split(), *words[2:])
    seen = png.read(whole)
    left, top = round(SHOWN[0] * full), round(SHOWN[1] * full)
    cut = png.Picture(width, round(SHOWN[3] / SHOWN[2] * width))
    for y, row in enumerate(cut.rows):
        row[:] = seen.rows[top + y][3 * left:3 * (left + width)]
    return cut


def main():
    options = figures.read_options("Draws moving.webp in the folder --out: models that bend, in a loop.",
                                   lambda parser: parser.add_argument(
                                       "--frames", type=int, default=FRAMES,
                                       help="how many pictures of the loop are drawn, from its beginning on"))
    encoder = shutil.which("img2webp")
    if not encoder:
        sys.exit("moving.py: img2webp is not installed; it is in Debian's package webp")
    studio = figures.Studio(options)
    packs = {name: studio.bake(os.path.join(options.models, name + ".glb"), "moving_" + name, "--resolution",
                               max(16, options.resolution * part // 16)) for name, part in VOXELS.items()}
    files = []
    for index in range(options.frames):
        files.append(studio.path("moving_%03d.png" % index))
        png.write(files[-1], frame(studio, packs, index / FRAMES, options.tile * 12 // 5))
    moving = studio.path("moving.webp")
    subprocess.run([encoder, "-loop", "0", "-min_size", "-lossy", "-q", "38", "-m", "6", "-d",
                    str(round(1000 / RATE)), *files, "-o", moving], check=True, capture_output=True)
    print(os.path.abspath(moving))


if __name__ == "__main__":
    main()
