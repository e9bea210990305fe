// SPDX-License-Identifier: MIT
// The programs that kelp draws with.
#pragma once

#include "gl_api.h"
#include "kelp/draw/program_text.h"
#include "kelp/gl/renderer.h"

namespace kelp::gl {

// Texture units of the samplers.
enum Unit : std::int32_t { kPool, kRecords, kScene };

struct Program {
  static constexpr int kUniforms = 18;
  Name name = 0;
  char label[48] = {};                // for debuggers: its own, and that of the group of its draws
  std::int32_t locations[kUniforms];  // of the members of draw::Uniforms; -1: it does not use them
  std::int32_t pool = -1, records = -1, scene_depth = -1;
};

inline draw::Dialect dialectOf(const Api& api) {
  return api.es ? draw::Dialect::kEs300 : draw::Dialect::kGl330;
}

// Compiles, links and binds a program, and sets the units of its samplers. `surface`: the host's kelpSurface.
// Null: kelp's own.
Result<Program> build(const Api& api, draw::Program which, Features features, const char* surface,
                      const Log& log);
// Finds the uniforms of a program that contains kelp's text.
Program locate(const Api& api, Name name);
// Sets them, in the program in use.
void setUniforms(const Api& api, const Program& program, const draw::Uniforms& uniforms);
void setFirstInstance(const Api& api, const Program& program, std::int32_t first);

}  // namespace kelp::gl
