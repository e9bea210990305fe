# SPDX-License-Identifier: MIT
"""check_figures.py PICTURES BIN MODELS OUT: runs PICTURES/figures.py and bends.py at a small size without the
paper's models, and looks at all four pictures."""

import os
import shutil
import subprocess
import sys


def tile_of(sheet, box):
    left, top, width, height = box
    return [tuple(sheet.rows[y][3 * x:3 * x + 3]) for y in range(top, top + height)
            for x in range(left, left + width)]


def share_of(pixels, test):
    return sum(1 for pixel in pixels if test(*pixel)) / len(pixels)


def differing(a, b):
    return sum(1 for p, q in zip(a, b) if max(abs(x - y) for x, y in zip(p, q)) > 24) / len(a)


def dark(r, g, b):
    return max(r, g, b) < 120


def coloured(r, g, b):
    return max(r, g, b) - min(r, g, b) > 25


def check_sheet(sheet, columns, tile, letters):
    """The tiles of a sheet, by row and column; there is writing above and under each."""
    head, label, gap = 4 * letters, 3 * letters, letters
    rows = round((sheet.height - head) / (tile[1] + label))
    assert sheet.width == gap + columns * (tile[0]
                                           + gap) and sheet.height == head + rows * (tile[1] + label), (
                                               sheet.width, sheet.height)
    assert share_of(tile_of(sheet, (0, 0, sheet.width, head)), dark) > 0.005, "the title is missing"
    tiles = []
    for row in range(rows):
        for column in range(columns):
            left, top = gap + column * (tile[0] + gap), head + row * (tile[1] + label)
            assert share_of(tile_of(sheet, (left, top + tile[1], tile[0], label)),
                            dark) > 0.01, "a label is missing"
            tiles.append(tile_of(sheet, (left, top, *tile)))
    return tiles


def main(pictures, binaries, models, out):
    sys.path.insert(0, pictures)
    sys.dont_write_bytecode = True
    import png

    shutil.rmtree(out, ignore_errors=True)
    command = [sys.executable, "-B", os.path.join(pictures, "figures.py"), "--bin", binaries, "--models",
               models, "--out", out]
    done = subprocess.run([*command, "--assets", os.path.join(out, "none"), "--tile", "84", "--resolution",
                           "64"], capture_output=True, text=True, timeout=600)
    if "no EGL device" in done.stderr:
        print("SKIPPED: " + done.stderr.strip())
        return
    assert done.returncode == 0, done.stderr
    assert done.stderr.count("stands in; set KELP_ASSETS") == 2, done.stderr
    files = done.stdout.split()
    assert files == [os.path.abspath(os.path.join(out, name))
                     for name in ("figure6.png", "figure7.png")], done.stdout

    # Figure 6: something on every tile, and another pose on each of a column.
    tiles = check_sheet(png.read(files[0]), 3, (84, 75), 5)
    assert len(tiles) == 9
    for tile in tiles:
        assert 0.006 < share_of(tile, coloured) < 0.8, "a model does not fill its tile, or is not there"
    for a, b in ((0, 3), (3, 6), (1, 4), (4, 7), (2, 5), (5, 8)):
        assert differing(tiles[a], tiles[b]) > 0.04, "two poses look the same"

    # Figure 7: plant, fish and sand from both sides; the two moments differ, but not by much.
    tiles = check_sheet(png.read(files[1]), 2, (128, 84), 5)
    assert len(tiles) == 4
    for tile in tiles:
        assert share_of(tile, lambda r, g, b: g > 1.5 * b and g > 0.8 * r) > 0.01, "the plants are missing"
        assert share_of(tile, lambda r, g, b: r > 1.5 * g and r > 2 * b) > 0.0015, "the fish is missing"
        assert share_of(tile, lambda r, g,
                        b: r > 150 and 1.05 * b < r < 1.9 * b) > 0.03, "the sand is missing"
    for a, b in ((0, 1), (2, 3)):
        assert 0.01 < differing(tiles[a], tiles[b]) < 0.4, "the scene does not move"

    # Both ways to bend: in every tile two models, which differ, and from row to row.
    done = subprocess.run([argument.replace("figures.py", "bends.py") for argument in command]
                          + ["--assets", os.path.join(out, "none"), "--tile", "96", "--resolution", "64"],
                          capture_output=True, text=True, timeout=600)
    assert done.returncode == 0, done.stderr
    bends, tentacle = map(png.read, done.stdout.split())
    tiles = check_sheet(bends, 3, (96, 53), 5)
    assert len(tiles) == 9
    halves = [[[p for i, p in enumerate(tile) if i % 96 // 48 == half] for half in (0, 1)] for tile in tiles]
    for half in (0, 1):
        for tile in halves:
            assert share_of(tile[half], coloured) > 0.03, "a model is missing"
        for upper, lower in zip(halves, halves[3:]):
            assert differing(upper[half], lower[half]) > 0.01, "two angles look the same"
    # At 90 degrees the sheared orange is flat, the swept one as thick as ever.
    sheared, swept = (share_of(half, coloured) for half in halves[6])
    assert swept > 1.15 * sheared, (sheared, swept)
    pixels = tile_of(tentacle, (0, 0, tentacle.width, tentacle.height))
    assert share_of(pixels, lambda r, g, b: r > 2 * g and r > 1.5 * b) > 0.006, "the tentacles are missing"
    assert share_of(pixels, lambda r, g, b: g > 1.5 * b and g > 0.8 * r) > 0.01, "the plant is missing"

    # Writing is reading backwards; a failing program is named in one go, without a traceback.
    again = os.path.join(out, "again.png")
    png.write(again, png.read(files[0]))
    assert png.read(again).rows == png.read(files[0]).rows
    done = subprocess.run([*command, "--models", os.path.join(out, "none")], capture_output=True, text=True,
                          timeout=60)
    assert done.returncode == 1 and "none/orange.glb" in done.stderr, done.stderr
    assert "Traceback" not in done.stderr, done.stderr


if __name__ == "__main__":
    main(*sys.argv[1:])
