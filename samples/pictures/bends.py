#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Draws how kelp's two maps bend: bends.png, the three models of Figure 6 bent by 30, 60 and 90 degrees by
both maps, and tentacle.png, an octopus's arm that rolls up among fish and weeds.

python3 samples/pictures/bends.py --bin build/release/bin --models samples/out/models --out samples/out/bends
(programs: kelp-bake, kelp-dump, kelp-render)
"""

import json
import math
import os
import subprocess
import sys

sys.dont_write_bytecode = True  # leave no __pycache__ in the source tree

import figures  # noqa: E402
import lettering  # noqa: E402
import png  # noqa: E402

STRAIGHT, ANGLES = 1e-6, (30, 60, 90)  # degrees
KNOTS = 4
YAWS = (0, 90, 180)  # of each column of Figure 6: from where it bends to the right
# The shear needs a spline that rises: its last tangent points up by a degree.
STEEPEST = {"shear": 89, "sweep": 90}
APART = 1.6  # in heights of the model: how far the two stand apart

# The places of the models, in meters: the first pack, and --and those that follow.
SCENE = (
    ("tentacle", "--at=-0.60,0,0.02 --turn -25 --clip curl --time 0.2"),
    ("tentacle", "--at=-0.36,0,-0.02 --turn -25 --clip curl --time 1.4"),
    ("tentacle", "--at=-0.10,0,0.02 --turn -25 --clip curl --time 1.85"),
    ("tentacle", "--at=0.19,0,-0.02 --turn -25 --clip curl --time 2.5"),
    ("kelp_plant", "--at=0.55,0,-0.04 --scale 0.55 --clip current --time 0.7"),
    ("fusilier", "--at=-0.26,0.61,0.02 --turn 8 --clip swim --time 0.1"),
    ("fusilier", "--at=0.04,0.50,0.10 --turn 318 --clip turn --time 0.33"),
    ("fusilier", "--at=0.33,0.56,-0.1 --turn 25 --clip turn --time 0.64"),
    ("seabed", "--at=0,-0.03,-0.03 --scale 0.62"),
)
LIGHT = "--pitch 12 --background 120,190,210:20,66,98 --soft-shadows 3 --occlusion distances"


def circle(degrees, steepest, right):
    """Keys' values for knots on a circle that turns by so many degrees, as long as the straight spline."""
    turn = math.radians(degrees)
    values = []
    for knot in range(KNOTS):
        at = knot / (KNOTS - 1)
        side, up = (1 - math.cos(at * turn)) / turn, math.sin(at * turn) / turn
        way = min(at * turn, math.radians(steepest))
        values.append({"offset": [side * right[0], up - at, side * right[1]],
                       "tangent": [math.sin(way) * right[0], math.cos(way) - 1, math.sin(way) * right[1]]})
    return values


def rig(bend, right):
    """At rest it stands straight; a second later it is bent by the first angle, and so on."""
    keys = [{"time": time, "knot": knot, target: value}
            for time, degrees in enumerate((STRAIGHT, *ANGLES))
            for knot, values in enumerate(circle(degrees, STEEPEST[bend], right))
            for target, value in values.items()]
    return {"kelp": 1, "bend": bend, "knots": [{"at": knot / (KNOTS - 1)} for knot in range(KNOTS)],
            "clips": {"bend": {"duration": len(ANGLES) + 1, "keys": keys}}}


def bends(studio, side):
    tile, size = (side, side * 5 // 9), figures.letters(side)
    sheet = figures.Sheet(len(figures.COLUMNS), len(ANGLES), tile, size, "two ways to bend",
                          "the same knots, sheared and swept")
    for column, (subject, yaw) in enumerate(zip(figures.COLUMNS, YAWS)):
        # The direction to the right in the picture.
        right = (math.cos(math.radians(yaw)), -math.sin(math.radians(yaw)))
        packs = []
        for bend in STEEPEST:
            path = studio.path("%d_%s.rig.json" % (column, bend))
            with open(path, "w", encoding="ascii") as file:
                json.dump(rig(bend, right), file)
            name, pack = studio.subject(subject, ("--rig", path), "+y")
            packs.append(pack.replace(".kelp", "_%s.kelp" % bend))
            os.replace(pack, packs[-1])
        info = json.loads(studio.run("kelp-dump", "info", "--format", "json", packs[0]))["parts"][0]
        far = APART * info["size"][1] * info["voxel_metres"][1]
        play = ["--clip", "bend"]
        file = studio.render("bends_%d" % column, tile, packs[0], "--yaw", yaw, "--pitch", 8, "--frames",
                             len(ANGLES) + 1, "--background", "214,221,229:250,250,249", *play,
                             "--and", packs[1], *play, "--at=%g,0,%g" % (far * right[0], far * right[1]))
        for row, degrees in enumerate(ANGLES):
            sheet.place(column, row, file.replace(".png", "_%04d.png" % (row + 2)),
                        "%s, by %d degrees" % (name, degrees))
            left, top = sheet.corner(column, row)
            for half, bend in enumerate(STEEPEST):
                lettering.write(sheet.picture, bend, left + size + half * side // 2, top + 2 * size, size,
                                figures.FAINT)
    png.write(studio.path("bends.png"), sheet.picture)


def tentacle(studio, width):
    packs = {name: studio.sample(name) for name in sorted({name for name, _ in SCENE})}
    arguments = [packs[SCENE[0][0]], *LIGHT.split(), "--yaw", 0, *SCENE[0][1].split()]
    for name, words in SCENE[1:]:
        arguments += ["--and", packs[name], *words.split()]
    studio.render("tentacle", (width, width * 4 // 9), *arguments)


def main():
    options = figures.read_options("Draws bends.png and tentacle.png in the folder --out: how models bend.")
    studio = figures.Studio(options)
    bends(studio, options.tile)
    tentacle(studio, options.tile * 15 // 4)
    for name in ("bends.png", "tentacle.png"):
        print(os.path.abspath(studio.path(name)))


if __name__ == "__main__":
    main()
