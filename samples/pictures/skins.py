#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Draws how skinned models play: contact sheets of the sample model octopus and, where their files are, of
CesiumMan as he walks and of greenman as he attacks.

python3 samples/pictures/skins.py --bin build/release/bin --models samples/out/models --out samples/out/skins
(programs: kelp-bake, kelp-dump, kelp-render)
"""

import json
import os
import sys

sys.dont_write_bytecode = True  # leave no __pycache__ in the source tree

import figures  # noqa: E402
import png  # noqa: E402

# Of each sheet: the sample model, or the asset; the title; its clips: their names, what is written under the
# pictures, and from where they are seen; how many moments of each are shown, from its beginning on; a tile's
# height in tiles' widths.
SHEETS = {
    "octopus": ("octopus", "an octopus", (("swim", "swims", "--yaw 10 --pitch 12"),
                                          ("idle", "idles", "--yaw 10 --pitch 20")), 4, 0.9),
    "cesium_man": ("gltf/skinned/CesiumMan.glb", "cesium man",
                   (("animation 0", "walks", "--yaw 60 --pitch 10"),), 8, 1.5),
    "greenman": ("gltf/skinned/greenman.glb", "greenman",
                 (("3_attack", "attacks", "--yaw 30 --pitch 10"),), 8, 0.9),
}
BACKGROUND = "214,221,229:250,250,249"


def pack_of(studio, name, source):
    """The baked model, or None where the asset is absent."""
    if not source.endswith(".glb"):
        return studio.sample(source)
    path = os.path.join(studio.options.assets, source)
    if os.path.exists(path):
        return studio.bake(path, name)
    print("skins.py: %s is absent, so %s.png is left out; set KELP_ASSETS to a folder that holds it"
          % (path, name), file=sys.stderr)
    return None


def draw(studio, name):
    """Draws a sheet of four columns. Returns whether there was something to draw."""
    source, title, clips, moments, shape = SHEETS[name]
    pack = pack_of(studio, name, source)
    if not pack:
        return False
    lengths = {clip["name"]: clip["duration"] for clip in
               json.loads(studio.run("kelp-dump", "info", "--format", "json", pack))["clips"]}
    side = studio.options.tile
    tile, rows = (side, round(side * shape)), moments // 4
    sheet = figures.Sheet(4, rows * len(clips), tile, figures.letters(side), title, "its joints move a cage")
    for index, (clip, called, camera) in enumerate(clips):
        file = studio.render("%s_%d" % (name, index), tile, pack, "--clip", clip, "--frames", moments,
                             *camera.split(), "--background", BACKGROUND)
        for moment in range(moments):
            sheet.place(moment % 4, index * rows + moment // 4,
                        file.replace(".png", "_%04d.png" % (moment + 1)),
                        "%s, at %.2f s" % (called, lengths[clip] * moment / moments))
    png.write(studio.path(name + ".png"), sheet.picture)
    return True


def main():
    options = figures.read_options(
        "Draws octopus.png, cesium_man.png and greenman.png in the folder --out: skinned models that play.")
    studio = figures.Studio(options)
    for name in SHEETS:
        if draw(studio, name):
            print(os.path.abspath(studio.path(name + ".png")))


if __name__ == "__main__":
    main()
