#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Draws what GALLERY.md shows besides the other sheets: looks.png, light.png, fog.png, texture.png,
slices.png and, where there is an X server (Xvfb), what the programs with a window show: collider.png,
mirror.png, jelly.png, underwater.png and kelp_view.png.

python3 samples/pictures/gallery.py --bin build/release/bin --models samples/out/models --out samples/out/g
(programs: kelp-bake, kelp-dump, kelp-render, and for the windows collider, jelly, mirror, underwater,
kelp-view)
"""

import json
import math
import os
import subprocess
import sys

sys.dont_write_bytecode = True  # leave no __pycache__ in the source tree
HERE = os.path.dirname(os.path.abspath(__file__))
sys.path.append(os.path.join(HERE, "..", "models"))

import bends  # noqa: E402
import figures  # noqa: E402
import noise  # noqa: E402
import png  # noqa: E402

PALE, DEEP = "214,221,229:250,250,249", "120,190,210:20,66,98"


def draw(studio, name, title, note, tiles, shape=1.0):
    """A sheet of one row. tiles: what is written below, and what draws it: arguments of kelp-render, or a
    function that is given the tile's size and returns a file."""
    side = studio.options.tile
    tile = (side, round(side * shape))
    sheet = figures.Sheet(len(tiles), 1, tile, figures.letters(side), title, note)
    for column, (label, what) in enumerate(tiles):
        file = what(tile) if callable(what) else studio.render("%s_%d" % (name, column), tile, *what)
        sheet.place(column, 0, file, label)
    png.write(studio.path(name + ".png"), sheet.picture)


