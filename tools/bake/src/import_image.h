// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <variant>

#include "kelp/bake/source_model.h"

namespace kelp::bake {

// Decodes PNG, JPEG, WebP, BMP or TGA to RGBA. Safe for hostile input: sizes are checked before memory is taken. The string says why not.
std::variant<Image, std::string> decodeImage(std::span<const std::uint8_t> bytes, const std::string& name);

// What decodeImage would make, by the header alone; 0 x 0: nothing.
glm::ivec2 imageSize(std::span<const std::uint8_t> bytes);

// What a file's pictures may take together: a few hundred kilobytes of PNG can hold a gibibyte.
class PictureBudget {
 public:
  static constexpr std::uint64_t kUsual = std::uint64_t{1} << 30;

  // `max_memory` as in Settings; 0: kUsual.
  explicit PictureBudget(std::uint64_t max_memory) : limit_(max_memory > 0 ? max_memory : kUsual) {}
  // Counts a picture before it is decoded, with its reductions as the stages keep them. False, and nothing is counted, if that is too much.
  bool take(glm::ivec2 size);
  std::uint64_t limit() const { return limit_; }

 private:
  std::uint64_t limit_, taken_ = 0;
};

}  // namespace kelp::bake
