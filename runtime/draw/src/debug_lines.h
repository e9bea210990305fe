// SPDX-License-Identifier: MIT
// The lines of View::debug: the boxes of parts that are rasterized, their splines and knots, or their
// cages.
#pragma once

#include <span>

#include "draw_list.h"

namespace kelp::draw {

class DebugLines {
 public:
  explicit DebugLines(const Allocator& allocator) : points_(allocator) {}

  // Of the parts that are listed. kOutOfMemory.
  Result<void> build(const View& view, const DrawList& list, std::span<const runtime::Instance> instances);

  // Two for each line, as shaders/lines.vert reads them: whole rows of kRecordWidth.
  std::span<const glm::uvec4> records() const;
  std::uint32_t points() const { return static_cast<std::uint32_t>(count_); }

 private:
  void addBox(const RecordHead& part);
  void addCage(const RecordHead& part, const Cage& cage);
  void addSpline(const RecordHead& part, std::span<const Knot> knots, const glm::vec2& pixel);
  void addLine(const glm::vec4& from, const glm::vec4& to, std::uint32_t color);

  Buffer<glm::uvec4> points_;  // the first count_
  std::size_t count_ = 0;
};

}  // namespace kelp::draw
