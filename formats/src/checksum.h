// SPDX-License-Identifier: MIT
// XXH3-64 (seed 0), the checksum of packs.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

namespace kelp {

std::uint64_t checksum(std::span<const std::byte> bytes);

// The same for bytes that come in pieces.
class RunningChecksum {
 public:
  RunningChecksum();
  void add(std::span<const std::byte> bytes);
  std::uint64_t value() const;

 private:
  alignas(64) std::byte state_[576];  // an XXH3_state_t; this header does not include xxhash.h
};

}  // namespace kelp
