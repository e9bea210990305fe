# SPDX-License-Identifier: MIT
"""Usage: sheets.py KELP_BAKE MODEL.gltf|.glb OUT [RESOLUTION...]

Contact sheets of a skinned glTF file in the folder OUT, as PNG: packs that play the file's clips, beside the
file's skinned triangles (gray). beside.png: all of the model at 128 voxels, a row a clip. The others, named
CLIP_RESOLUTION.png, at 96, 128 and 256 voxels or as given: two rows a joint, in the skin's order, seen from
two sides."""
import os
import subprocess
import sys
import tempfile

import joints
import kelp
import numpy as np

TILE, MOMENTS = (200, 200), 4
BACKGROUND = (0.85, 0.87, 0.9, 1)


class Stage:
    """A pack and the model that it was baked from."""

    def __init__(self, canvas, model, pack):
        self.model, self.asset = model, kelp.Asset(pack)
        self.asset.load_all()
        self.renderer = kelp.Renderer(canvas)
        self.renderer.add(self.asset)
        self.pose = kelp.Pose(self.asset)
        self.instance = kelp.Instance(self.asset, self.pose)

    def play(self, clip, seconds):
        """Returns the places of the skin's joints."""
        self.pose.reset()
        self.pose.add_clip(clip, seconds)
        animation = self.model.json["animations"][clip]
        worlds = self.model.worlds(animation, seconds)
        self.triangles = self.model.skinned(worlds)
        moved = {joint: worlds[joint][:3, 3] for skin in self.model.json["skins"] for joint in skin["joints"]}
        return list(moved.values())

    def pair(self, target, eye, angle):
        """The pack, and beside it the triangles, in a field of view of `angle`."""
        view = kelp.View.look_at(TILE, eye=eye, target=target, field_of_view=angle)
        pack = np.asarray(self.renderer.picture(view, self.instance, background=BACKGROUND))[..., :3]
        return np.concatenate([pack, joints.draw(self.triangles, view, BACKGROUND)], 1)


def views(places, middle):
    """Where to look, from where, and an angle: each joint from outside, to the left and to the right."""
    for place in places:
        away = place - middle
        yaw = np.arctan2(away[0], away[2])
        for turn, up in ((yaw - 0.8, 0.3), (yaw + 0.8, -0.2)):
            yield place, np.array((np.sin(turn), up, np.cos(turn))), 0.22


def draw(stage, clip, size, of_joints):
    """A picture of a clip: a column a moment, a row for the model, or two for each joint."""
    columns = []
    for moment in range(MOMENTS):
        places = stage.play(clip, stage.asset.clips[clip].duration * moment / MOMENTS)
        middle = stage.instance.bounds().mean(0)
        shots = views(places, middle) if of_joints else [(middle, np.array((0.7, 0.3, 0.6)), 0.6)]
        columns.append(np.concatenate([stage.pair(at, at + 1.5 * size * away, angle)
                                       for at, away, angle in shots]))
    return np.concatenate(columns, 1)


def main(kelp_bake, model_path, out, *resolutions):
    model = joints.Model(model_path)
    with tempfile.TemporaryDirectory() as folder, kelp.Canvas(*TILE) as canvas:
        def bake(resolution):
            pack = os.path.join(folder, resolution + ".kelp")
            subprocess.run([kelp_bake, model_path, "-o", pack, "--resolution", resolution], check=True,
                           stderr=subprocess.DEVNULL)
            return Stage(canvas, model, pack)

        stage = bake("128")
        size, clips = np.linalg.norm(np.diff(stage.instance.bounds(), axis=0)), range(len(stage.asset.clips))
        kelp.write_png(os.path.join(out, "beside.png"),
                       np.concatenate([draw(stage, clip, size, False) for clip in clips]))
        for resolution in resolutions or ("96", "128", "256"):
            stage = bake(resolution)
            for clip in clips:
                kelp.write_png(os.path.join(out, "%s_%s.png" % (stage.asset.clips[clip].name, resolution)),
                               draw(stage, clip, size, True))


if __name__ == "__main__":
    if len(sys.argv) < 4:
        sys.exit(__doc__)
    main(*sys.argv[1:])
