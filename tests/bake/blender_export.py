# SPDX-License-Identifier: MIT
"""Makes a reed with three animated knots in Blender and exports it as an artist would: File > Export > glTF,
default settings.

    blender --background --factory-startup --python blender_export.py -- OUT.glb

The reed grows along Blender's z from the floor to 2 m. The empties knot.0, knot.1 and knot.2 stand on its
axis, parented to it. knot.1 and knot.2 move in an NLA track each, both named "sway"; knot.2 also turns by
30 degrees.
"""
import math
import sys

import bpy

out = sys.argv[sys.argv.index("--") + 1]
bpy.ops.wm.read_factory_settings(use_empty=True)

bpy.ops.mesh.primitive_cylinder_add(vertices=16, radius=0.05, depth=2, location=(0, 0, 1))
bpy.ops.object.transform_apply(location=True)  # the origin at the root, where a plant turns
reed = bpy.context.object
reed.name = "Reed"
material = bpy.data.materials.new("stem")
material.use_nodes = True
material.node_tree.nodes["Principled BSDF"].inputs["Base Color"].default_value = (0.1, 0.4, 0.05, 1)
reed.data.materials.append(material)

for i in range(3):
    bpy.ops.object.empty_add(type="SINGLE_ARROW", location=(0, 0, i))
    knot = bpy.context.object
    knot.name = f"knot.{i}"
    knot.parent = reed
    if i == 0:
        continue
    for frame, x, turn in ((1, 0, 0), (25, 0.2 * i, math.radians(30) if i == 2 else 0), (49, 0, 0)):
        knot.location = (x, 0, i)
        knot.rotation_euler = (0, turn, 0)
        knot.keyframe_insert("location", frame=frame)
        knot.keyframe_insert("rotation_euler", frame=frame)
    action = knot.animation_data.action
    track = knot.animation_data.nla_tracks.new()
    track.name = "sway"
    track.strips.new(action.name, 1, action)
    knot.animation_data.action = None

bpy.context.scene.frame_set(1)
bpy.ops.export_scene.gltf(filepath=out)
