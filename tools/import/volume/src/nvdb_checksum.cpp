// SPDX-License-Identifier: MIT
// Checksums of NanoVDB: a CRC-32 of the head, and one of what follows it, or no more than that of the head.
#include "nvdb_checksum.h"

#include <zlib.h>

namespace kelp::bake {
namespace {

constexpr std::uint32_t kNone = ~std::uint32_t{0};
constexpr std::uint32_t kLastOldVersion = 32u << 21 | 6u << 10;  // 32.6.0

std::uint32_t crc(NanoBytes bytes, std::uint32_t before = 0) {
  return static_cast<std::uint32_t>(
      crc32_z(before, reinterpret_cast<const Bytef*>(bytes.data()), bytes.size()));
}

template <class Number>
std::uint32_t crcOf(Number sum, std::uint32_t before) {
  return crc(std::as_bytes(std::span(&sum, 1)), before);
}

// Of the sums of pieces of 4 KiB, the last of which has the rest as well.
std::uint32_t crcOfPieces(NanoBytes bytes) {
  constexpr std::size_t kPiece = 4096;
  if (bytes.empty()) return kNone;
  std::uint32_t sum = 0;
  for (std::size_t left = bytes.size() / kPiece; left > 0; --left) {
    const std::size_t size = left == 1 ? bytes.size() : kPiece;
    sum = crcOf(crc(bytes.first(size)), sum);
    bytes = bytes.subspan(size);
  }
  return sum;
}

// Of the sums of nodes, from the upper ones down. Where a program had fast numbers of 64 bits (Linux), the
// sums are summed as such. 32.6 took in what follows a node, older ones did not.
template <class Number>
std::uint32_t crcOfNodes(NanoBytes grid, const NanoNodes& nodes, bool whole) {
  std::uint32_t sum = 0;
  for (std::size_t level = nodes.levels.size(); level-- > 0;)
    for (const NanoNode& node : nodes.levels[level])
      sum = crcOf<Number>(crc(grid.subspan(node.at, whole ? node.bytes : nodes.sizes[level])), sum);
  return sum;
}

}  // namespace

bool hasItsChecksum(NanoBytes grid, const NanoNodes& nodes) {
  const auto head = readAt<std::uint32_t>(grid, nvdb::kSum),
             tail = readAt<std::uint32_t>(grid, nvdb::kSum + 4);
  if (head == kNone && tail == kNone) return true;
  const bool old = readAt<std::uint32_t>(grid, nvdb::kVersion) <= kLastOldVersion;
  const std::size_t head_end = old ? nodes.root_end : nvdb::kHead;
  if (head != crc(grid.subspan(nvdb::kVersion, head_end - nvdb::kVersion))) return false;
  if (tail == kNone || tail == crcOfPieces(grid.subspan(head_end))) return true;
  return old && (tail == crcOfNodes<std::uint64_t>(grid, nodes, false) ||
                 tail == crcOfNodes<std::uint32_t>(grid, nodes, false) ||
                 tail == crcOfNodes<std::uint32_t>(grid, nodes, true));
}

}  // namespace kelp::bake
