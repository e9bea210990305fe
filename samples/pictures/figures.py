#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Draws Figures 6 and 7 of the paper with kelp's own programs: bakes the models, renders every tile, and lays
out two labeled sheets.

samples/pictures/figures.sh builds all that this needs, and calls it."""

import argparse
import os
import subprocess
import sys

sys.dont_write_bytecode = True  # leave no __pycache__ in the source tree

import lettering  # noqa: E402
import png  # noqa: E402

PAPER, INK, FAINT = (247, 248, 249), (38, 43, 52), (112, 120, 132)

# Figure 6: tangents of the two ends, and from where the pose is seen best (yaw, pitch). The extreme ones are
# many times as wide as the model is high, so they are seen from one end.
REST = None
POSES = (
    ((REST, (30, 12)), (((3, 0, 1), (3, 0, 2)), (30, 12)), (((13, 0, 7), (14, 0, -4)), (70, 20))),
    ((REST, (215, 12)), (((-2, 0, 0), (2, 0, 3)), (215, 12)), (((-40, 0, 0), (20, 0, -13)), (285, 30))),
    ((REST, (20, 12)), (((0, 0, 3), (-3, 0, 4)), (20, 12)), (((0, 0, -3), (-54, 0, -10)), (60, 14))),
)
# Of each column: what it is called, the asset and its color, and the sample model that stands in where there
# are no assets.
COLUMNS = (
    ("an orange", None, None, "orange"),
    ("spot, for the pig", "mesh/common3d/spot.obj", (0.93, 0.60, 0.56), "fish"),
    ("the bunny", "mesh/common3d/stanford-bunny.obj", (0.78, 0.64, 0.50), "kelp_plant"),
)

# Figure 7: where everything stands, in meters. The camera's two places are level with the scene and straight
# above it.
SCENE = (
    ("kelp_plant", "--clip current --time 0.7 --at=-0.6,0,-0.1 --turn 20"),
    ("kelp_plant", "--clip current --time 2.2 --at=0.64,0,-0.22 --turn 200 --scale 0.85"),
    ("fish", "--clip swim --at=0.05,0.64,0.2 --turn 12 --scale 2.4"),
    ("seabed", "--at=0,-0.03,-0.05 --scale 0.84"),
)
MOMENTS = ("at 0 s", "2 s later")  # the clip "current" takes 4 s, and there are two frames
VIEWS = (("from the side", "--yaw 0 --pitch 5"), ("from above", "--yaw 0 --pitch 90"))


class Parser(argparse.ArgumentParser):
    def error(self, message):
        self.exit(1, "%s: %s; see %s --help\n" % (self.prog, message, self.prog))


class Studio:
    """Bakes and renders, each thing once."""

    def __init__(self, options):
        self.options = options
        os.makedirs(options.out, exist_ok=True)

    def path(self, name):
        return os.path.join(self.options.out, name)

    def run(self, program, *arguments):
        command = [os.path.join(self.options.bin, program), *map(str, arguments)]
        done = subprocess.run(command, capture_output=True, text=True, check=False)
        if done.returncode:
            sys.exit("%s: %s\n%s" % (os.path.basename(sys.argv[0]), " ".join(command), done.stderr.strip()))
        return done.stdout

    def bake(self, source, name, *more):
        pack = self.path(name + ".kelp")
        resolution = () if "--resolution" in more else ("--resolution", self.options.resolution)
        self.run("kelp-bake", source, "-o", pack, "--progress", "none", *resolution, *more)
        return pack

    def sample(self, name, *more):
        # The sea floor is large and flat: its edge needs voxels as small as the plants'.
        resolution = ("--resolution", self.options.resolution * 3 // 2) if name == "seabed" else ()
        return self.bake(os.path.join(self.options.models, name + ".glb"),
                         name + ("_straight" if more else ""), *resolution, *more)

    def asset(self, file, color, *more):
        """The mesh in one color: a copy among the results, never in the source tree."""
        name = os.path.splitext(os.path.basename(file))[0]
        with open(self.path(name + ".mtl"), "w", encoding="ascii") as material:
            material.write("newmtl paint\nKd %g %g %g\n" % color)
        with open(os.path.join(self.options.assets, file), encoding="utf-8",
                  errors="replace") as mesh, open(self.path(name + ".obj"), "w", encoding="utf-8") as copy:
            copy.write("mtllib %s.mtl\nusemtl paint\n" % name)
            copy.writelines(line for line in mesh if not line.startswith(("mtllib", "usemtl")))
        return self.bake(self.path(name + ".obj"), name, *more)

    def subject(self, column, more, stand_in_axis):
        """One of COLUMNS: what it is called, and its pack, baked with the options `more`."""
        name, asset, color, stand_in = column
        if asset and os.path.exists(os.path.join(self.options.assets, asset)):
            return name, self.asset(asset, color, *more)
        if asset:
            print("%s: %s is absent, so kelp's own %s stands in; set KELP_ASSETS to a folder that holds it"
                  % (os.path.basename(sys.argv[0]), os.path.join(self.options.assets, asset), stand_in),
                  file=sys.stderr)
            name = {"fish": "a fish", "kelp_plant": "a kelp plant"}[stand_in]
        return name, self.sample(stand_in, *more, "--axis", stand_in_axis if stand_in == "fish" else "+y")

    def render(self, name, size, *arguments):
        self.run("kelp-render", *arguments[:1], "-o", self.path(name + ".png"), "--size", "%dx%d" % size,
                 "--samples", 4, *arguments[1:])
        return self.path(name + ".png")


class Sheet:
    """Tiles in rows, a label under each, a title above."""

    def __init__(self, columns, rows, tile, letters, title, note):
        self.tile, self.gap, self.letters = tile, letters, letters
        self.label, self.head = 3 * self.letters, 4 * self.letters
        self.picture = png.Picture(self.gap + columns * (tile[0] + self.gap),
                                   self.head + rows * (tile[1] + self.label), PAPER)
        base = self.head - 1.5 * self.letters
        lettering.write(self.picture, title, self.gap, base, 1.3 * self.letters, INK, 1.4)
        left = self.picture.width - self.gap - lettering.width(note, self.letters)
        lettering.write(self.picture, note, left, base, self.letters, FAINT)

    def corner(self, column, row):
        return self.gap + column * (self.tile[0] + self.gap), self.head + row * (self.tile[1] + self.label)

    def place(self, column, row, file, label):
        left, top = self.corner(column, row)
        self.picture.paste(png.read(file), left, top)
        size = min(self.letters, self.letters * self.tile[0] / max(1.0, lettering.width(label, self.letters)))
        lettering.write(self.picture, label, left, top + self.tile[1] + 1.8 * self.letters, size, INK)


def letters(side):
    """The height of a tall letter, in pixels."""
    return max(5, side // 28)


def vector(v):
    return "(%s)" % ", ".join(map(str, v))


def figure6(studio, side):
    tile = (side, side * 9 // 10)
    sheet = Sheet(3, 3, tile, letters(side), "figure 6", "models and the tangents of their two ends")
    for column, subject in enumerate(COLUMNS):
        name, pack = studio.subject(subject, ("--rig", "none"), "-x")
        for row, (tangents, (yaw, pitch)) in enumerate(POSES[column]):
            bend = [] if tangents is REST else ["--tangent", "0=%g,%g,%g" % tangents[0], "--tangent",
                                                "1=%g,%g,%g" % tangents[1]]
            file = studio.render("figure6_%d%d" % (row, column), tile, pack, "--yaw", yaw, "--pitch", pitch,
                                 "--background", "214,221,229:250,250,249", *bend)
            sheet.place(column, row, file,
                        name if tangents is REST else "%s  %s" % (vector(tangents[0]), vector(tangents[1])))
    png.write(studio.path("figure6.png"), sheet.picture)


def figure7(studio, side):
    tile = ((3 * side + letters(side)) // 2, side)  # two are as wide as three of Figure 6
    sheet = Sheet(2, 2, tile, letters(side), "figure 7", "water plants in a current, and a fish that swims")
    packs = {name: studio.sample(name) for name in sorted({name for name, _ in SCENE})}
    for row, (seen, camera) in enumerate(VIEWS):
        arguments = [packs[SCENE[0][0]], *camera.split(), "--frames", 2, "--background",
                     "146,203,222:16,60,94", *SCENE[0][1].split()]
        for name, words in SCENE[1:]:
            arguments += ["--and", packs[name], *words.split()]
        file = studio.render("figure7_%d" % row, tile, *arguments)
        for column, moment in enumerate(MOMENTS):
            sheet.place(column, row, file.replace(".png", "_%04d.png" % (column + 1)), seen + ", " + moment)
    png.write(studio.path("figure7.png"), sheet.picture)


def read_options(description, add_more=None):
    """The options of all scripts here; `add_more` adds those of one script to the parser."""
    here = os.path.dirname(os.path.abspath(__file__))
    parser = Parser(description=description)
    parser.add_argument("--bin", required=True, help="the folder of kelp's programs")
    parser.add_argument("--models", required=True,
                        help="the folder of kelp's sample models, made by samples/models/make_models.py")
    parser.add_argument("--out", required=True, help="the folder for packs, tiles and the sheets")
    parser.add_argument("--assets",
                        default=os.environ.get("KELP_ASSETS", os.path.join(here, "../../../shared/assets")),
                        help="the folder of other models; default KELP_ASSETS, or shared/assets "
                             "beside the checkout")
    parser.add_argument("--tile", type=int, default=290, help="the width of a tile in pixels")
    parser.add_argument("--resolution", type=int, default=256,
                        help="voxels along the longest side of a model")
    if add_more:
        add_more(parser)
    options = parser.parse_args()
    options.assets = os.path.normpath(options.assets)
    if options.tile < 40:
        parser.error("--tile: give at least 40, or the labels cannot be read")
    return options


def main():
    options = read_options(
        "Draws Figures 6 and 7 of the paper: figure6.png and figure7.png in the folder --out.")
    studio = Studio(options)
    figure6(studio, options.tile)
    figure7(studio, options.tile)
    for name in ("figure6.png", "figure7.png"):
        print(os.path.abspath(studio.path(name)))


if __name__ == "__main__":
    main()
