# SPDX-License-Identifier: MIT
"""The steps of "From Blender" in tools/rig/LANGUAGE.md, one by one, as an artist would click them.

    blender --background --factory-startup --python blender_steps.py -- FOLDER

Writes FOLDER/empties.glb (knots drawn with empties) and FOLDER/property.glb (a rig as text in a custom
property). The reed is 2 m high, stands beside the origin and is turned about the vertical. Its rig leans to
Blender's +X and +Y.
"""
import math
import sys

import bpy

folder = sys.argv[sys.argv.index("--") + 1]


def new_reed():
    """Step 1: a mesh whose origin is its root, transforms applied, standing somewhere."""
    bpy.ops.wm.read_factory_settings(use_empty=True)
    bpy.ops.mesh.primitive_cylinder_add(vertices=16, radius=0.05, depth=2, location=(0, 0, 1))
    bpy.ops.object.transform_apply(location=True, rotation=True, scale=True)
    reed = bpy.context.object
    reed.name = "Reed"
    reed.location = (1, 0.5, 0)
    return reed


reed = new_reed()
knots = []
for i in range(3):
    # Step 2: Add > Empty > Single Arrow, where the knots are to be; name it.
    bpy.ops.object.empty_add(type="SINGLE_ARROW", location=(1, 0.5, i))
    knot = bpy.context.object
    knot.name = "knot.%d" % i
    # Step 3: the empty, then the mesh, Ctrl P > Object (Keep Transform).
    bpy.ops.object.select_all(action="DESELECT")
    knot.select_set(True)
    reed.select_set(True)
    bpy.context.view_layer.objects.active = reed
    bpy.ops.object.parent_set(type="OBJECT", keep_transform=True)
    knots.append(knot)

# Step 4: move and turn knots; R Y 30 leans the arrow towards +X.
knots[1].location.x += 0.2
knots[1].location.y += 0.1
knots[2].rotation_mode = "XYZ"
knots[2].rotation_euler = (0, math.radians(30), 0)

# Step 5: keys (I > Location), and Push Down in the NLA editor; the track's name is the clip's.
x = knots[2].location.x
for frame, move in ((1, 0), (25, 0.4), (49, 0)):
    knots[2].location.x = x + move
    knots[2].keyframe_insert("location", frame=frame)
knots[2].location.x = x
action = knots[2].animation_data.action
track = knots[2].animation_data.nla_tracks.new()
track.name = "sway"
track.strips.new(action.name, 1, action)
knots[2].animation_data.action = None

# Step 6: File > Export > glTF 2.0, as it comes.
bpy.context.scene.frame_set(1)
bpy.ops.export_scene.gltf(filepath=folder + "/empties.glb")

# The other way: Object Properties > Custom Properties > New, "kelp", a string; Export with Include > Custom
# Properties.
reed = new_reed()
reed["kelp"] = ('{"kelp": 1, "clips": {"sway": '
                '{"waves": [{"knot": 1, "offset": [0.2, 0, -0.05], "period": 3}]}}}')
bpy.ops.export_scene.gltf(filepath=folder + "/property.glb", export_extras=True)
