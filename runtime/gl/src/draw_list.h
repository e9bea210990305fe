// SPDX-License-Identifier: MIT
// What a frame draws: instances taken apart, culled, given a level, sorted into draws, and written out as the records of instance.glsl.
#pragma once

#include "asset_store.h"
#include "kelp/gl/renderer.h"

namespace kelp::gl {

// A View, checked and prepared.
struct Camera {
  glm::dmat4 world_to_clip{1};
  glm::dvec4 eye{0};      // world; w = 1, or the direction of view and w = 0
  double pixel_scale = 0;  // pixels per unit of length at clip w = 1
};

// kMisuse for a matrix that is not finite or not invertible.
Result<Camera> makeCamera(const View& view);

// One part of one instance.
struct DrawItem {
  std::int32_t asset = 0;  // index in the store
  std::int32_t part = 0;
  std::int32_t level = 0;
  float depth = 0;         // clip w of the nearest point; orders near to far
  const runtime::Instance* instance = nullptr;
  std::span<const Knot> knots;
  Box bounds;              // part space
  glm::mat4 to_world{1};

  bool sameDraw(const DrawItem& other) const { return asset == other.asset && part == other.part && level == other.level; }
};

// Reused from frame to frame; allocates only to grow.
class DrawList {
 public:
  explicit DrawList(const Allocator& allocator) : allocator_(allocator), items_(allocator), records_(allocator) {}

  // kMisuse for an instance that must not be drawn; nothing is listed then.
  Result<void> build(const AssetStore& store, const Camera& camera, const View& view, std::span<const runtime::Instance> instances);

  // Near to far within a draw; the items of a draw in a row, their records too.
  std::span<const DrawItem> items() const { return items_.span().first(count_); }
  // Padded to whole rows of kRecordWidth texels.
  std::span<const glm::vec4> records() const { return records_.span().first(texels_); }
  std::uint32_t culled() const { return culled_; }

  static constexpr std::size_t kRecordWidth = 1024;
  static std::size_t recordTexels(const DrawItem& item) { return 15 + 4 * (item.knots.size() - 1); }

 private:
  Result<void> addInstance(const AssetStore& store, const Camera& camera, const View& view, const runtime::Instance& instance);
  Result<void> writeRecords(const Camera& camera, const AssetStore& store);

  Allocator allocator_;
  Buffer<DrawItem> items_;
  Buffer<glm::vec4> records_;
  std::size_t count_ = 0;
  std::size_t texels_ = 0;
  std::uint32_t culled_ = 0;
};

}  // namespace kelp::gl
