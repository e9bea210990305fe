// SPDX-License-Identifier: MIT
// The GLSL files of this folder as text, embedded at build time. Static storage, NUL-terminated.
#pragma once

namespace kelp::shaders {

// The tracing core, in this order.
extern const char* const kSpline;  // spline.glsl: a segment of a part's spline, and normals
extern const char* const kCurve;   // curve.glsl: a ray as a curve in the volume, and its steps
extern const char* const kTrace;   // trace.glsl: where a ray first meets a solid voxel
extern const char* const kArc;     // arc.glsl: a ray in one arc of a swept part
extern const char* const kSweep;   // sweep.glsl: rays through swept parts, and kelpTrace for all
// sweep_record.glsl: where arcs come from on the GPU; between the two
extern const char* const kSweepRecord;
extern const char* const kDistance;  // distance.glsl: how far a point is from a part
// instance.glsl: where instances, segments and bricks come from on the GPU
extern const char* const kInstance;
extern const char* const kShading;      // shading.glsl: the material and the normal of a hit
extern const char* const kSurface;      // surface.glsl: the default look, and KelpSurface
extern const char* const kScene;        // scene.glsl: rays for a host's own shaders
extern const char* const kPixel;        // pixel.glsl: the ray of a fragment
extern const char* const kOutput;       // output.glsl: what the framebuffer gets
extern const char* const kFog;          // fog.glsl: light through fog; then one of the next two
extern const char* const kFogSheared;   // fog_sheared.glsl: how rays go through the fog of a sheared part
extern const char* const kFogSwept;     // fog_swept.glsl: and of a swept one
extern const char* const kDebug;        // debug.glsl: what View::debug shows
extern const char* const kVertex;       // draw.vert: rasterizes the proxy box of an instance
extern const char* const kFragment;     // draw.frag: traces, shades, writes depth
extern const char* const kFogFragment;  // fog.frag: draws fog over what is there
extern const char* const kLineVertex;   // lines.vert, lines.frag: lines over the picture
extern const char* const kLineFragment;

}  // namespace kelp::shaders