def looks(studio):
    fish = studio.bake(os.path.join(studio.options.models, "fish.glb"), "looks", "--resolution",
                       studio.options.resolution // 4)
    seen = (fish, "--yaw", 25, "--pitch", 8, "--background", DEEP, "--clip", "swim", "--time", 0.2)
    draw(studio, "looks", "three looks, and a coarser level", "voxels larger than pixels", (
        ("gradient", (*seen, "--shading", "gradient")), ("faces", (*seen, "--shading", "faces")),
        ("smooth", (*seen, "--shading", "smooth")),
        ("faces, level 1", (*seen, "--shading", "faces", "--level", 1))), 0.75)


def light(studio):
    orange = studio.bake(os.path.join(studio.options.models, "orange.glb"), "light", "--resolution",
                         studio.options.resolution * 3 // 4)
    seen = (orange, "--yaw", 40, "--pitch", 24, "--background", PALE, "--tangent", "1=0.4,1,0.5", "--offset",
            "2=0.1,-0.05,0.2")
    soft = ("--soft-shadows", 6)
    draw(studio, "light", "light by distances", "exact distances, baked into the pack", (
        ("its own shadow, by rays", seen), ("a soft shadow", (*seen, *soft)),
        ("and less sky in hollows", (*seen, *soft, "--occlusion", "distances")),
        ("distances, on a slice", (*seen, "--view", "distance"))))


def bent(studio, name, source, *options):
    """Packs of one model that a clip bends by 30, 60 and 90 degrees, sheared and swept."""
    packs = []
    for bend in ("shear", "sweep"):
        path = studio.path("%s_%s.rig.json" % (name, bend))
        with open(path, "w", encoding="ascii") as file:
            json.dump(bends.rig(bend, (1, 0)), file)
        packs.append(studio.bake(source, "%s_%s" % (name, bend), "--rig", path, *options))
    return packs


def write_smoke(path, size):
    """A plume that widens as it rises: densities in bytes."""
    wide, high = size, 2 * size
    voxels = bytearray()
    for z in range(wide):
        for y in range(high):
            s = y / (high - 1)
            reach = 0.10 + 0.26 * s ** 0.8
            for x in range(wide):
                dx, dz = (x + 0.5) / wide - 0.5, (z + 0.5) / wide - 0.5
                far = math.hypot(dx, dz) / reach
                dense = 0.0
                if far < 1.35:
                    billow = noise.fractal_noise(5.0 * dx, 8.0 * s - 1.0, 5.0 * dz, 3, 41)
                    dense = noise.smoothstep(0.0, 0.75, 1.0 - far + 1.1 * billow)
                    dense *= noise.smoothstep(1.35, 0.95, far)
                    dense *= noise.smoothstep(0.0, 0.04, s) * (1.0 - 0.75 * s) * noise.smoothstep(1.0, 0.8, s)
                voxels.append(round(255 * min(max(dense, 0.0), 1.0)))
    with open(path, "wb") as file:
        file.write(voxels)
    with open(path + ".json", "w", encoding="ascii") as file:
        json.dump({"size": [wide, high, wide], "type": "u8"}, file)


def fog(studio):
    source = studio.path("smoke.raw")
    write_smoke(source, max(12, studio.options.resolution * 3 // 16))
    sheared, swept = bent(studio, "smoke", source, "--unit", 0.02, "--density", 0.03)
    seen = ("--yaw", 0, "--pitch", 6, "--background", "60,84,110:150,172,190", "--clip", "bend", "--time")
    draw(studio, "fog", "fog bends too", "smoke has densities, no surface", (
        ("straight", (swept, *seen, 0)), ("sheared, by 60 degrees", (sheared, *seen, 2)),
        ("swept, by 60 degrees", (swept, *seen, 2)), ("swept, by 90 degrees", (swept, *seen, 3))), 1.2)


# A vase: half its width at each height, from the foot to the rim and down into the neck.
PROFILE = ((0.0, 0.0), (0.15, 0.0), (0.16, 0.03), (0.12, 0.07), (0.14, 0.14), (0.21, 0.30), (0.24, 0.46),
           (0.21, 0.62), (0.13, 0.76), (0.10, 0.86), (0.13, 0.96), (0.15, 1.0), (0.12, 1.0), (0.08, 0.88),
           (0.06, 0.80), (0.0, 0.80))
SIDES, GLAZE = 72, 512


def glaze(u, v):
    """The vase's painting: u around it, v upwards, both from 0 to 1; linear colors."""
    clay, ink, sea, sand = (noise.srgb(c) for c in ("#f3e6cf", "#1d3a5f", "#2f7fa8", "#c8683c"))
    wave = 0.018 * math.sin(2 * math.pi * 12 * u)
    if 0.30 < v < 0.62:  # fish scales
        row = math.floor((v - 0.30) / 0.04)
        x = (u * 24 + 0.5 * (row % 2)) % 1 - 0.5
        y = (v - 0.30) / 0.04 - row
        return sea if math.hypot(x, y - 0.05) < 0.46 else ink if math.hypot(x, y) < 0.62 else clay
    if abs(v - 0.70 + wave) < 0.012 or abs(v - 0.23 - wave) < 0.012:
        return sand
    if 0.86 < v < 0.94 or 0.06 < v < 0.14:
        return ink if (math.floor(u * 36) + math.floor(v / 0.027)) % 2 else clay
    return ink if v > 0.985 or abs(v - 0.285) < 0.008 or abs(v - 0.635) < 0.008 else clay


def encoded(c):
    """Linear to sRGB."""
    return 12.92 * c if c <= 0.0031308 else 1.055 * c ** (1 / 2.4) - 0.055


def write_vase(path):
    name = os.path.splitext(os.path.basename(path))[0]
    picture = png.Picture(GLAZE, GLAZE)
    for y, row in enumerate(picture.rows):
        for x in range(GLAZE):
            linear = glaze((x + 0.5) / GLAZE, 1 - (y + 0.5) / GLAZE)
            row[3 * x:3 * x + 3] = bytes(round(255 * encoded(c)) for c in linear)
    png.write(path[:-4] + ".png", picture)
    with open(path[:-4] + ".mtl", "w", encoding="ascii") as file:
        file.write("newmtl glaze\nKd 1 1 1\nmap_Kd %s.png\n" % name)
    columns = SIDES + 1
    with open(path, "w", encoding="ascii") as file:
        file.write("mtllib %s.mtl\nusemtl glaze\n" % name)
        for radius, height in PROFILE:
            for side in range(columns):
                angle = 2 * math.pi * (side % SIDES) / SIDES
                file.write("v %.6f %.6f %.6f\nvt %.6f %.6f\n"
                           % (radius * math.cos(angle), height, -radius * math.sin(angle), side / SIDES,
                              height))
        for ring in range(len(PROFILE) - 1):
            for side in range(SIDES):
                low, high = ring * columns + side + 1, (ring + 1) * columns + side + 1
                corners = [low, low + 1, high + 1, high]
                if PROFILE[ring][0] == 0:
                    corners = [corners[0], corners[2], corners[3]]
                elif PROFILE[ring + 1][0] == 0:
                    corners = corners[:3]
                file.write("f %s\n" % " ".join("%d/%d" % (corner, corner) for corner in corners))


def texture(studio):
    source = studio.path("vase.obj")
    write_vase(source)
    sheared, swept = bent(studio, "vase", source)
    seen = ("--yaw", 0, "--pitch", 12, "--background", PALE, "--clip", "bend", "--time")
    draw(studio, "texture", "textures", "the colors of an image, as a palette of 256", (
        ("straight", (swept, *seen, 0)), ("sheared, by 60 degrees", (sheared, *seen, 2)),
        ("swept, by 60 degrees", (swept, *seen, 2)), ("swept, by 90 degrees", (swept, *seen, 3))))


def slices(studio):
    # As large as tiles are, so that a voxel of a slice is a pixel.
    side = studio.options.tile
    orange = studio.bake(os.path.join(studio.options.models, "orange.glb"), "slices", "--resolution",
                         side * 9 // 10)

    def cut(what):
        def make(tile):
            file = studio.path("slice_%s.png" % what)
            studio.run("kelp-dump", "slice", orange, "-o", file, "--axis", "z", "--what", what)
            layer, page = png.read(file), png.Picture(*tile, (255, 255, 255))
            page.paste(layer, (tile[0] - layer.width) // 2, (tile[1] - layer.height) // 2)
            png.write(file, page)
            return file
        return make

    draw(studio, "slices", "slices", "one layer of voxels", (
        ("the model", (orange, "--yaw", 0, "--pitch", 0, "--background", "255,255,255")),
        ("solid, gray inside", cut("occupancy")), ("how far the solid is", cut("clearance"))))


def windows(studio):
    """Draws the windows of programs. Returns the pictures' names."""
    options = studio.options
    packs = {name: studio.bake(os.path.join(options.models, name + ".glb"), name, "--resolution",
                               options.resolution * part // 8)
             for name, part in (("kelp_plant", 8), ("sea_grass", 5), ("dulse", 4),
                                ("fish", 8), ("fusilier", 4))}
    plant, proxy = packs["kelp_plant"], studio.path("proxy.obj")
    studio.run("kelp-dump", "extract", plant, "--proxy", proxy)
    shown = {
        "collider": ("collider", plant, proxy, "--frames", "150"),
        "mirror": ("mirror", plant, "--frames", "20"),
        "underwater": ("underwater", options.out, "--size", "800x450", "--start", "2", "--frames", "1"),
        "kelp_view": ("kelp-view", "--edit", plant, "--frames", "12"),
    }
    made = [name for name, (program, *words) in shown.items() if window(studio, name, program, *words)]
    return made + ["jelly"] if jelly(studio) else made


def jelly(studio):
    """It falls, lands, and stands. False: it cannot be drawn."""
    packs = [studio.bake(os.path.join(studio.options.models, name + ".glb"), name, *more)
             for name, *more in (("jelly", "--resolution", 64, "--bend", "cage", "--cell", 8),
                                 ("plate", "--resolution", 160))]
    moments = ["jelly.%d" % frame for frame in (8, 17, 240)]
    if not all(window(studio, name, "jelly", *packs, "--frames", name[6:]) for name in moments):
        return False
    tiles = [png.read(studio.path(name + ".png")) for name in moments]
    sheet = png.Picture(3 * tiles[0].width, tiles[0].height)
    for i, tile in enumerate(tiles):
        sheet.paste(tile, i * tile.width, 0)
    png.write(studio.path("jelly.png"), sheet)
    return True


def window(studio, name, program, *words):
    """Draws NAME.png, what a program's window shows. False, which is said: it cannot."""
    path = os.path.join(studio.options.bin, program)
    if not os.path.exists(path):
        print("gallery.py: %s is not built, so %s.png is left out" % (path, name), file=sys.stderr)
        return False
    picture = studio.path(name + ".ppm")
    done = subprocess.run(["bash", os.path.join(HERE, "../../tests/samples/with_display.sh"), path,
                           *words, picture], capture_output=True, text=True, check=False)
    if done.returncode or "SKIPPED" in done.stdout:
        print("gallery.py: %s.png is left out: %s" % (name, (done.stderr or done.stdout).strip()),
              file=sys.stderr)
        return False
    subprocess.run([sys.executable, "-B", os.path.join(HERE, "ppm_to_png.py"), picture,
                    studio.path(name + ".png")], check=True)
    return True


SHEETS = {"looks": looks, "light": light, "fog": fog, "texture": texture, "slices": slices}


def main():
    options = figures.read_options(
        "Draws the pictures of GALLERY.md that no other script here draws, in the folder --out.",
        lambda parser: parser.add_argument("--only", choices=[*SHEETS, "windows"],
                                           help="draw one sheet, or the programs with a window"))
    studio = figures.Studio(options)
    made = []
    for name, sheet in SHEETS.items():
        if options.only in (None, name):
            sheet(studio)
            made.append(name)
    if options.only in (None, "windows"):
        made += windows(studio)
    for name in made:
        print(os.path.abspath(studio.path(name + ".png")))


if __name__ == "__main__":
    main()
