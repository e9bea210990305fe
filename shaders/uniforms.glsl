// SPDX-License-Identifier: MIT
// The uniforms of all programs, before all other texts. For OpenGL each is one of its own, and those that a
// program does not use are not there. With KELP_VULKAN they are one block; BINDINGS.md lists the layout, and
// the sets and bindings, which a host may define otherwise.

#ifdef KELP_VULKAN
#extension GL_EXT_samplerless_texture_functions : require
#ifndef KELP_SET
#define KELP_SET 0
#endif
#ifndef KELP_BINDING_UNIFORMS
#define KELP_BINDING_UNIFORMS 0
#endif
#ifndef KELP_BINDING_POOL
#define KELP_BINDING_POOL 1
#endif
#ifndef KELP_BINDING_RECORDS
#define KELP_BINDING_RECORDS 2
#endif
#ifndef KELP_BINDING_SCENE_DEPTH
#define KELP_BINDING_SCENE_DEPTH 3
#endif
#define KELP_LOCATION(n) layout(location = n)  // of what the vertex shader hands on
#define KELP_VERTEX gl_VertexIndex
#define KELP_INSTANCE gl_InstanceIndex
#define KELP_UNIFORM
layout(std140, set = KELP_SET, binding = KELP_BINDING_UNIFORMS) uniform KelpUniforms {
#else
#define KELP_LOCATION(n)
#define KELP_VERTEX gl_VertexID
#define KELP_INSTANCE gl_InstanceID
#define KELP_UNIFORM uniform
#endif
  // Light. A white, diffuse surface that faces the sun sends kelp_sun_color / pi to the eye.
  KELP_UNIFORM vec3 kelp_sun_direction;  // world, unit, towards the sun
  KELP_UNIFORM int kelp_first_instance;  // where this draw's numbers of records begin
  KELP_UNIFORM vec3 kelp_sun_color;
  KELP_UNIFORM bool kelp_motion;  // records hold the frame before, too
  KELP_UNIFORM vec3 kelp_sky_color;
  KELP_UNIFORM bool kelp_depth_only;  // one program for both passes, so that their depths are bit-identical
  KELP_UNIFORM vec3 kelp_ground_color;
  KELP_UNIFORM float kelp_clip_low;  // z / w of the lower clip plane: -1, or 0 with [0, 1]
  KELP_UNIFORM int kelp_scene;       // kelp_scene_depth holds: 0 nothing, 1 depth, 2 reversed depth
  KELP_UNIFORM int kelp_shading;     // kelp::gl::Shading
  KELP_UNIFORM bool kelp_self_shadow;
  KELP_UNIFORM int kelp_occlusion_rays;     // 0 .. 16; 0: none
  KELP_UNIFORM float kelp_occlusion_reach;  // of the part's longest side
  KELP_UNIFORM float kelp_sun_radius;       // of the sun's disc, 1 away; 0: no soft shadows
  KELP_UNIFORM bool kelp_occlusion;
  KELP_UNIFORM bool kelp_display;    // kelp::gl::View::output
  KELP_UNIFORM int kelp_part_count;  // that rays may hit: scene.glsl
  KELP_UNIFORM int kelp_debug;       // kelp::draw::DebugView
#ifdef KELP_VULKAN
};
#endif
