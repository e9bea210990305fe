// SPDX-License-Identifier: MIT
// All state of a context that a program can ask for: the state tables of the OpenGL 3.3 and OpenGL ES 3.0
// specifications (chapter 6), and what later versions added, where the context has it.
#pragma once

#include <map>
#include <span>

#include "canvas.h"

namespace kelp::test {

// A context's version and the limits that say how much state there is.
struct GlLimits {
  bool es = false;
  int version = 0;  // 33, 45, 30, 32, ...
  GLint texture_units = 0, draw_buffers = 1, color_attachments = 0, vertex_attributes = 0, clip_distances = 0,
        sample_mask_words = 0;
  GLint uniform_buffers = 0, feedback_buffers = 0, viewports = 1;
  GLint vertex_bindings = 0, storage_buffers = 0, atomic_buffers = 0, image_units = 0;

  static GlLimits read();
  // True if this context has features that came with these versions; 0: never.
  bool has(int since_desktop, int since_es) const {
    return es ? since_es != 0 && version >= since_es : since_desktop != 0 && version >= since_desktop;
  }
};

// The target of a texture and what asks for the one bound to it.
struct TextureTarget {
  const char* name;
  GLenum target, binding;
  int since_desktop, since_es;
  bool sampled;  // has a sampler's parameters, and levels
};
std::span<const TextureTarget> textureTargets();

// Name -> values, as the context answers. A double holds each of them exactly.
using GlState = std::map<std::string, std::vector<double>>;

// Of the context that is current. Fails the test, by name, if the context does not know one of them. No error
// may be pending.
GlState readGlState();

// One line for each entry that is not the same in both: its name and values.
std::vector<std::string> differences(const GlState& before, const GlState& after);

}  // namespace kelp::test
