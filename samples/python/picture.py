# SPDX-License-Identifier: MIT
"""Usage: picture.py PACK.kelp PICTURE.png: a quarter of a second into its first clip, without a window."""
import sys
import kelp
import numpy

_, pack, picture = sys.argv
with kelp.Canvas(640, 480) as canvas, kelp.Asset(pack) as asset:
    pose = kelp.Pose(asset)
    if asset.clips:
        pose.add_clip(0, seconds=0.25)
    model = kelp.Instance(asset, pose)
    low, high = model.bounds()
    middle, far = (low + high) / 2, 1.2 * numpy.linalg.norm(high - low)
    asset.load_all()
    print(kelp.raycast(model, middle + (0, 0, far), (0, 0, -1)))
    renderer = kelp.Renderer(canvas)
    renderer.add(asset)
    view = kelp.View.look_at((640, 480), eye=middle + (0, 0, far), target=middle)
    kelp.write_png(picture, renderer.picture(view, model, background=(0.2, 0.3, 0.4, 1)))
