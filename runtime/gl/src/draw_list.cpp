// SPDX-License-Identifier: MIT
#include "draw_list.h"

#include <algorithm>
#include <cstddef>
#include <cstring>
#include <utility>

#include <glm/geometric.hpp>
#include <glm/gtc/type_precision.hpp>
#include <glm/matrix.hpp>

#include "kelp/formats/lanes.h"

namespace kelp::gl {
namespace {

constexpr Error kNoMemory{ErrorCode::kOutOfMemory, "no memory for the frame's draw list"};
// What is not seen is worth this much of what is: it may be seen next.
constexpr float kHiddenWorth = 0.125;

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

constexpr Error kUnknownAsset{ErrorCode::kMisuse, "an instance's asset is not known to the renderer"};
constexpr Error kGoneAsset{ErrorCode::kMisuse, "an instance's asset was destroyed"};
constexpr Error kBadPose{ErrorCode::kMisuse, "an instance's pose is not monotone"};
constexpr Error kForeignPose{ErrorCode::kMisuse, "an instance's pose belongs to another asset"};
constexpr Error kBadMatrix{ErrorCode::kMisuse, "an instance's to_world is not an invertible affine matrix"};

bool isAffine(const glm::mat4& m) { return m[0][3] == 0 && m[1][3] == 0 && m[2][3] == 0 && m[3][3] == 1; }

// The assets that the frame's instances name, found once each as long as they do not fall on the same place.
class FoundAssets {
 public:
  // Null, and `error` set: it must not be drawn.
  ResidentAsset* find(const Residency& store, const runtime::Asset* asset, const Error*& error) {
    const auto address = reinterpret_cast<std::uintptr_t>(asset);
    One& one = places_[(address >> 4 ^ address >> 8 ^ address >> 12) % kPlaces];
    if (one.asset != asset || !asset) {
      const int index = store.find(asset);
      if (index < 0 || !store.alive(index)) {
        error = index < 0 ? &kUnknownAsset : &kGoneAsset;
        return nullptr;
      }
      one = {asset, &store.at(index)};
    }
    return one.resident;
  }

