// SPDX-License-Identifier: MIT
// A pool as shaders/instance.glsl and kelp/formats/page.h describe it, read word by word; what it must hold;
// and until when.
#pragma once

#include <cstdint>
#include <map>
#include <span>
#include <utility>
#include <vector>

#include <glm/glm.hpp>

#include "kelp/draw/planner.h"

namespace kelp::test {

// Where a part's tables are, as its record says.
struct PlacedPart {
  int instance = 0, part = 0;
  std::uint32_t palette = 0;  // a word of the pool; with bit 31: of the records
  std::uint32_t tables = 0;
  int levels = 0, distances = 0;
  glm::ivec3 size{0};
};
// Of all instances that the calls of a draw name.
std::vector<PlacedPart> placedParts(const draw::DrawData& data);

// How much of a part the pool holds.
struct Held {
  int grids = 0, cages = 0, pages = 0, missing_pages = 0;
  Held& operator+=(const Held& more);
};

class PoolModel {
 public:
  explicit PoolModel(std::uint64_t bytes) : pool_(bytes / 4), last_read_(bytes / 4) {}

  // Fails the test if a copy goes where a draw of a later frame than Copy::frame may read.
  void copy(std::span<const draw::Copy> copies);
  // Marks every word that the shaders may read of the parts.
  void drawn(const std::vector<PlacedPart>& parts, std::uint64_t frame, bool fog,
             std::size_t palette_entries);
  // Word for word: what the tables of the part name is what is in `whole`, the same asset completely in
  // memory.
  Held expectContent(const PlacedPart& part, const runtime::Asset& whole) const;

  std::uint64_t earlyCopies() const { return early_; }  // words that may be copied while the last draw runs

 private:
  std::uint32_t word(std::uint64_t at) const;
  std::uint64_t cageWords(std::uint64_t at) const;
  template <class Visit>
  void visitLevel(const PlacedPart& part, int level, bool distances, std::uint32_t fog_words,
                  Visit&& visit) const;

  std::vector<std::uint32_t> pool_;
  std::vector<std::uint64_t> last_read_;
  std::uint64_t frame_ = 0, early_ = 0;
};

}  // namespace kelp::test
