// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <span>

#include "kelp/formats/level.h"
#include "pack/pack_file.h"

namespace kelp::dump {

// Reads the bricks of a level one after the other, in Morton order as they are in the file. Holds only grids,
// one page and the shape of the next coarser level in memory.
class BrickReader {
 public:
  // Reads the grid. ToolError here and from next().
  BrickReader(PackFile& file, int part, int level);

  const LevelGrid& grid() const { return level_.grid(); }
  // Moves to the next brick; the first call to the first one. False at the end.
  bool next();
  // Of the current brick.
  glm::ivec3 position() const { return grid().place(slot_); }
  std::uint64_t morton() const { return mortonCode(position()); }
  std::span<const std::uint8_t> codes() const { return page_.codes(inPage()); }
  // In the order of codes.
  std::span<const std::uint32_t> attributes() const {
    return page_.attributes().subspan(first_attribute_, attributes_);
  }
  // Of fog. Channel 0 is density, 1 is heat.
  std::span<const std::uint8_t> samples(int channel) const;
  int channels() const { return grid().pages[page_index_].channels; }

 private:
  std::size_t inPage() const { return slot_ - page_.info.first_slot; }

  PackFile& file_;
  LevelReader level_;
  PageData page_;
  std::size_t page_index_ = 0;
  std::uint32_t slot_ = 0;
  std::size_t first_attribute_ = 0, attributes_ = 0;
  bool begun_ = false;
};

// Calls visit(lowest voxel, a, b) for every brick that one of the levels has. The reader of a level that
// lacks the brick is null.
template <class Visit>
void forEachBrick(BrickReader& a, BrickReader& b, const Visit& visit) {
  bool more_a = a.next(), more_b = b.next();
  while (more_a || more_b) {
    const bool use_a = more_a && (!more_b || a.morton() <= b.morton()),
               use_b = more_b && (!more_a || b.morton() <= a.morton());
    visit((use_a ? a : b).position() * kBrickSide, use_a ? &a : nullptr, use_b ? &b : nullptr);
    if (use_a) more_a = a.next();
    if (use_b) more_b = b.next();
  }
}

}  // namespace kelp::dump
