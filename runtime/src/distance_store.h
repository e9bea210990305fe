// SPDX-License-Identifier: MIT
// One level of distances of one part, loaded whole and never dropped.
#pragma once

#include <atomic>
#include <cstdint>

#include "level_store.h"

namespace kelp::runtime {

// What is behind `ready` is written before it is set, and never after. Stages and counts are guarded by the
// mutex of the asset.
struct DistanceState {
  int part = 0;
  int level = 0;
  std::uint64_t grid_raw = 0;    // decoded bytes of the DGRD chunk
  Stage stage = Stage::kAbsent;  // of the grid
  std::uint32_t absent = 0;      // pages
  std::uint32_t resident = 0;    // pages
  DistanceGrid grid;
  Buffer<Stage> pages;
  Buffer<std::uint8_t> codes;
  DistanceLevel data;
  std::atomic<bool> ready{false};
  std::atomic<std::uint16_t> failure{0};  // the ErrorCode why it is not and won't be; 0: none

  bool open() const { return stage == Stage::kAbsent || (stage == Stage::kResident && absent > 0); }
  // Estimates the bytes of all of the level before its grid is read: at least as many as it takes.
  std::uint64_t estimate(const Part& of) const;
  // The bytes that it takes, once the grid is read.
  std::uint64_t bytes() const;
  // Reads the grid and makes room for the codes.
  Result<void> load(const Pack& pack, const Allocator& allocator);
  // Reads the codes of a page.
  Result<void> loadPage(const Pack& pack, std::uint32_t page, DistancePage& memory);
};

}  // namespace kelp::runtime
