// SPDX-License-Identifier: MIT
// The GLSL files of this folder as text, embedded at build time. Static storage, NUL-terminated.
#pragma once

#include <span>

namespace kelp::shaders {

// The texts of a main file in their order: those that it includes, and its own.
struct Piece {
  const char* line;  // a #line directive, for compilers' messages
  const char* text;  // null: a text of the host's, kelpSurface
};
extern const std::span<const Piece> kVertex;       // draw.vert: rasterizes the proxy box of an instance
extern const std::span<const Piece> kFragment;     // draw.frag: traces, shades, writes depth
extern const std::span<const Piece> kFogFragment;  // fog.frag: draws fog over what is there
extern const std::span<const Piece> kLineVertex;   // lines.vert, lines.frag: lines over the picture
extern const std::span<const Piece> kLineFragment;
extern const std::span<const Piece> kScene;  // scene.glsl: rays for a host's own shaders

// Texts for others, who give them what they need: the tracing core,
extern const char* const kSpline;       // spline.glsl: a segment of a part's spline, and normals
extern const char* const kCurve;        // curve.glsl: a ray as a curve in the volume, and its steps
extern const char* const kTrace;        // trace.glsl: where a ray first meets a solid voxel
extern const char* const kArc;          // arc.glsl: a ray in one arc of a swept part
extern const char* const kSweepRecord;  // sweep_record.glsl: where arcs come from on the GPU
extern const char* const kSweep;        // sweep.glsl: rays through swept parts
extern const char* const kCage;         // cage.glsl: rays through tetrahedra
extern const char* const kCageWalk;     // cage_walk.glsl: walks through caged parts
extern const char* const kCageTree;     // cage_tree.glsl: rays through caged parts, and kelpTrace for all
// and the look.
extern const char* const kUniforms;  // uniforms.glsl
extern const char* const kSurface;   // surface.glsl: the default look, and KelpSurface
extern const char* const kDebug;     // debug.glsl: what View::debug shows

}  // namespace kelp::shaders
