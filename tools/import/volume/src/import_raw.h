// SPDX-License-Identifier: MIT
// Volumes that are numbers and nothing else: NAME.raw, and NAME.raw.json or NAME.json that says what the
// numbers are.
#pragma once

#include <cstdint>

#include <glm/glm.hpp>

#include "kelp/import/core/input_files.h"

namespace kelp::bake {

enum class RawType : std::uint8_t { kU8, kU16, kI16, kF32 };

struct RawVolume {
  glm::ivec3 size{0};  // voxels, 1 to 65536 a side; x goes fastest, then y, then z
  RawType type = RawType::kU8;
  bool big_endian = false;
  glm::dvec3 spacing{1};     // of voxels' centers along x, y and z, in the file's unit; > 0
  std::uint64_t offset = 0;  // bytes before the first voxel

  std::uint64_t voxels() const {
    return static_cast<std::uint64_t>(size.x) * static_cast<std::uint64_t>(size.y) *
           static_cast<std::uint64_t>(size.z);
  }
  std::size_t voxelBytes() const { return type == RawType::kU8 ? 1 : type == RawType::kF32 ? 4 : 2; }
};

// ToolError kIo where there is no such file beside the input, kInvalid. Safe for hostile input.
RawVolume readRawSidecar(const InputFiles& files);

}  // namespace kelp::bake
