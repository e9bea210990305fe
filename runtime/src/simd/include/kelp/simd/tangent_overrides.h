// SPDX-License-Identifier: MIT
// Which automatic tangents a clip overrides, because it moves them itself.
#pragma once

#include <cstdint>
#include <span>

#include "kelp/formats/buffer.h"
#include "kelp/formats/model.h"

namespace kelp::simd {

// Serves one clip at a time. Takes time in proportion to the waves and tracks of the clips, whatever the
// number of parts.
class TangentOverrides {
 public:
  // False: no memory.
  [[nodiscard]] static bool make(std::size_t parts, const Allocator& allocator, TangentOverrides& made) {
    made.knots_ = Buffer<std::uint64_t>(allocator);
    if (!made.knots_.reset(parts)) return false;
    for (std::uint64_t& knots : made.knots_) knots = 0;
    return true;
  }

  void begin(const Clip& clip) {
    each(clip, [this](const auto& move) { knots_[move.part] |= std::uint64_t{1} << move.knot; });
  }
  void end(const Clip& clip) {
    each(clip, [this](const auto& move) { knots_[move.part] = 0; });
  }
  // The automatic tangents of a part that still follow. Bit i: that of knot i.
  std::uint64_t following(const Part& part, std::uint32_t index) const {
    return part.automatic_tangents & ~knots_[index];
  }

 private:
  template <class Visit>
  static void each(const Clip& clip, const Visit& visit) {
    for (const Wave& wave : clip.waves)
      if (wave.target == Target::kKnotTangent) visit(wave);
    for (const Track& track : clip.tracks)
      if (track.target == Target::kKnotTangent) visit(track);
  }
  Buffer<std::uint64_t> knots_;  // of each part
};

}  // namespace kelp::simd
