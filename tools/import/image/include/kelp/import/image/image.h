// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <variant>

#include "kelp/import/core/input_files.h"
#include "kelp/import/core/source_model.h"

namespace kelp::bake {

// Decodes PNG, JPEG, WebP, BMP or TGA to RGBA. The string says why a picture cannot be read. Safe for hostile
// input: sizes are checked before memory is taken.
std::variant<Image, std::string> decodeImage(std::span<const std::uint8_t> bytes, const std::string& name);

// The size of what decodeImage would make, from the header alone; 0 x 0: nothing.
glm::ivec2 imageSize(std::span<const std::uint8_t> bytes);

// Bounds the memory for all pictures of a model, with the reductions that sampling makes of them. A few
// hundred kilobytes of PNG can hold a gibibyte, and a hundred images may name the same bytes. So large files
// may use the machine's memory, and small ones less.
class PictureBudget {
 public:
  static constexpr std::uint64_t kUsual = std::uint64_t{1} << 30;
  // some 25 texels; a real JPEG or WebP picture has at most about 10 a byte
  static constexpr std::uint64_t kPerByteRead = 256;

  // `max_memory` as in ImportSettings: if it is given, it is the bound for files of any size.
  PictureBudget(const InputFiles& files, std::uint64_t max_memory) : files_(files), max_memory_(max_memory) {}
  // Counts a picture before it is decoded. ToolError kRuntime, for `place`, if the sum is too large.
  void take(glm::ivec2 size, const std::string& place);

 private:
  const InputFiles& files_;
  std::uint64_t max_memory_, taken_ = 0;
};

}  // namespace kelp::bake
