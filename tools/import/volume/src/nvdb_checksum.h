// SPDX-License-Identifier: MIT
// A grid of NanoVDB as bytes: where its head has what is read of it, and its checksum.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>
#include <vector>

namespace kelp::bake {

// In bytes from the grid's beginning on: the same in every version of major 32.
namespace nvdb {
inline constexpr std::size_t kSum = 8, kVersion = 16, kFlags = 20, kSize = 32, kName = 40, kMap = 296,
                             kClass = 632, kType = 636, kSecondMagic = 664, kTree = 672;
inline constexpr std::size_t kRootOffset = kTree + 24, kVoxels = kTree + 56, kHead = kTree + 64;
}  // namespace nvdb

using NanoBytes = std::span<const std::byte>;

// A number of the file, which lies within `bytes`.
template <class T>
T readAt(NanoBytes bytes, std::size_t at) {
  T value;
  std::memcpy(&value, bytes.data() + at, sizeof(value));
  return value;
}

// Where a grid's nodes are.
struct NanoNode {
  std::size_t at = 0, bytes = 0;  // with what follows the node itself
};
struct NanoNodes {
  std::size_t root_end = 0;
  std::array<std::vector<NanoNode>, 3> levels;  // leaves first
  std::array<std::size_t, 3> sizes{};           // of the nodes themselves
};
// True if the grid has the checksum that it states, by any rule that a program of its version had; also if it
// states none.
bool hasItsChecksum(NanoBytes grid, const NanoNodes& nodes);

}  // namespace kelp::bake
