// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <variant>

#include "import_files.h"
#include "kelp/bake/source_model.h"

namespace kelp::bake {

// Decodes PNG, JPEG, WebP, BMP or TGA to RGBA. Safe for hostile input: sizes are checked before memory is taken. The string says why not.
std::variant<Image, std::string> decodeImage(std::span<const std::uint8_t> bytes, const std::string& name);

// What decodeImage would make, by the header alone; 0 x 0: nothing.
glm::ivec2 imageSize(std::span<const std::uint8_t> bytes);

// What a model's pictures may take together, with their reductions as the stages keep them. A few hundred kilobytes of PNG can hold a gibibyte, and images
// by the hundred may name the same bytes: so the bound is the machine's memory for files that are large themselves, and less for small ones.
class PictureBudget {
 public:
  static constexpr std::uint64_t kUsual = std::uint64_t{1} << 30;
  static constexpr std::uint64_t kPerByteRead = 256;  // some 25 texels: a JPEG or WebP picture of something has at most about 10 a byte

  // `max_memory` as in Settings: what was asked for holds whatever the files' size.
  PictureBudget(const InputFiles& files, std::uint64_t max_memory) : files_(files), max_memory_(max_memory) {}
  // Counts a picture that was read and is about to be decoded. BakeError kRuntime, by the name of `place`, if that is too much.
  void take(glm::ivec2 size, const std::string& place);

 private:
  const InputFiles& files_;
  std::uint64_t max_memory_, taken_ = 0;
};

}  // namespace kelp::bake
