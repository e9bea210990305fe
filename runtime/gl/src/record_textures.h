// SPDX-License-Identifier: MIT
// The frame's records on the GPU.
#pragma once

#include <span>

#include <glm/ext/vector_uint4.hpp>

#include "gl_api.h"
#include "kelp/formats/error.h"

namespace kelp::gl {

// Several textures, used in turn, so that a frame does not wait until the one before is drawn.
struct RecordTextures {
  static constexpr int kCount = 3;
  Name names[kCount] = {};
  std::size_t rows = 0;  // of each
  int now = 0;
  Name name() const { return names[now]; }
};

// Makes the textures when they are first used. Within an UploadGuard. `records`: rows of draw::kRecordWidth
// texels; none: nothing happens.
Result<void> uploadRecords(const Api& api, RecordTextures& textures, const char* label,
                           std::span<const glm::uvec4> records);

}  // namespace kelp::gl
