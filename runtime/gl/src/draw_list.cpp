// SPDX-License-Identifier: MIT
#include "draw_list.h"

#include <algorithm>
#include <cstddef>
#include <cstring>
#include <utility>

#include <glm/common.hpp>
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
// Three floats and a number, written in place: a texel put together elsewhere would be read before its parts have arrived there.
void put(const Lanes& xyz, std::uint32_t w, glm::uvec4& out) {
  static_assert(sizeof out == 4 * sizeof(float));
  xyz.store(reinterpret_cast<float*>(&out));
  out.w = w;
}

// Ascends with a number, whatever its sign, below 2^31.
std::uint32_t ascending(float number) {
  std::uint32_t bits;
  std::memcpy(&bits, &number, sizeof bits);
  return (bits >> 31 ? ~bits : bits | 0x80000000u) >> 1;
}

// How far along the view's direction a box of part space begins: of an orthographic view, where clip w says nothing of it.
float alongView(const glm::dvec4& direction, const RecordHead& head, const Lanes& low, const Lanes& high) {
  glm::vec4 from, to, along(0);
  low.store(&from.x);
  high.store(&to.x);
  for (int row = 0; row < 3; ++row) along += static_cast<float>(direction[row]) * head.to_world[row];
  const glm::vec3 slope(along), middle = 0.5f * (glm::vec3(from) + glm::vec3(to));
  return glm::dot(slope, middle) + along.w - glm::dot(glm::abs(slope), glm::vec3(to) - middle);
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

Result<void> DrawList::build(Residency& store, const Camera& camera, const View& view, std::span<const runtime::Instance> instances, PartKind kind, Rays rays) {
  const Frame frame{camera, view, kind, rays};
  waiting_ = 0;
  count_ = 0;
  texels_ = 0;
  rows_ = 0;
  culled_ = 0;
  has_heat_ = false;
  store.beginWants();
  FoundAssets found;
  const Error* error = nullptr;
  for (std::size_t i = 0; i < instances.size() && !error; ++i) {
    ResidentAsset* const asset = found.find(store, instances[i].asset, error);
    if (asset) error = addInstance(frame, *asset, instances[i], static_cast<std::uint32_t>(i));
  }
  if (!error) error = addBlock(frame);
  if (!error) return writeOrder(kind);
  count_ = 0;
  return *error;
}

const Error* DrawList::addInstance(const Frame& frame, ResidentAsset& asset, const runtime::Instance& instance, std::uint32_t index) {
  const std::span<const Part> parts = asset.packed;
  if (!isAffine(instance.to_world)) return &kBadMatrix;
  if (instance.pose && static_cast<std::size_t>(instance.pose->parts()) != parts.size()) return &kForeignPose;
  if (instance.previous_pose) {
    if (!instance.previous_pose->fits(*instance.asset)) return &kForeignPose;
    if (!instance.previous_pose->check()) return &kBadPose;
  }
  for (std::uint32_t part = 0; part < parts.size(); ++part) {
    const std::span<const Knot> knots = instance.pose ? instance.pose->knots(static_cast<int>(part)) : parts[part].knots;
    if (knots.size() != parts[part].knots.size()) return &kForeignPose;
    if (parts[part].kind != frame.kind) continue;
    if (waiting_ == kBlock) {
      if (const Error* const error = addBlock(frame)) return error;
    }
    Candidate& candidate = block_[waiting_++];
    candidate.asset = &asset;
    candidate.instance = &instance;
    candidate.knots = knots;
    candidate.index = index;
    candidate.part = part;
  }
  return nullptr;
}

const Error* DrawList::addBlock(const Frame& frame) {
  const std::size_t count = std::exchange(waiting_, 0);
  if (count == 0) return nullptr;
  const std::size_t fours = (count + 3) / 4;
  for (std::size_t i = count; i < 4 * fours; ++i) block_[i] = block_[count - 1];  // company for the last ones
  const auto four = [this](std::size_t i) { return std::span<Candidate, 4>(block_ + 4 * i, 4); };
  const auto countOf = [count](std::size_t i) { return std::min<std::size_t>(count - 4 * i, 4); };
  std::size_t segments = 0;
  for (std::size_t i = 0; i < fours; ++i) {
    const auto c = four(i);
    const auto sizeOf = [](const Candidate& candidate) { return &candidate.asset->packed[candidate.part].size; };
    for (const Candidate& candidate : c) segments += candidate.knots.size() - 1;
    if (boundParts({c[0].knots, c[1].knots, c[2].knots, c[3].knots}, {sizeOf(c[0]), sizeOf(c[1]), sizeOf(c[2]), sizeOf(c[3])}, placed_[i]) != 15) return &kBadPose;
  }
  for (std::size_t i = 0; i < fours; ++i) {
    if (const Error* const error = place(frame, four(i), countOf(i), placed_[i])) return error;
  }
  for (std::size_t i = 0; i < fours; ++i) choose(frame, four(i), countOf(i), placed_[i]);
  // One texel more for the number that writeSegments writes too much.
  if (!grow(order_, count_ + count) || !grow(records_, texels_ + count * (kRecordTexels + 4) + 6 * segments + 1)) return &kNoMemory;
  for (std::size_t i = 0; i < fours; ++i) {
    // Boxes of one part each, from those of four.
    const BoxLanes& boxes = placed_[i].bounds;
    Lanes low[4] = {boxes.min[0], boxes.min[1], boxes.min[2], 0.0f}, high[4] = {boxes.max[0], boxes.max[1], boxes.max[2], 0.0f};
    transpose(low[0], low[1], low[2], low[3]);
    transpose(high[0], high[1], high[2], high[3]);
    float nearest[4];
    placed_[i].nearest.store(nearest);
    for (std::size_t k = 0; k < countOf(i); ++k) {
      if (four(i)[k].drawn) write(frame, four(i)[k], low[k], high[k], nearest[k]);
    }
  }
  return nullptr;
}

const Error* DrawList::place(const Frame& frame, std::span<Candidate, 4> four, std::size_t count, PlacedParts& placed) {
  glm::mat4 to_world[4];
  for (std::size_t k = 0; k < 4; ++k) to_world[k] = toWorld(*four[k].instance, four[k].asset->packed, static_cast<int>(four[k].part));
  placeParts(frame.camera, to_world, placed, {&four[0].head, &four[1].head, &four[2].head, &four[3].head});
  if (placed.invertible == 15) return nullptr;
  for (std::size_t k = 0; k < count; ++k) {
    // A part may be scaled to nothing by its motion: it has no voxel to show.
    if (!(placed.invertible >> k & 1) && !isInvertible(four[k].instance->to_world)) return &kBadMatrix;
  }
  return nullptr;
}

void DrawList::choose(const Frame& frame, std::span<Candidate, 4> four, std::size_t count, const PlacedParts& placed) {
  const View& view = frame.view;
  const auto& [low, high] = placed.bounds;
  const Lanes side = max(max(high[0] - low[0], high[1] - low[1]), high[2] - low[2]);
  // A part behind the eye counts as if it were as far before it.
  Lanes away = 0.0f;
  if (frame.camera.eye.w != 0) {
    for (int axis = 0; axis < 3; ++axis) {
      const Lanes beside = max(max(low[axis] - placed.eye[axis], placed.eye[axis] - high[axis]), 0.0f);
      away = away + beside * beside;
    }
  }
  const Lanes around = min(frame.camera.pixel_scale / sqrt(away), placed.pixels);
  const bool any = frame.rays == Rays::kAny;
  const Lanes covered = (any ? around : placed.pixels) * side;
  const unsigned seen = placed.invertible & ~lessBits(covered, view.smallest_pixels) & (any ? 15 : ~placed.outside);
  const auto levelsOf = [&](std::size_t k) { return static_cast<float>(four[k].asset->parts[four[k].part].levels); };
  const auto isSeen = [seen](int k) { return seen >> k & 1 ? 1.0f : 0.0f; };
  const Lanes wanted_pixels = selectLess(0.0f, Lanes::of(isSeen(0), isSeen(1), isSeen(2), isSeen(3)), any ? around : placed.pixels, kHiddenWorth * around);
  float pixels[4], level[4];
  wanted_pixels.store(pixels);
  chooseDetail(wanted_pixels, view.pixels_per_voxel, view.finest_level, Lanes::of(levelsOf(0), levelsOf(1), levelsOf(2), levelsOf(3))).store(level);
  for (std::size_t k = 0; k < count; ++k) {
    ResidentPart& resident = four[k].asset->parts[four[k].part];
    const bool is_seen = seen >> k & 1;
    const Detail wanted = Detail::of(level[k]);
    if (placed.invertible >> k & 1) Residency::want(resident, wanted.level, std::min(pixels[k], 1e4f));
    four[k].detail = wanted.level < resident.finest ? Detail{resident.finest, 0} : wanted;
    four[k].drawn = is_seen && resident.finest != resident.levels;
    culled_ += !is_seen;
  }
}

void DrawList::write(const Frame& frame, const Candidate& candidate, const Lanes& low, const Lanes& high, float nearest) {
  const runtime::Instance& instance = *candidate.instance;
  const ResidentAsset& asset = *candidate.asset;
  const ResidentPart& resident = asset.parts[candidate.part];
  const Part& part = asset.packed[candidate.part];
  const std::span<const Knot> knots = candidate.knots;
  const bool any = frame.rays == Rays::kAny;
  has_heat_ = has_heat_ || (part.fog && part.fog->channels() > 1);

  Ordered& ordered = order_[count_++];
  ordered.key = ascending(frame.camera.eye.w == 0 ? alongView(frame.camera.eye, candidate.head, low, high) : std::max(nearest, 0.0f));
  ordered.texel = static_cast<std::uint32_t>(texels_);

  glm::uvec4* out = &records_[texels_];
  auto* const head = reinterpret_cast<RecordHead*>(out);
  *head = candidate.head;
  if (any) worldToPart(*head);
  out += sizeof *head / sizeof *out;
  *out++ = bitsOf(instance.tint);
  put(low, static_cast<std::uint32_t>(knots.size() - 1), *out++);
  put(high, asset.palette() + asset.levels[resident.first_level]->table, *out++);
  const glm::vec3 size(part.size);
  put(Lanes::of(size.x, size.y, size.z, 0), static_cast<std::uint32_t>(candidate.detail.level | (any ? 0 : candidate.detail.coarser) << 8 | resident.levels << 16),
      *out++);
  *out++ = glm::uvec4(asset.palette(), candidate.index, candidate.part, any ? 0 : outlineOf(candidate.head.eye, low, high));
  out = writeSegments(out, knots);
  if (!any && frame.view.previous_world_to_clip) {
    const int index = static_cast<int>(candidate.part);
    runtime::Instance before = instance;
    if (instance.previous_pose) before.pose = instance.previous_pose;
    if (instance.previous_to_world) before.to_world = *instance.previous_to_world;
    const glm::mat4 rows(glm::transpose(glm::dmat4(*frame.view.previous_world_to_clip) * glm::dmat4(runtime::partToWorld(before, index))));
    for (int row = 0; row < 4; ++row) *out++ = bitsOf(rows[row]);
    out = writeSegments(out, before.pose ? before.pose->knots(index) : part.knots);
  }
  texels_ = static_cast<std::size_t>(out - records_.data());
}

// Sorts the parts, and writes the numbers of their records behind the records. The order serves speed, and that of fog what can be told apart: 15 bits of the depths' fractions do,
// three rounds of a radix sort that leaves equals as they were.
Result<void> DrawList::writeOrder(PartKind kind) {
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
  for (std::size_t i = 0; i < count_; ++i) numbers[i] = order_[kind == PartKind::kFog ? count_ - 1 - i : i].texel;
  return {};
}

}  // namespace kelp::gl
