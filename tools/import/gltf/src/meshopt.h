// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <span>
#include <stdexcept>
#include <string>
#include <vector>

namespace kelp::bake {

struct MeshoptError : std::runtime_error {
  using std::runtime_error::runtime_error;
};

// The fields of EXT_meshopt_compression.
struct MeshoptView {
  std::uint64_t count = 0, stride = 0;
  std::string mode, filter;
};

// Decodes one compressed buffer view to count * stride bytes. Safe for hostile input.
std::vector<std::uint8_t> decodeMeshopt(std::span<const std::uint8_t> bytes, const MeshoptView& view);

}  // namespace kelp::bake
