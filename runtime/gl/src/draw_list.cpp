// SPDX-License-Identifier: MIT
#include "draw_list.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <tuple>

#include <glm/geometric.hpp>
#include <glm/matrix.hpp>

namespace kelp::gl {
namespace {

constexpr Error kNoMemory{ErrorCode::kOutOfMemory, "no memory for the frame's draw list"};
// Added to the bounds on every side: a ray that meets a voxel in the box's very face must not be lost to rounding. Voxels.
constexpr float kMargin = 1.0f / 64.0f;

template <class Matrix>
bool isFinite(const Matrix& m) {
  for (int column = 0; column < 4; ++column) {
    for (int row = 0; row < 4; ++row) {
      if (!std::isfinite(m[column][row])) return false;
    }
  }
  return true;
}

bool isInvertible(const glm::dmat4& m) {
  const double determinant = glm::determinant(m);
  return std::isfinite(determinant) && determinant != 0.0;
}

// Doubles the room of `buffer` until it holds `size`, keeping what is there.
template <class T>
[[nodiscard]] bool grow(Buffer<T>& buffer, std::size_t size, const Allocator& allocator) {
  if (size <= buffer.size()) return true;
  Buffer<T> more(allocator);
  if (!more.reset(std::max(size, 2 * buffer.size()))) return false;
  if (!buffer.empty()) std::memcpy(static_cast<void*>(more.data()), buffer.data(), buffer.size() * sizeof(T));
  buffer = std::move(more);
  return true;
}

// The corners of a box in clip space: which planes all of them are behind, and the nearest w.
struct Footprint {
  bool outside = true;
  double nearest = 0;  // w; at most 0 where the box reaches behind the eye
};

Footprint project(const glm::dmat4& to_clip, const Box& box) {
  unsigned behind_all = 63;
  Footprint footprint;
  for (int i = 0; i < 8; ++i) {
    const glm::dvec4 p = to_clip * glm::dvec4(i & 1 ? box.max.x : box.min.x, i & 2 ? box.max.y : box.min.y, i & 4 ? box.max.z : box.min.z, 1);
    unsigned behind = 0;
    for (int axis = 0; axis < 3; ++axis) {
      if (p[axis] < -p.w) behind |= 1u << (2 * axis);
      if (p[axis] > p.w) behind |= 2u << (2 * axis);
    }
    behind_all &= behind;
    footprint.nearest = i == 0 ? p.w : std::min(footprint.nearest, p.w);
  }
  footprint.outside = behind_all != 0;
  return footprint;
}

// The finest level, from `finest` on, whose voxels are at least `pixels_per_voxel` pixels large where they are nearest to the eye; the
// coarsest, if none is.
int chooseLevel(const Camera& camera, const glm::mat4& to_world, double nearest, int finest, float pixels_per_voxel, int levels) {
  int level = std::min(finest, levels - 1);
  if (!(nearest > 0)) return level;
  double side = 0;
  for (int axis = 0; axis < 3; ++axis) side = std::max(side, static_cast<double>(glm::length(glm::vec3(to_world[axis]))));
  double pixels = std::ldexp(side * camera.pixel_scale / nearest, level);
  while (level + 1 < levels && pixels < static_cast<double>(pixels_per_voxel)) {
    pixels *= 2;
    ++level;
  }
  return level;
}

Result<void> checkInstance(const runtime::Instance& instance) {
  const glm::mat4& m = instance.to_world;
  if (!isFinite(m) || m[0][3] != 0 || m[1][3] != 0 || m[2][3] != 0 || m[3][3] != 1 || !isInvertible(glm::dmat4(m))) {
    return Error{ErrorCode::kMisuse, "an instance's to_world is not an invertible affine matrix"};
  }
  if (!instance.pose) return {};
  const std::span<const Part> parts = instance.asset->pack().parts();
  bool fits = static_cast<std::size_t>(instance.pose->parts()) == parts.size();
  for (std::size_t p = 0; fits && p < parts.size(); ++p) fits = instance.pose->knots(static_cast<int>(p)).size() == parts[p].knots.size();
  if (!fits) return Error{ErrorCode::kMisuse, "an instance's pose belongs to another asset"};
  if (!instance.pose->check()) return Error{ErrorCode::kMisuse, "an instance's pose is not monotone"};
  return {};
}

void writeRows(glm::vec4* out, const glm::dmat4& m, int rows) {
  for (int row = 0; row < rows; ++row) out[row] = glm::vec4(glm::dvec4(m[0][row], m[1][row], m[2][row], m[3][row]));
}

// shaders/instance.glsl has the layout.
void writeRecord(const DrawItem& item, const Camera& camera, const glm::ivec3& size, glm::vec4* out) {
  const glm::dmat4 to_world(item.to_world);
  const glm::dmat4 to_part = glm::inverse(to_world);
  writeRows(out, camera.world_to_clip * to_world, 4);
  writeRows(out + 4, to_world, 3);
  writeRows(out + 7, glm::dmat4(glm::transpose(glm::dmat3(to_part))), 3);
  glm::dvec4 eye = to_part * camera.eye;
  if (camera.eye.w == 0) eye /= glm::length(glm::dvec3(eye));
  out[10] = glm::vec4(eye);
  out[11] = item.instance->tint;
  out[12] = glm::vec4(item.bounds.min, static_cast<float>(item.knots.size() - 1));
  out[13] = glm::vec4(item.bounds.max, 0);
  out[14] = glm::vec4(size, 0);
  for (std::size_t i = 0; i + 1 < item.knots.size(); ++i) {
    const Segment segment = makeSegment(item.knots[i], item.knots[i + 1]);
    glm::vec4* texel = out + 15 + 4 * i;
    texel[0] = glm::vec4(segment.p0, 0);
    texel[1] = glm::vec4(segment.m0, 0);
    texel[2] = glm::vec4(segment.p1, 0);
    texel[3] = glm::vec4(segment.m1, 0);
  }
}

}  // namespace

Result<Camera> makeCamera(const View& view) {
  const glm::dmat4 to_eye(view.world_to_eye);
  const glm::dmat4 to_clip(view.eye_to_clip);
  Camera camera;
  camera.world_to_clip = to_clip * to_eye;
  if (!isFinite(camera.world_to_clip) || !isInvertible(camera.world_to_clip)) {
    return Error{ErrorCode::kMisuse, "the view's matrices are not finite and invertible"};
  }
  // All rays of a view meet where clip x, y and w vanish: at the eye, or, orthographic, at infinity.
  const bool orthographic = to_clip[0][3] == 0 && to_clip[1][3] == 0 && to_clip[2][3] == 0;
  camera.eye = glm::inverse(camera.world_to_clip) * glm::dvec4(0, 0, 1, 0);
  if (orthographic) {
    camera.eye /= glm::length(glm::dvec3(camera.eye));
    if ((to_eye * camera.eye).z > 0) camera.eye = -camera.eye;
    camera.eye.w = 0;
  } else {
    camera.eye /= camera.eye.w;
  }
  double side = 0;  // of a unit cube in eye space: to_world has what world_to_eye does not scale
  for (int axis = 0; axis < 3; ++axis) side = std::max(side, glm::length(glm::dvec3(to_eye[axis])));
  camera.pixel_scale = 0.5 * side *
                       std::max(glm::length(glm::dvec3(to_clip[0][0], to_clip[1][0], to_clip[2][0])) * view.viewport.x,
                                glm::length(glm::dvec3(to_clip[0][1], to_clip[1][1], to_clip[2][1])) * view.viewport.y);
  return camera;
}

Result<void> DrawList::build(const AssetStore& store, const Camera& camera, const View& view,
                             std::span<const runtime::Instance> instances) {
  count_ = 0;
  texels_ = 0;
  culled_ = 0;
  for (const runtime::Instance& instance : instances) {
    if (auto good = addInstance(store, camera, view, instance); !good) {
      count_ = 0;
      return good;
    }
  }
  std::sort(items_.begin(), items_.begin() + count_, [](const DrawItem& a, const DrawItem& b) {
    return std::tie(a.asset, a.part, a.level, a.depth, a.instance) < std::tie(b.asset, b.part, b.level, b.depth, b.instance);
  });
  return writeRecords(camera, store);
}

Result<void> DrawList::addInstance(const AssetStore& store, const Camera& camera, const View& view, const runtime::Instance& instance) {
  const int index = store.find(instance.asset);
  if (index < 0) return Error{ErrorCode::kMisuse, "an instance's asset is not known to the renderer"};
  if (auto good = checkInstance(instance); !good) return good;
  const GpuAsset& asset = store.at(index);
  const std::span<const Part> parts = instance.asset->pack().parts();
  for (std::size_t p = 0; p < parts.size(); ++p) {
    const GpuPart& gpu = asset.parts[p];
    if (gpu.finest == gpu.levels) continue;
    DrawItem item;
    item.asset = index;
    item.part = static_cast<std::int32_t>(p);
    item.instance = &instance;
    item.knots = instance.pose ? instance.pose->knots(item.part) : parts[p].knots;
    item.bounds = deformedBounds(item.knots, parts[p].size);
    item.bounds.min -= kMargin;
    item.bounds.max += kMargin;
    item.to_world = runtime::partToWorld(instance, item.part);
    const glm::dmat4 to_clip = camera.world_to_clip * glm::dmat4(item.to_world);
    const Footprint footprint = project(to_clip, item.bounds);
    // A part may be scaled to nothing by its motion: it has no voxel to show.
    if (footprint.outside || !isFinite(to_clip) || !isInvertible(glm::dmat4(item.to_world))) {
      ++culled_;
      continue;
    }
    item.depth = static_cast<float>(footprint.nearest);
    item.level = std::max(chooseLevel(camera, item.to_world, footprint.nearest, view.finest_level, view.pixels_per_voxel, gpu.levels), gpu.finest);
    if (!grow(items_, count_ + 1, allocator_)) return kNoMemory;
    items_[count_++] = item;
  }
  return {};
}

Result<void> DrawList::writeRecords(const Camera& camera, const AssetStore& store) {
  std::size_t texels = 0;
  for (const DrawItem& item : items()) texels += recordTexels(item);
  const std::size_t padded = (texels + kRecordWidth - 1) / kRecordWidth * kRecordWidth;
  if (!grow(records_, padded, allocator_)) return kNoMemory;
  texels_ = padded;
  glm::vec4* out = records_.data();
  for (const DrawItem& item : items()) {
    const Part& part = store.at(item.asset).asset->pack().parts()[static_cast<std::size_t>(item.part)];
    writeRecord(item, camera, part.size, out);
    out += recordTexels(item);
  }
  return {};
}

}  // namespace kelp::gl
