// SPDX-License-Identifier: MIT
// What a frame draws: instances taken apart, culled, given a level, written out as the records of instance.glsl, and ordered near to far.
#pragma once

#include "detail.h"
#include "residency.h"

namespace kelp::gl {

// Reused from frame to frame; allocates only to grow.
class DrawList {
 public:
  static constexpr std::size_t kRecordWidth = 1024;  // texels
  static constexpr std::size_t kRecordTexels = 13;   // of a record, without its segments

  // What the records are for: the view's own rays, or those of a host's shader, which come from anywhere. Then nothing is culled for not being
  // before the eye, and the records have world -> part space in place of part -> clip space.
  enum class Rays : std::uint8_t { kView, kAny };

  explicit DrawList(const Allocator& allocator) : order_(allocator), sorted_(allocator), records_(allocator) {}

  // Tells `store` what is wanted. kMisuse for an instance that must not be drawn; nothing is listed then.
  Result<void> build(Residency& store, const Camera& camera, const View& view, std::span<const runtime::Instance> instances, Rays rays = Rays::kView);

  // Parts to draw, near to far.
  std::uint32_t parts() const { return static_cast<std::uint32_t>(count_); }
  // Rows of kRecordWidth texels.
  std::span<const glm::uvec4> records() const { return records_.span().first(rows_ * kRecordWidth); }
  // Where the numbers of the parts' records begin: four to a texel.
  std::uint32_t firstNumber() const { return static_cast<std::uint32_t>(4 * texels_); }
  std::uint32_t culled() const { return culled_; }

 private:
  struct Ordered {
    std::uint32_t key = 0;     // ascends with the depth of the part's nearest point
    std::uint32_t texel = 0;   // of the record
  };

  // Null, or what is wrong.
  const Error* addInstance(ResidentAsset& asset, const Camera& camera, const View& view, const runtime::Instance& instance, std::uint32_t index, Rays rays);
  Result<void> writeOrder();

  Buffer<Ordered> order_;        // the first count_
  Buffer<Ordered> sorted_;
  Buffer<glm::uvec4> records_;   // the first texels_
  std::size_t count_ = 0;
  std::size_t texels_ = 0;
  std::size_t rows_ = 0;
  std::uint32_t culled_ = 0;
};

}  // namespace kelp::gl
