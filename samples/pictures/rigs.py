#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Draws the pictures of tools/rig/LANGUAGE.md: what knots, tangents, waves and keys do to a post whose knots
are painted yellow. Every tile is a rig that kelp-bake has read.

python3 samples/pictures/rigs.py --bin build/release/bin --out samples/out/rigs     (programs: kelp-bake,
kelp-render)
"""

import argparse
import json
import os
import sys

sys.dont_write_bytecode = True  # leave no __pycache__ in the source tree

import figures  # noqa: E402
import png  # noqa: E402

SAND, MOSS, FERN, YELLOW = (0.55, 0.50, 0.42), (0.10, 0.22, 0.12), (0.16, 0.36, 0.18), (1.0, 0.62, 0.05)
HALF = 0.075  # of the post's side, meters; it is 1 m high

BEND = [{"at": 0}, {"at": 0.5, "offset": [0.2, 0, 0]}, {"at": 1}]
SWAY = {"sway": {"waves": [{"knot": 1, "offset": [0.25, 0, 0], "period": 4},
                           {"knot": 1, "tangent": [0.6, 0, 0], "period": 4, "phase": -0.05}]}}
# A wave of 0.14 that runs up once: the knots' places, and the slopes of the same wave there.
RUN = {"run": {"waves": [wave for knot, at in enumerate((0, 0.25, 0.5, 0.75, 1)) for wave in (
    {"knot": knot, "offset": [0.14, 0, 0], "period": 4, "phase": -at},
    {"knot": knot, "tangent": [0.88, 0, 0], "period": 4, "phase": -at - 0.25})]}}
NOD = {"nod": {"duration": 4, "interpolation": "cubic",
               "keys": [{"time": 0, "knot": 1, "offset": [0, 0, 0]},
                        {"time": 1, "knot": 1, "offset": [0.3, -0.15, 0]},
                        {"time": 2, "knot": 1, "offset": [-0.1, 0.1, 0]},
                        {"time": 4, "knot": 1, "offset": [0, 0, 0]}]}}
TWO, FIVE = [{"at": 0}, {"at": 1}], [{"at": at} for at in (0, 0.25, 0.5, 0.75, 1)]
# With ends that stay upright, whatever moves.
UPRIGHT = [{"at": at, "tangent": [0, 1, 0]} for at in (0, 1)]

# Sides of a slab: a third of tangents of the paper's Figure 6 on one edge, and others on the rest.
PAPER = {"knots": [{"at": 0, "tangent": [1, 0, 0.33]}, {"at": 1, "tangent": [1, 0, 0.67]}]}
LEAN = {"knots": [{"at": 0}, {"at": 1, "offset": [-0.25, -0.12, 0.1], "tangent": [-0.5, 0.8, 0.3]}]}
BOW = {"knots": [{"at": 0}, {"at": 0.5, "offset": [0.2, 0, 0.1]}, {"at": 1, "offset": [0, 0.15, 0]}],
       "clips": {"flap": {"waves": [{"knot": 2, "offset": [0.3, 0, -0.1], "period": 4}]}}}
FOUR = {"-x-z": {}, "+x-z": PAPER, "-x+z": LEAN, "+x+z": BOW}

# Sections: a squash that keeps the volume or not; a bulge with a taper; a twist.
SQUASH = [{"at": 0}, {"at": 1, "offset": [0, -0.4, 0]}]
KEPT = [dict(knot, keep_volume=True) for knot in SQUASH]
BULGE = [{"at": 0}, {"at": 0.5, "width": 2}, {"at": 1, "width": [0.5, 1]}]
TURN = {"turn": {"waves": [{"knot": 1, "twist": 180, "period": 4}]}}

# Sheet: title, note, and rows of tiles: what is written below, knots (or sides), clips, and the clip and
# second that are shown.
SHEETS = {
    "rig_knots": ("knots", "the rig at rest", [[
        ("two knots, straight", TWO, {}, None), ("offset (0.2, 0, 0) at 0.5", BEND, {}, None),
        ("the same at 0.25", [BEND[0], {"at": 0.25, "offset": [0.2, 0, 0]}, BEND[2]], {}, None),
        ("last tangent (1.5, 1, 0)", [TWO[0], {"at": 1, "tangent": [1.5, 1, 0]}], {}, None)]]),
    "rig_clips": ("clips", "four moments of each", [
        [("a wave, period 4, at %d s" % t, UPRIGHT, SWAY, ("sway", t)) for t in range(4)],
        [("a wave that runs, at %d s" % t, FIVE, RUN, ("run", t)) for t in range(4)],
        [("cubic keys, at %g s" % t, UPRIGHT, NOD, ("nod", t)) for t in (0, 0.5, 1, 2)]]),
    "rig_sides": ("sides", "a slab whose four edges have splines of their own", [[
        ("straight", {"-x+z": {}}, {}, None),
        ("one edge, level at its ends", {"+x+z": PAPER}, {}, None),
        ("four edges", FOUR, {}, None),
        ("the same in a clip", FOUR, {}, ("flap", 1))]]),
    "rig_sections": ("sections", "widths and twists along the spline", [[
        ("last knot down by 0.4", SQUASH, {}, None), ("the same, its volume kept", KEPT, {}, None),
        ("width 2, then 0.5 and 1", BULGE, {}, None),
        ("twist 180 in a wave, at 1 s", TWO, TURN, ("turn", 1))]]),
}


def write_boxes(path, boxes):
    """An OBJ of boxes (low corner, high corner, color), each closed."""
    name = os.path.splitext(os.path.basename(path))[0]
    colors = sorted({color for _, _, color in boxes})
    with open(path[:-4] + ".mtl", "w", encoding="ascii") as file:
        for i, color in enumerate(colors):
            file.write("newmtl m%d\nKd %g %g %g\n" % (i, *color))
    with open(path, "w", encoding="ascii") as file:
        file.write("mtllib %s.mtl\n" % name)
        for low, high, _ in boxes:
            for corner in range(8):
                file.write("v %g %g %g\n"
                           % tuple((high if corner >> axis & 1 else low)[axis] for axis in range(3)))
        for i, (_, _, color) in enumerate(boxes):
            file.write("usemtl m%d\n" % colors.index(color))
            for face in ((0, 4, 6, 2), (1, 3, 7, 5), (0, 1, 5, 4), (2, 6, 7, 3), (0, 2, 3, 1), (4, 5, 7, 6)):
                file.write("f %d %d %d %d\n" % tuple(8 * i + corner + 1 for corner in face))


def write_post(path, knots):
    """Ten bands of moss and fern, and a wider yellow ring at each knot."""
    boxes = [((-HALF, 0.1 * i, -HALF), (HALF, 0.1 * (i + 1), HALF), (MOSS, FERN)[i % 2]) for i in range(10)]
    for knot in knots:
        middle = min(max(knot["at"], 0.02), 0.98)
        boxes.append(((-1.35 * HALF, middle - 0.02, -1.35 * HALF), (1.35 * HALF, middle + 0.02, 1.35 * HALF),
                      YELLOW))
    write_boxes(path, boxes)


def write_slab(path):
    """A slab of moss and fern, chequered, with yellow edges."""
    boxes = []
    for i in range(6):
        for j in range(10):
            low = (-0.3 + 0.1 * i, 0.1 * j, -0.15)
            boxes.append((low, (low[0] + 0.1, low[1] + 0.1, 0.15), (MOSS, FERN)[(i + j) % 2]))
    for x in (-0.31, 0.28):
        for z in (-0.16, 0.13):
            boxes.append(((x, 0, z), (x + 0.03, 1, z + 0.03), YELLOW))
    write_boxes(path, boxes)


def main():
    parser = figures.Parser(description="Draws rig_knots.png, rig_clips.png, rig_sides.png and "
                                         "rig_sections.png in --out.")
    parser.add_argument("--bin", required=True, help="the folder of kelp-bake and kelp-render")
    parser.add_argument("--out", required=True, help="the folder for packs, tiles and the sheets")
    parser.add_argument("--tile", type=int, default=210, help="the width of a tile in pixels")
    parser.add_argument("--resolution", type=int, default=128, help="voxels along the post")
    options = parser.parse_args()
    studio = figures.Studio(options)
    # The floor is the same in every tile, and so is the camera.
    write_boxes(studio.path("floor.obj"), [((-0.62, -0.04, -0.3), (0.62, 0, 0.3), SAND)])
    floor = studio.bake(studio.path("floor.obj"), "floor", "--rig", "none")
    tile = (options.tile, options.tile * 11 // 10)
    for name, (title, note, rows) in SHEETS.items():
        sheet = figures.Sheet(4, len(rows), tile, figures.letters(options.tile) + 2, title, note)
        for row, tiles in enumerate(rows):
            for column, (label, knots, clips, moment) in enumerate(tiles):
                own = "%s_%d%d" % (name, row, column)
                rig, yaw = {"kelp": 1, "knots": knots, "clips": clips}, 12
                if isinstance(knots, dict):
                    rig, yaw = {"kelp": 1, "sides": knots, "cell": 4}, 30
                    write_slab(studio.path(own + ".obj"))
                else:
                    write_post(studio.path(own + ".obj"), knots)
                    if name == "rig_sections":
                        rig, yaw = dict(rig, bend="cage", cell=4), 30
                with open(studio.path(own + ".rig.json"), "w", encoding="ascii") as file:
                    json.dump(rig, file)
                pack = studio.bake(studio.path(own + ".obj"), own)
                play = ["--clip", moment[0], "--time", moment[1]] if moment else []
                file = studio.render(own, tile, pack, "--yaw", yaw, "--pitch", 8, "--background",
                                     "214,221,229:250,250,249", *play, "--and", floor)
                sheet.place(column, row, file, label)
        png.write(studio.path(name + ".png"), sheet.picture)
        print(os.path.abspath(studio.path(name + ".png")))


if __name__ == "__main__":
    main()