 private:
  static constexpr std::size_t kPlaces = 64;
  struct One {
    const runtime::Asset* asset = nullptr;
    ResidentAsset* resident = nullptr;
  };
  One places_[kPlaces];
};

// As runtime::partToWorld, for the many parts that do not move as a whole.
glm::mat4 toWorld(const runtime::Instance& instance, std::span<const Part> parts, int part) {
  if (instance.pose) {
    for (int i = part; i >= 0; i = parts[static_cast<std::size_t>(i)].parent) {
      if (!runtime::isRest(*instance.pose->motion(i))) return runtime::partToWorld(instance, part);
    }
  }
  const glm::mat4x3& m = parts[static_cast<std::size_t>(part)].to_object;
  const Lanes x = Lanes::load(&instance.to_world[0][0]), y = Lanes::load(&instance.to_world[1][0]), z = Lanes::load(&instance.to_world[2][0]);
  const auto turned = [&](int column) { return (x * m[column][0] + y * m[column][1]) + z * m[column][2]; };
  glm::mat4 out;
  for (int column = 0; column < 3; ++column) turned(column).store(&out[column][0]);
  (turned(3) + Lanes::load(&instance.to_world[3][0])).store(&out[3][0]);
  return out;
}

// Puts world -> part space in place of part -> clip space.
void worldToPart(RecordHead& head) {
  const glm::vec4(&rows)[3] = head.to_world;
  const glm::dmat4 inverse = glm::inverse(glm::transpose(glm::dmat4(glm::dvec4(rows[0]), glm::dvec4(rows[1]), glm::dvec4(rows[2]), glm::dvec4(0, 0, 0, 1))));
  const glm::mat4 inverse_rows(glm::transpose(inverse));
  for (int row = 0; row < 4; ++row) head.to_clip[row] = inverse_rows[row];
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

// As makeSegment. Writes one number more: what comes next lies over it.
glm::uvec4* writeSegments(glm::uvec4* out, std::span<const Knot> knots) {
  static_assert(sizeof(Segment) == 3 * sizeof *out && offsetof(Segment, m0) == 12 && offsetof(Segment, p1) == 24 && offsetof(Segment, m1) == 36);
  static_assert(offsetof(Knot, position) == 4 && offsetof(Knot, tangent) == 16);
  for (std::size_t i = 0; i + 1 < knots.size(); ++i) {
    const Knot& k0 = knots[i];
    const Knot& k1 = knots[i + 1];
    const float share = k1.at - k0.at;
    const auto tangentOf = [share](const Knot& knot) { return share * Lanes::load(&knot.position.z).rotated(); };
    float* const numbers = reinterpret_cast<float*>(out);
    Lanes::load(&k0.position.x).store(numbers);
    tangentOf(k0).store(numbers + 3);
    Lanes::load(&k1.position.x).store(numbers + 6);
    tangentOf(k1).store(numbers + 9);
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
  FoundAssets found;
  for (std::size_t i = 0; i < instances.size(); ++i) {
    const Error* error = nullptr;
    ResidentAsset* const asset = found.find(store, instances[i].asset, error);
    if (asset) error = addInstance(*asset, camera, view, instances[i], static_cast<std::uint32_t>(i), rays);
    if (error) {
      count_ = 0;
      return *error;
    }
  }
  return writeOrder();
}

const Error* DrawList::addInstance(ResidentAsset& asset, const Camera& camera, const View& view, const runtime::Instance& instance, std::uint32_t index,
                                   Rays rays) {
  const std::span<const Part> parts = asset.packed;
  if (!isAffine(instance.to_world)) return &kBadMatrix;
  if (instance.pose && static_cast<std::size_t>(instance.pose->parts()) != parts.size()) return &kForeignPose;
  if (instance.previous_pose) {
    if (!instance.previous_pose->fits(*instance.asset)) return &kForeignPose;
    if (!instance.previous_pose->check()) return &kBadPose;
  }
  for (std::size_t p = 0; p < parts.size(); ++p) {
    const int part = static_cast<int>(p);
    ResidentPart& resident = asset.parts[p];
    const std::span<const Knot> knots = instance.pose ? instance.pose->knots(part) : parts[p].knots;
    if (knots.size() != parts[p].knots.size()) return &kForeignPose;
    Box bounds;
    if (!boundPart(knots, parts[p].size, bounds)) return &kBadPose;
    const std::size_t segments = 3 * (knots.size() - 1);
    const bool motion = rays == Rays::kView && view.previous_world_to_clip != nullptr;
    const std::size_t texels = kRecordTexels + segments + (motion ? 4 + segments : 0);
    // Room for a record, which is one only if the part is seen; and for the number that writeSegments writes too much.
    if (!grow(order_, count_ + 1) || !grow(records_, texels_ + texels + 1)) return &kNoMemory;
    glm::uvec4* out = &records_[texels_];
    auto* const head = reinterpret_cast<RecordHead*>(out);
    PlacedPart placed;
    if (!placePart(camera, toWorld(instance, parts, part), bounds, *head, placed)) {
      if (!isInvertible(instance.to_world)) return &kBadMatrix;
      // A part may be scaled to nothing by its motion: it has no voxel to show.
      ++culled_;
      continue;
    }
    const glm::vec4 eye = head->eye;
    const glm::vec3 extent = bounds.max - bounds.min;
    const float side = glm::max(extent.x, glm::max(extent.y, extent.z));
    bool seen = !placed.outside && placed.pixels * side >= view.smallest_pixels;
    float pixels = placed.pixels;
    if (!seen || rays == Rays::kAny) {
      // A part behind the eye counts as if it were as far before it.
      const glm::dvec3 from(eye);
      const double distance = eye.w == 0 ? 0.0 : glm::length(from - glm::clamp(from, glm::dvec3(bounds.min), glm::dvec3(bounds.max)));
      pixels = std::min(pixels, distance > 0 ? camera.pixel_scale / static_cast<float>(distance) : pixels);
      if (rays == Rays::kAny) seen = pixels * side >= view.smallest_pixels;
      if (!seen) pixels *= kHiddenWorth;
    }
    const Detail wanted = chooseDetail(pixels, view.pixels_per_voxel, view.finest_level, resident.levels);
    Residency::want(resident, wanted.level, std::min(pixels, 1e4f));
    if (!seen) {
      ++culled_;
      continue;
    }
    if (resident.finest == resident.levels) continue;
    const Detail detail = wanted.level < resident.finest ? Detail{resident.finest, 0} : wanted;

    // The bits of floats that are not negative ascend with them.
    const float depth = std::max(placed.nearest, 0.0f);
    Ordered& ordered = order_[count_++];
    std::memcpy(&ordered.key, &depth, sizeof depth);
    ordered.texel = static_cast<std::uint32_t>(texels_);
    texels_ += texels;
    if (rays == Rays::kAny) worldToPart(*head);
    out += sizeof *head / sizeof *out;
    *out++ = bitsOf(instance.tint);
    *out++ = bitsOf(bounds.min, static_cast<std::uint32_t>(knots.size() - 1));
    *out++ = bitsOf(bounds.max, asset.palette() + asset.levels[resident.first_level]->table);
    *out++ = bitsOf(glm::vec3(parts[p].size), static_cast<std::uint32_t>(detail.level | (rays == Rays::kAny ? 0 : detail.coarser) << 8 | resident.levels << 16));
    *out++ = glm::uvec4(asset.palette(), index, static_cast<std::uint32_t>(part), rays == Rays::kAny ? 0 : outlineOf(eye, bounds));
    out = writeSegments(out, knots);
    if (motion) {
      runtime::Instance before = instance;
      if (instance.previous_pose) before.pose = instance.previous_pose;
      if (instance.previous_to_world) before.to_world = *instance.previous_to_world;
      const glm::mat4 rows(glm::transpose(glm::dmat4(*view.previous_world_to_clip) * glm::dmat4(runtime::partToWorld(before, part))));
      for (int row = 0; row < 4; ++row) *out++ = bitsOf(rows[row]);
      writeSegments(out, before.pose ? before.pose->knots(part) : parts[p].knots);
    }
  }
  return nullptr;
}

// Sorts the parts, and writes the numbers of their records behind the records. The order serves speed alone, so 16 bits of the depths' fractions do:
// three rounds of a radix sort that leaves equals as they were.
Result<void> DrawList::writeOrder() {
  if (count_ == 0) return {};
  rows_ = (texels_ + (count_ + 3) / 4 + kRecordWidth - 1) / kRecordWidth;
  if (!grow(records_, rows_ * kRecordWidth) || !grow(sorted_, count_)) return kNoMemory;
  constexpr int kRounds = 3, kLowestBit = 7;
  constexpr std::uint32_t kBuckets = 256;
  const auto bucketOf = [](std::uint32_t key, int round) { return key >> (kLowestBit + 8 * round) & (kBuckets - 1); };
  std::uint32_t starts[kRounds][kBuckets] = {};
  for (std::size_t i = 0; i < count_; ++i) {
    for (int round = 0; round < kRounds; ++round) ++starts[round][bucketOf(order_[i].key, round)];
  }
  for (auto& of_round : starts) {
    std::uint32_t sum = 0;
    for (std::uint32_t& start : of_round) sum += std::exchange(start, sum);
  }
  for (int round = 0; round < kRounds; ++round) {
    for (std::size_t i = 0; i < count_; ++i) sorted_[starts[round][bucketOf(order_[i].key, round)]++] = order_[i];
    std::swap(order_, sorted_);
  }
  std::uint32_t* const numbers = reinterpret_cast<std::uint32_t*>(&records_[texels_]);
  for (std::size_t i = 0; i < count_; ++i) numbers[i] = order_[i].texel;
  return {};
}

}  // namespace kelp::gl
