// SPDX-License-Identifier: MIT
// The programs that kelp draws with: shaders/ put together for the context's dialect of GLSL.
#pragma once

#include <array>

#include "gl_api.h"
#include "kelp/gl/renderer.h"

namespace kelp::gl {

// Texture units of the samplers.
enum Unit : std::int32_t { kPool, kRecords, kScene };

struct Program {
  Name name = 0;
  // Locations; -1 where a host's surface function leaves a uniform unused.
  std::int32_t first_instance = -1, motion = -1, depth_only = -1, clip_low = -1, scene = -1, shading = -1;
  std::int32_t self_shadow = -1, occlusion_rays = -1, occlusion_reach = -1, sun_radius = -1, occlusion = -1;
  std::int32_t display = -1, sun_direction = -1, sun_color = -1, sky_color = -1, ground_color = -1;
};

// Compiles, links and binds the program, and sets the units of its samplers. `surface`: the host's
// kelpSurface. Null: kelp's own. For parts that bend so; where distances shade, for all.
Result<Program> buildProgram(const Api& api, const char* surface, Features features, Bend bend,
                             const Log& log);
// A program for fog that bends so: for parts that have heat too, or with the sun's shadow of fog on itself.
Result<Program> buildFogProgram(const Api& api, Bend bend, bool heat, bool shadow, const Log& log);

// The text of kelp::gl::Renderer::traceGlsl().
using TraceStrings = std::array<const char*, 15>;
TraceStrings traceStrings(const Api& api, Features features);

// The uniforms of a host's program that contains that text; -1: it does not use them.
struct TraceProgram {
  std::int32_t pool = -1, records = -1, first_instance = -1, part_count = -1;
  Program look;  // what a program of kelp's has as well
};
TraceProgram locateTrace(const Api& api, Name program);

}  // namespace kelp::gl
