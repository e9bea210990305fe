// SPDX-License-Identifier: MIT
// The planner's pool as a texture array of 32-bit words: 1,024 to a row, 1,024 rows to a layer.
#pragma once

#include <span>

#include "gl_api.h"
#include "kelp/draw/planner.h"

namespace kelp::gl {

class PoolTexture {
 public:
  // How much of `budget` bytes a texture array of the context holds, in whole rows, or layers.
  static std::uint64_t bytesFor(const Api& api, std::uint64_t budget);

  // These two within an UploadGuard.
  Result<void> create(const Api& api, std::uint64_t bytes);
  void write(const Api& api, std::span<const draw::Copy> copies) const;
  void destroy(const Api& api) const { api.DeleteTextures(1, &name_); }
  Name name() const { return name_; }

 private:
  Name name_ = 0;
};

}  // namespace kelp::gl
