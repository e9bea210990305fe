// SPDX-License-Identifier: MIT
#include "pool_texture.h"

#include <algorithm>

namespace kelp::gl {

using namespace constant;

namespace {
constexpr std::uint64_t kRowWords = 1024, kRowBytes = kRowWords * sizeof(std::uint32_t), kLayerRows = 1024;
constexpr std::uint64_t kMostLayers = 4095;  // of a pool

std::int32_t toInt(std::uint64_t number) { return static_cast<std::int32_t>(number); }
}  // namespace

std::uint64_t PoolTexture::bytesFor(const Api& api, std::uint64_t budget) {
  const std::uint64_t most =
      std::min(static_cast<std::uint64_t>(api.max_array_layers), kMostLayers) * kLayerRows;
  const std::uint64_t rows = std::min(budget / kRowBytes, most);
  return kRowBytes * (rows > kLayerRows ? rows - rows % kLayerRows : rows);
}

Result<void> PoolTexture::create(const Api& api, std::uint64_t bytes) {
  const std::uint64_t rows = bytes / kRowBytes;
  name_ = makeTexture(api, kTexture2dArray, "kelp voxels");
  drainErrors(api);
  api.TexImage3D(kTexture2dArray, 0, kR32ui, toInt(kRowWords), toInt(std::min(rows, kLayerRows)),
                 toInt((rows + kLayerRows - 1) / kLayerRows), 0, kRedInteger, kUnsignedInt, nullptr);
  return checkErrors(api, "OpenGL refused a texture of gpu_budget bytes");
}

void PoolTexture::write(const Api& api, std::span<const draw::Copy> copies) const {
  if (!copies.empty()) api.BindTexture(kTexture2dArray, name_);
  for (const draw::Copy& copy : copies) {
    std::span<const std::uint32_t> words = copy.words;
    for (std::uint64_t address = copy.offset / sizeof(std::uint32_t); !words.empty();) {
      const std::uint64_t column = address % kRowWords, row = address / kRowWords;
      // Part of a row, or as many whole rows of one layer as there are.
      const std::uint64_t width = std::min<std::uint64_t>(words.size(), kRowWords - column);
      const std::uint64_t height =
          width == kRowWords ? std::min(words.size() / kRowWords, kLayerRows - row % kLayerRows) : 1;
      api.TexSubImage3D(kTexture2dArray, 0, toInt(column), toInt(row % kLayerRows), toInt(row / kLayerRows),
                        toInt(width), toInt(height), 1, kRedInteger, kUnsignedInt, words.data());
      words = words.subspan(static_cast<std::size_t>(width * height));
      address += width * height;
    }
  }
}

}  // namespace kelp::gl
