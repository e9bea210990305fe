// SPDX-License-Identifier: MIT
#include "draw_list.h"

#include <algorithm>
#include <cmath>
#include <cstring>

#include <glm/geometric.hpp>
#include <glm/gtc/type_precision.hpp>
#include <glm/matrix.hpp>

namespace kelp::gl {
namespace {

constexpr Error kNoMemory{ErrorCode::kOutOfMemory, "no memory for the frame's draw list"};
// What is not seen is worth this much of what is: it may be seen next.
constexpr double kHiddenWorth = 0.125;

// Doubles the room of `buffer` until it holds `size`, keeping what is there.
template <class T>
[[nodiscard]] bool grow(Buffer<T>& buffer, std::size_t size) {
  if (size <= buffer.size()) return true;
  Buffer<T> more(buffer.allocator());
  if (!more.reset(std::max(size, 2 * buffer.size()))) return false;
  if (!buffer.empty()) std::memcpy(static_cast<void*>(more.data()), buffer.data(), buffer.size() * sizeof(T));
  buffer = std::move(more);
  return true;
}

Result<void> checkInstance(const runtime::Instance& instance) {
  const glm::mat4& m = instance.to_world;
  glm::dmat3 inverse;
  if (m[0][3] != 0 || m[1][3] != 0 || m[2][3] != 0 || m[3][3] != 1 || !invert(m, inverse)) {
    return Error{ErrorCode::kMisuse, "an instance's to_world is not an invertible affine matrix"};
  }
  const std::span<const Part> parts = instance.asset->pack().parts();
  for (const runtime::Pose* pose : {instance.pose, instance.previous_pose}) {
    if (!pose) continue;
    bool fits = static_cast<std::size_t>(pose->parts()) == parts.size();
    for (std::size_t p = 0; fits && p < parts.size(); ++p) fits = pose->knots(static_cast<int>(p)).size() == parts[p].knots.size();
    if (!fits) return Error{ErrorCode::kMisuse, "an instance's pose belongs to another asset"};
    if (!pose->check()) return Error{ErrorCode::kMisuse, "an instance's pose is not monotone"};
  }
  return {};
}

glm::uvec4 bitsOf(const glm::vec4& v) {
  glm::uvec4 bits;
  std::memcpy(&bits, &v, sizeof bits);
  return bits;
}
glm::uvec4 bitsOf(const glm::vec3& v, std::uint32_t w) {
  glm::uvec4 bits;
  std::memcpy(&bits, &v, sizeof v);
  bits.w = w;
  return bits;
}

template <class Matrix>
glm::uvec4* writeRows(glm::uvec4* out, const Matrix& m, int rows) {
  for (int row = 0; row < rows; ++row) {
    *out++ = bitsOf(glm::vec4(static_cast<float>(m[0][row]), static_cast<float>(m[1][row]), static_cast<float>(m[2][row]), static_cast<float>(m[3][row])));
  }
  return out;
}

glm::uvec4* writeSegments(glm::uvec4* out, std::span<const Knot> knots) {
  for (std::size_t i = 0; i + 1 < knots.size(); ++i) {
    const Segment segment = makeSegment(knots[i], knots[i + 1]);
    static_assert(sizeof segment == 3 * sizeof *out);
    std::memcpy(static_cast<void*>(out), &segment, sizeof segment);
    out += 3;
  }
  return out;
}

}  // namespace

Result<void> DrawList::build(Residency& store, const Camera& camera, const View& view, std::span<const runtime::Instance> instances, Rays rays) {
  count_ = 0;
  texels_ = 0;
  rows_ = 0;
  culled_ = 0;
  store.beginWants();
  const runtime::Asset* known = nullptr;
  int asset = -1;
  for (std::size_t i = 0; i < instances.size(); ++i) {
    const runtime::Instance& instance = instances[i];
    Result<void> good;
    if (instance.asset != known || asset < 0) {
      known = instance.asset;
      asset = store.find(known);
      if (asset < 0) {
        good = Error{ErrorCode::kMisuse, "an instance's asset is not known to the renderer"};
      } else if (!store.alive(asset)) {
        good = Error{ErrorCode::kMisuse, "an instance's asset was destroyed"};
      }
    }
    if (good) good = addInstance(store, camera, view, instance, static_cast<std::uint32_t>(i), asset, rays);
    if (!good) {
      count_ = 0;
      return good;
    }
  }
  return writeOrder();
}

Result<void> DrawList::addInstance(Residency& store, const Camera& camera, const View& view, const runtime::Instance& instance, std::uint32_t index,
                                   int asset_index, Rays rays) {
  if (auto good = checkInstance(instance); !good) return good;
  const ResidentAsset& asset = store.at(asset_index);
  const std::span<const Part> parts = instance.asset->pack().parts();
  for (std::size_t p = 0; p < parts.size(); ++p) {
    const int part = static_cast<int>(p);
    const ResidentPart& resident = asset.parts[p];
    const std::span<const Knot> knots = instance.pose ? instance.pose->knots(part) : parts[p].knots;
    const PlacedPart placed = placePart(camera, instance, part, knots, parts[p].size);
    // A part may be scaled to nothing by its motion: it has no voxel to show.
    if (!placed.good) {
      ++culled_;
      continue;
    }
    const Box& bounds = placed.bounds;
    const glm::vec3 extent = bounds.max - bounds.min;
    const glm::dvec3 eye(placed.eye);
    const double distance = placed.eye.w == 0 ? 0.0 : glm::length(eye - glm::clamp(eye, glm::dvec3(bounds.min), glm::dvec3(bounds.max)));
    // A part behind the eye counts as if it were as far before it.
    const double turned_to = std::min(placed.pixels, distance > 0 ? camera.pixel_scale / distance : placed.pixels);
    const double seen_pixels = rays == Rays::kAny ? turned_to : placed.pixels;
    const double largest = seen_pixels * static_cast<double>(glm::max(extent.x, glm::max(extent.y, extent.z)));
    const bool seen = (rays == Rays::kAny || !placed.outside) && largest >= static_cast<double>(view.smallest_pixels);
    const double pixels = seen ? seen_pixels : kHiddenWorth * turned_to;
    const Detail wanted = chooseDetail(pixels, view.pixels_per_voxel, view.finest_level, resident.levels);
    store.want(asset_index, part, wanted.level, static_cast<float>(std::min(pixels, 1e4)));
    if (!seen) {
      ++culled_;
      continue;
    }
    if (resident.finest == resident.levels) continue;
    const Detail detail = wanted.level < resident.finest ? Detail{resident.finest, 0} : wanted;

    const std::size_t segments = 3 * (knots.size() - 1);
    const bool motion = rays == Rays::kView && view.previous_world_to_clip != nullptr;
    const std::size_t texel = texels_;
    if (!grow(order_, count_ + 1)) return kNoMemory;
    glm::uvec4* out = addRecord(kRecordTexels + segments + (motion ? 4 + segments : 0));
    if (!out) return kNoMemory;
    order_[count_++] = {static_cast<float>(placed.nearest), static_cast<std::uint32_t>(texel)};
    out = writeRows(out, rays == Rays::kAny ? glm::inverse(glm::dmat4(placed.to_world)) : placed.to_clip, 4);
    out = writeRows(out, placed.to_world, 3);
    *out++ = bitsOf(glm::vec4(placed.eye));
    *out++ = bitsOf(instance.tint);
    *out++ = bitsOf(bounds.min, static_cast<std::uint32_t>(knots.size() - 1));
    *out++ = bitsOf(bounds.max, asset.palette() + asset.levels[resident.first_level]->table);
    *out++ = bitsOf(glm::vec3(parts[p].size), static_cast<std::uint32_t>(detail.level | (rays == Rays::kAny ? 0 : detail.coarser) << 8 | resident.levels << 16));
    *out++ = glm::uvec4(asset.palette(), index, static_cast<std::uint32_t>(part), 0u);
    out = writeSegments(out, knots);
    if (motion) {
      runtime::Instance before = instance;
      if (instance.previous_pose) before.pose = instance.previous_pose;
      if (instance.previous_to_world) before.to_world = *instance.previous_to_world;
      out = writeRows(out, glm::dmat4(*view.previous_world_to_clip) * glm::dmat4(runtime::partToWorld(before, part)), 4);
      writeSegments(out, before.pose ? before.pose->knots(part) : parts[p].knots);
    }
  }
  return {};
}

glm::uvec4* DrawList::addRecord(std::size_t texels) {
  if (!grow(records_, texels_ + texels)) return nullptr;
  glm::uvec4* const record = &records_[texels_];
  texels_ += texels;
  return record;
}

// Sorts the parts, and writes the numbers of their records behind the records.
Result<void> DrawList::writeOrder() {
  if (count_ == 0) return {};
  std::sort(order_.begin(), order_.begin() + count_, [](const Ordered& a, const Ordered& b) {
    return a.depth != b.depth ? a.depth < b.depth : a.texel < b.texel;
  });
  rows_ = (texels_ + (count_ + 3) / 4 + kRecordWidth - 1) / kRecordWidth;
  if (!grow(records_, rows_ * kRecordWidth)) return kNoMemory;
  for (std::size_t i = 0; i < count_; ++i) records_[texels_ + i / 4][static_cast<int>(i % 4)] = order_[i].texel;
  return {};
}

}  // namespace kelp::gl
