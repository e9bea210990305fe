// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "kelp/formats/pack.h"
#include "pack_file.h"

namespace kelp::dump {

// The bricks of a level one after the other, as the file has them: in Morton order. In memory are one grid and one page.
class BrickReader {
 public:
  // Reads the grid. DumpError, here and from next(), for what can not be read.
  BrickReader(PackFile& file, int part, int level);

  const LevelGrid& grid() const { return grid_; }
  // On to the next brick, at first the first. False at the end.
  bool next();
  // Of the brick in hand.
  const glm::ivec3& position() const { return positions_[slot_]; }
  std::uint64_t morton() const { return mortonCode(position()); }
  std::span<const std::uint8_t> codes() const { return std::span<const std::uint8_t>(page_.codes.span()).subspan(inPage() * kBrickVoxels, kBrickVoxels); }
  std::span<const std::uint32_t> attributes() const { return std::span<const std::uint32_t>(page_.attributes.span()).subspan(first_attribute_, attributes_); }  // in the order of codes
  // Of fog: density is channel 0, heat 1.
  std::span<const std::uint8_t> samples(int channel) const;
  int channels() const { return grid_.pages[page_index_].channels; }

 private:
  std::size_t inPage() const { return slot_ - page_.first_slot; }

  PackFile& file_;
  int part_, level_;
  LevelGrid grid_;
  std::vector<glm::ivec3> positions_;  // by slot
  PageData page_;
  std::size_t page_index_ = 0;
  std::uint32_t slot_ = 0;
  std::size_t first_attribute_ = 0, attributes_ = 0;
  bool begun_ = false;
};

// Every brick that one of two levels has: visit(lowest voxel, reader of a, reader of b), where the one that lacks it is null.
template <class Visit>
void forEachBrick(BrickReader& a, BrickReader& b, const Visit& visit) {
  bool more_a = a.next(), more_b = b.next();
  while (more_a || more_b) {
    const bool use_a = more_a && (!more_b || a.morton() <= b.morton()), use_b = more_b && (!more_a || b.morton() <= a.morton());
    visit((use_a ? a : b).position() * kBrickSide, use_a ? &a : nullptr, use_b ? &b : nullptr);
    if (use_a) more_a = a.next();
    if (use_b) more_b = b.next();
  }
}

}  // namespace kelp::dump
