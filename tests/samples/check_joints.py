# SPDX-License-Identifier: MIT
"""check_joints.py KELP_BAKE SAMPLE MODELS: bakes the octopus, and lets samples/python/joints.py move its
joints by the matrices of its glTF file. The voxels cover what the skinned triangles cover."""

import os
import re
import subprocess
import sys
import tempfile


def run(*command):
    done = subprocess.run(command, capture_output=True, text=True, timeout=300)
    if "kelp needs NumPy" in done.stderr or "EGL" in done.stderr:
        print("SKIPPED: %s" % done.stderr.strip().splitlines()[-1])
        sys.exit(0)
    assert done.returncode == 0, (command, done.stderr)
    return done.stdout


def main(kelp_bake, sample, models):
    model = os.path.join(models, "octopus.glb")
    with tempfile.TemporaryDirectory() as folder:
        pack, pictures = os.path.join(folder, "octopus.kelp"), set()
        run(kelp_bake, model, "-o", pack, "--resolution", "96")
        for clip, seconds in (("swim", "0"), ("swim", "0.9"), ("idle", "3")):
            picture = os.path.join(folder, "octopus.png")
            said = run(sys.executable, "-B", sample, model, pack, picture, clip, seconds)
            print(clip, seconds, said.strip())
            share = float(re.search(r"([0-9.]+) %", said).group(1))
            assert share > 88, "the voxels are not where the triangles are"
            with open(picture, "rb") as file:
                pictures.add(file.read())
        assert len(pictures) == 3, "the joints do not move"


if __name__ == "__main__":
    main(*sys.argv[1:])
