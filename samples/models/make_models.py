#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Makes kelp's sample models, each as NAME.glb with its rig or its skin: see MODELS. Needs nothing but Python
3."""

import os
import sys

sys.dont_write_bytecode = True  # leave no __pycache__ in the source tree

import dulse  # noqa: E402
import fish  # noqa: E402
import fusilier  # noqa: E402
import glb  # noqa: E402
import jelly  # noqa: E402
import kelp_plant  # noqa: E402
import octopus  # noqa: E402
import orange  # noqa: E402
import plate  # noqa: E402
import sea_grass  # noqa: E402
import seabed  # noqa: E402
import tentacle  # noqa: E402

MODELS = {"kelp_plant": kelp_plant, "sea_grass": sea_grass, "dulse": dulse, "orange": orange, "fish": fish,
          "fusilier": fusilier, "tentacle": tentacle, "octopus": octopus, "seabed": seabed, "jelly": jelly,
          "plate": plate}


def main(arguments):
    if len(arguments) != 1 or arguments[0].startswith("-"):
        print("usage: make_models.py FOLDER\nWrites %s into FOLDER, which is made if need be."
              % ", ".join(name + ".glb" for name in MODELS),
              file=sys.stdout if arguments in (["-h"], ["--help"]) else sys.stderr)
        return 0 if arguments in (["-h"], ["--help"]) else 1
    try:
        os.makedirs(arguments[0], exist_ok=True)
        for name, model in MODELS.items():
            path = os.path.join(arguments[0], name + ".glb")
            surfaces = model.surfaces()
            if hasattr(model, "skeleton"):
                glb.write(path, name, surfaces, skeleton=model.skeleton())
            else:
                glb.write(path, name, surfaces, rig=model.rig())
            print("%s: %d triangles" % (path, sum(len(mesh.triangles) for _, _, mesh in surfaces)))
    except OSError as error:
        print("make_models.py: %s: %s; give a folder that can be written" % (error.filename, error.strerror),
              file=sys.stderr)
        return 2
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
