# SPDX-License-Identifier: MIT
"""Makes a tapering tentacle of eight bones in Blender that curls, and exports it as an artist would: the
weights are Blender's automatic ones, File > Export > glTF with default settings.

    blender --background --factory-startup --python blender_tentacle.py -- OUT.glb DEGREES

The tentacle stands on the floor and is 2 m high. Each of its bones is 0.25 m long and turns by as much as
DEGREES in the action "curl", the upper ones later.
"""
import math
import sys

import bpy

out, degrees = sys.argv[sys.argv.index("--") + 1:]
BONES, HEIGHT, RINGS = 8, 2.0, 49

bpy.ops.wm.read_factory_settings(use_empty=True)
bpy.ops.mesh.primitive_cone_add(vertices=24, radius1=0.12, radius2=0.03, depth=HEIGHT,
                                location=(0, 0, HEIGHT / 2))
bpy.ops.object.transform_apply(location=True)
tentacle = bpy.context.object
tentacle.name = "Tentacle"
# Rings to bend at.
bpy.ops.object.mode_set(mode="EDIT")
for ring in range(1, RINGS):
    bpy.ops.mesh.select_all(action="SELECT")
    bpy.ops.mesh.bisect(plane_co=(0, 0, HEIGHT * ring / RINGS), plane_no=(0, 0, 1))
bpy.ops.object.mode_set(mode="OBJECT")

bpy.ops.object.armature_add(location=(0, 0, 0))
armature = bpy.context.object
bpy.ops.object.mode_set(mode="EDIT")
bones = armature.data.edit_bones
bones.remove(bones[0])
for i in range(BONES):
    bone = bones.new(f"bone.{i}")
    bone.head, bone.tail = (0, 0, HEIGHT * i / BONES), (0, 0, HEIGHT * (i + 1) / BONES)
    if i > 0:
        bone.parent, bone.use_connect = bones[f"bone.{i - 1}"], True
bpy.ops.object.mode_set(mode="OBJECT")

# The mesh, then the armature, Ctrl P > With Automatic Weights.
bpy.ops.object.select_all(action="DESELECT")
tentacle.select_set(True)
armature.select_set(True)
bpy.context.view_layer.objects.active = armature
bpy.ops.object.parent_set(type="ARMATURE_AUTO")

for i, bone in enumerate(armature.pose.bones):
    bone.rotation_mode = "XYZ"
    for step in range(9):
        turn = 0 if step in (0, 8) else math.sin(math.pi * step / 4 - 0.25 * i)
        bone.rotation_euler = (math.radians(float(degrees)) * turn, 0, 0)
        bone.keyframe_insert("rotation_euler", frame=1 + 6 * step)
armature.animation_data.action.name = "curl"

bpy.context.scene.frame_set(1)
bpy.ops.export_scene.gltf(filepath=out)
