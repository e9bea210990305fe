# SPDX-License-Identifier: MIT
"""check_sheets.py KELP_BAKE SAMPLE: samples/python/sheets.py draws a tube with two joints. Its sheets
have the size that its joints make, and the voxels cover what the skinned triangles beside them cover."""

import os
import subprocess
import sys
import tempfile

TOP = os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__))))
ASSETS = os.environ.get("KELP_ASSETS") or os.path.join(TOP, "../shared/assets")
TILE, MOMENTS, JOINTS = 200, 4, 2


def read(path):
    """A PNG file as kelp.write_png() writes it: no filters."""
    import struct
    import zlib
    import numpy as np
    with open(path, "rb") as file:
        data = file.read()
    width, height = struct.unpack(">II", data[16:24])
    at, packed = 8, b""
    while at < len(data):
        size, = struct.unpack(">I", data[at:at + 4])
        packed += data[at + 8:at + 8 + size] if data[at + 4:at + 8] == b"IDAT" else b""
        at += 12 + size
    rows = np.frombuffer(zlib.decompress(packed), np.uint8).reshape(height, 1 + 3 * width)
    return rows[:, 1:].reshape(height, width, 3)


def main(kelp_bake, sample):
    model = os.path.join(ASSETS, "gltf/skinned/rigged_simple.gltf")
    if not os.path.isfile(model):
        print("SKIPPED: %s is absent; set KELP_ASSETS to a folder that holds it" % model)
        return
    with tempfile.TemporaryDirectory() as folder:
        done = subprocess.run([sys.executable, "-B", sample, kelp_bake, model, folder, "48"],
                              capture_output=True, text=True, timeout=300)
        if "kelp needs NumPy" in done.stderr or "EGL" in done.stderr:
            print("SKIPPED: %s" % done.stderr.strip().splitlines()[-1])
            return
        assert done.returncode == 0, done.stderr
        for name, rows in (("beside", 1), ("animation 0_48", 2 * JOINTS)):
            sheet = read(os.path.join(folder, name + ".png"))
            assert sheet.shape == (rows * TILE, 2 * MOMENTS * TILE, 3), (name, sheet.shape)
            tiles = sheet.reshape(rows, TILE, MOMENTS, 2, TILE, 3)
            voxels = (tiles[:, :, :, 0] != sheet[0, 0]).any(-1)
            triangles = (tiles[:, :, :, 1] != sheet[0, TILE]).any(-1)
            assert triangles.any((1, 3)).all(), "a tile of %s is empty" % name
            share = (voxels & triangles).sum() / (voxels | triangles).sum()
            print("%s: the outlines have %.1f %% in common" % (name, 100 * share))
            assert share > 0.8, "the voxels are not where the triangles are"
            assert (tiles[:, :, 0] != tiles[:, :, 1]).any(), "nothing moves"


if __name__ == "__main__":
    main(*sys.argv[1:])
