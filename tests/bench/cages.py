#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""What cages with cells of 8 take of models' voxels, in memory and in the pack. README.md here.

tests/bench/cages.py build/release ASSETS [RESOLUTION...]"""

import json
import os
import subprocess
import sys
import tempfile

import budget

MODELS = {"bunny": "mesh/common3d/stanford-bunny.obj", "spot": "mesh/common3d/spot.obj",
          "Fox": "gltf/draco_testdata/Fox/Fox.gltf", "fish": "gltf/aquarium/fish.glb"}


def comb(path, teeth=9):
    """A bar with teeth as wide as the gaps between them."""
    boxes = [(0, 2 * teeth - 1, 1)] + [(2 * i, 1, 6) for i in range(teeth)]
    with open(path, "w") as file:
        for i, (at, x, y) in enumerate(boxes):
            for corner in range(8):
                file.write("v %d %d %d\n" % (at + x * (corner & 1), y * (corner >> 1 & 1), corner >> 2))
            for face in ("1342", "5687", "1265", "3784", "1573", "2486"):
                file.write("f %s\n" % " ".join(str(int(c) + 8 * i) for c in face))


def run(*words):
    return subprocess.run(words, check=True, stdout=subprocess.PIPE, stderr=subprocess.PIPE).stdout


def main(build, assets, resolutions):
    kelp = budget.load(os.path.join(build, "runtime/c/libkelp.so"))
    print("%-12s %8s %8s %8s %10s %8s %10s %8s"
          % ("", "cells", "pieces", "nodes", "memory", "of it", "pack", "of it"))
    with tempfile.TemporaryDirectory() as folder:
        pack, made = os.path.join(folder, "out.kelp"), os.path.join(folder, "comb.obj")
        comb(made)
        files = {name: os.path.join(assets, path) for name, path in MODELS.items()}
        for name, path in {**files, "comb": made}.items():
            for resolution in resolutions:
                run(os.path.join(build, "bin/kelp-bake"), path, "-o", pack, "--resolution", str(resolution),
                    "--rig", "none", "--bend", "cage")
                info = json.loads(run(os.path.join(build, "bin/kelp-dump"), "info", "--format", "json", pack))
                cages = info["parts"][0]["cage"]["cages"]
                stored = {chunk["kind"]: chunk["stored_bytes"] for chunk in info["chunks"]}
                memory = sum(cage["memory_bytes"] for cage in cages)
                voxels = budget.measure(kelp, pack, False)[0]
                print("%-12s %8d %8d %8d %10d %7.1f%% %10d %7.1f%%" % (
                    "%s %d" % (name, resolution), cages[0]["cells"], cages[0]["pieces"], cages[0]["nodes"],
                    memory, 100 * memory / voxels, stored["CAGE"],
                    100 * stored["CAGE"] / (stored["BRCK"] + stored["GRID"])), flush=True)


if __name__ == "__main__":
    if len(sys.argv) < 3:
        sys.exit(__doc__)
    main(sys.argv[1], sys.argv[2], [int(word) for word in sys.argv[3:]] or [64, 128, 256, 512])
