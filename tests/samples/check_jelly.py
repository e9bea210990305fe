# SPDX-License-Identifier: MIT
"""Usage: check_jelly.py measures|window PROGRAM KELP_BAKE MODELS

Bakes a jelly and a plate.
measures: the jelly falls without a window. It carries the mass of its voxels; its energy does not grow; at
  rest, and after a push, it has its shape to a voxel.
window: it is drawn above the plate, flatter as it lands, and at rest; one that explodes is left out, its
  plate is not, the reason is told once, and the game begins again."""

import os
import re
import subprocess
import sys
import tempfile

from check_picture import expect, is_red, read_ppm


def bake(program, models, folder):
    packs = []
    for name, *options in (("jelly", "--resolution", "64", "--bend", "cage", "--cell", "8"),
                           ("plate", "--resolution", "160")):
        packs.append(os.path.join(folder, name + ".kelp"))
        subprocess.run([program, os.path.join(models, name + ".glb"), "-o", packs[-1], "--progress", "none",
                        *options], check=True, timeout=300, capture_output=True)
    return packs


def run(*command):
    return subprocess.run(command, check=True, timeout=300, capture_output=True, text=True)


def check_measures(program, packs, folder):
    text = run(program, *packs, "--measure").stdout
    nodes, edges, mass = re.match(r"(\d+) nodes, (\d+) edges, ([\d.]+) kg", text).groups()
    assert int(edges) > 3 * int(nodes) > 600, text
    # A frustum with these radii has 0.0184 cubic meters; flutes and the dent take some of that.
    assert 14 < float(mass) < 21, "the nodes do not carry the jelly: %s kg" % mass
    seconds = re.findall(r"^ *(\d+) s: energy ([\d.]+) J, strain ([\d.]+) voxels$", text, re.M)
    energies = [float(energy) for _, energy, _ in seconds]
    assert len(seconds) == 10 and energies[0] < 40 and abs(energies[9] - energies[5]) < 0.01, text
    rise, strain = re.search(r"energy rose by ([\d.]+) % .* strain at rest ([\d.]+)", text).groups()
    assert float(rise) < 0.5 and 0 < float(strain) < 1, text
    pushed, later = re.search(r"pushed: strain ([\d.]+) voxels, three seconds later ([\d.]+)", text).groups()
    assert float(pushed) > 4 and float(later) < 1, text

    expect([program, packs[1], packs[1], "--measure"], 3, "cage")
    expect([program, os.path.join(folder, "absent.kelp"), packs[1], "--measure"], 2, "absent.kelp")
    expect([program, packs[0]], 1, "usage")
    expect([program, *packs, "--frames", "none"], 1, "usage")


def red_box(path):
    """Width and height of what is red, and where it begins from the top."""
    width, height, pixels = read_ppm(path)
    red = [(i % width, i // width) for i, pixel in enumerate(pixels) if is_red(*pixel)]
    china = sum(min(pixel) > 170 for pixel in pixels)
    if not red:
        return 0, 0, 0, china
    x, y = zip(*red)
    return max(x) - min(x), max(y) - min(y), min(y), china


def check_window(program, packs, folder):
    picture = os.path.join(folder, "picture.ppm")
    falling, landed, still, strains = [], [], [], []
    for frames, box in ((8, falling), (17, landed), (240, still)):
        done = run(program, *packs, "--frames", str(frames), picture)
        assert "left out of 0 frames" in done.stdout and not done.stderr, done.stdout + done.stderr
        box += red_box(picture)
        strains.append(float(re.search(r"strain ([\d.]+) voxels", done.stdout)[1]))
    assert falling[0] > 100 and falling[2] < still[2] - 40, "it does not fall: %s, %s" % (falling, still)
    assert strains[0] < 0.1 and strains[1] > 5 and strains[2] < 1, strains
    assert landed[0] / landed[1] > 1.05 * still[0] / still[1], "it is not squashed: %s, %s" % (landed, still)
    assert min(box[3] for box in (falling, landed, still)) > 5000, "the plate is missing"

    done = run(program, *packs, "--explode", "5", "--frames", "20", picture)
    assert "left out of 16 frames" in done.stdout, done.stdout
    assert done.stderr.count("left out") == 1 and "node" in done.stderr, done.stderr
    assert red_box(picture)[0] == 0 and red_box(picture)[3] > 5000, "the jelly is drawn, or its plate is not"
    done = run(program, *packs, "--explode", "5", "--frames", "42", picture)
    assert "left out of 30 frames" in done.stdout and red_box(picture)[0] > 100, "it does not begin again"


def main(part, program, baker, models):
    with tempfile.TemporaryDirectory() as folder:
        packs = bake(baker, models, folder)
        {"measures": check_measures, "window": check_window}[part](program, packs, folder)


if __name__ == "__main__":
    main(*sys.argv[1:])
