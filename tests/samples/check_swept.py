# SPDX-License-Identifier: MIT
"""check_swept.py BIN MODELS PICTURES: bakes the sample models that are swept and verifies their packs. Then
it looks at pictures of them: bent as far as their clips bend them, they cover as much of the picture as at
rest, because they keep length and thickness. PICTURES is samples/pictures. Without kelp-render in BIN, or
without EGL, no pictures are looked at."""

import json
import os
import subprocess
import sys
import tempfile

# The clip that bends far; from where its bend is seen square; frames: at rest, and bent the farthest.
MODELS = {
    "tentacle": ("curl", ("--yaw", "0", "--pitch", "0", "--frames", "2"), 1, 2),
    "fusilier": ("turn", ("--yaw", "0", "--pitch", "90", "--time", "0.3333", "--frames", "3"), 3, 1),
}
SKY = (40, 80, 255)


def run(*command, code=0):
    done = subprocess.run(command, capture_output=True, text=True, timeout=300)
    assert done.returncode == code, (command, done.returncode, done.stderr)
    return done.stdout + done.stderr


def covered(picture):
    """Where there is no sky: the number of pixels, and the box around them."""
    found = [(x, y) for y, row in enumerate(picture.rows) for x in range(picture.width)
             if tuple(row[3 * x:3 * x + 3]) != SKY]
    xs, ys = zip(*found)
    return len(found), max(xs) - min(xs) + 1, max(ys) - min(ys) + 1


def check_pack(binaries, model, pack, clip, folder):
    """The pack is sound and swept. Returns the rig that it holds."""
    dump = os.path.join(binaries, "kelp-dump")
    assert "sound" in run(dump, "verify", "--deep", pack)
    rig = json.loads(run(dump, "rig", pack))
    assert rig["bend"] == "sweep" and clip in rig["clips"], rig
    if clip == "curl":  # cannot be sheared: the spline turns back
        rig["bend"] = "shear"
        path = os.path.join(folder, "sheared.rig.json")
        with open(path, "w", encoding="ascii") as file:
            json.dump(rig, file)
        said = run(os.path.join(binaries, "kelp-bake"), model, "--rig", path, "-o",
                   os.path.join(folder, "sheared.kelp"), "--resolution", "32", code=3)
        assert "'curl'" in said and "turns back" in said, said


def check_pictures(render, pack, clip, view, rest, bent, png):
    sheet = pack.replace(".kelp", ".png")
    run(render, pack, "-o", sheet, "--clip", clip, "--size", "360x360", "--samples", "1",
        "--background", ",".join(map(str, SKY)), *view)
    (area, width, height), (bent_area, bent_width, bent_height) = (
        covered(png.read(sheet.replace(".png", "_%04d.png" % frame))) for frame in (rest, bent))
    print("%s: %d x %d pixels, %d covered; bent %d x %d, %d covered"
          % (clip, width, height, area, bent_width, bent_height, bent_area))
    assert abs(bent_area / area - 1) < 0.03, "it does not keep its size"
    assert max(bent_width, bent_height) < 0.92 * max(width, height), "it is not bent"


def main(binaries, models, pictures):
    sys.path.insert(0, pictures)
    sys.dont_write_bytecode = True
    import png

    render = os.path.join(binaries, "kelp-render")
    with tempfile.TemporaryDirectory() as folder:
        packs = {name: os.path.join(folder, name + ".kelp") for name in MODELS}
        for name, pack in packs.items():
            model = os.path.join(models, name + ".glb")
            run(os.path.join(binaries, "kelp-bake"), model, "-o", pack, "--resolution", "128")
            check_pack(binaries, model, pack, MODELS[name][0], folder)
        if not os.path.exists(render):
            print("SKIPPED: no kelp-render for the pictures")
            return
        done = subprocess.run([render, packs["tentacle"], "-o", os.path.join(folder, "try.png"), "--size",
                               "8x8"], capture_output=True, text=True, timeout=300)
        if "no EGL device" in done.stderr:
            print("SKIPPED: " + done.stderr.strip())
            return
        for name, pack in packs.items():
            check_pictures(render, pack, *MODELS[name], png)


if __name__ == "__main__":
    main(*sys.argv[1:])
