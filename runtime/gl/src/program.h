// SPDX-License-Identifier: MIT
// The programs that kelp draws with.
#pragma once

#include "gl_api.h"
#include "kelp/gl/renderer.h"
#include "program_text.h"

namespace kelp::gl {

// Gets the message of the GLSL compiler or linker about a program that was refused.
struct LogSink {
  void (*write)(void* user, const char* text) = nullptr;
  void* user = nullptr;
};

// Texture units of the samplers.
enum Unit : std::int32_t { kPool, kRecords, kScene };

struct Program {
  Name name = 0;
  const char* label = nullptr;  // for debuggers: its own, and that of the group of its draws
  // Locations; -1 where a host's surface function leaves a uniform unused.
  std::int32_t first_instance = -1, motion = -1, depth_only = -1, clip_low = -1, scene = -1, shading = -1;
  std::int32_t self_shadow = -1, occlusion_rays = -1, occlusion_reach = -1, sun_radius = -1, occlusion = -1;
  std::int32_t display = -1, sun_direction = -1, sun_color = -1, sky_color = -1, ground_color = -1;
  std::int32_t debug = -1;
};

inline Dialect dialectOf(const Api& api) { return api.es ? Dialect::kEs300 : Dialect::kGl330; }

// Compiles, links and binds the program, and sets the units of its samplers. `surface`: the host's
// kelpSurface. Null: kelp's own. For parts that bend so; where distances shade, for all.
Result<Program> buildProgram(const Api& api, const char* surface, Features features, Bend bend,
                             const LogSink& log);
// A program for fog that bends so: for parts that have heat too, or with the sun's shadow of fog on itself.
Result<Program> buildFogProgram(const Api& api, Bend bend, bool heat, bool shadow, const LogSink& log);

// Builds a program that is not built yet.
template <class Build>
Result<void> buildOnce(Program& program, Build&& build) {
  if (program.name != 0) return {};
  const auto built = build();
  if (!built) return built.error();
  program = *built;
  return {};
}

// What View::debug draws with instead, and in addition: colors of solids of either bend, and of fog; lines.
Result<Program> buildDebugProgram(const Api& api, const LogSink& log);
Result<Program> buildDebugFogProgram(const Api& api, Bend bend, const LogSink& log);
Result<Program> buildLineProgram(const Api& api, const LogSink& log);

// Sets the uniforms of the look, in the program in use.
void setLook(const Api& api, const Program& program, const View& view);

// The uniforms of a host's program that contains Renderer::traceGlsl(); -1: it does not use them.
struct TraceProgram {
  std::int32_t pool = -1, records = -1, first_instance = -1, part_count = -1;
  Program look;  // what a program of kelp's has as well
};
TraceProgram locateTrace(const Api& api, Name program);

}  // namespace kelp::gl
