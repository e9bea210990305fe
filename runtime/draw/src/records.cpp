// SPDX-License-Identifier: MIT
// The draw list's parts as records, and the order in which they are drawn.
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstring>
#include <utility>

#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/gtc/type_precision.hpp>
#include <glm/matrix.hpp>

#include "draw_list.h"
#include "record_spline.h"

namespace kelp::draw {
namespace {

// Puts world -> part space in place of part -> clip space.
void worldToPart(RecordHead& head) {
  const glm::vec4(&rows)[3] = head.to_world;
  const glm::dmat4 inverse = glm::inverse(glm::transpose(
      glm::dmat4(glm::dvec4(rows[0]), glm::dvec4(rows[1]), glm::dvec4(rows[2]), glm::dvec4(0, 0, 0, 1))));
  const glm::mat4 inverse_rows(glm::transpose(inverse));
  for (int row = 0; row < 4; ++row) head.to_clip[row] = inverse_rows[row];
}

constexpr int kWayShift = 30;  // of a Way in a key

// Ascends with a number, whatever its sign, below the bits of a Way.
std::uint32_t ascending(float number) {
  std::uint32_t bits;
  std::memcpy(&bits, &number, sizeof bits);
  return (bits >> 31 ? ~bits : bits | 0x80000000u) >> 2;
}

// How far along the view's direction a part's bounds begin, for orthographic views, where clip w is constant.
float alongView(const glm::dvec4& direction, const RecordHead& head) {
  glm::vec4 along(0);
  for (int row = 0; row < 3; ++row) along += static_cast<float>(direction[row]) * head.to_world[row];
  const glm::vec3 slope(along), middle = 0.5f * (head.low + head.high);
  return glm::dot(slope, middle) + along.w - glm::dot(glm::abs(slope), head.high - middle);
}

// A linear function of part space: positive beyond the near plane.
glm::vec4 nearPlane(const Camera& camera, const PlacedParts& placed, std::size_t k) {
  const float low = camera.clip_range == ClipRange::kZeroToOne ? 0.0f : -1.0f;
  glm::vec4 plane;
  for (int column = 0; column < 4; ++column) {
    const float z = placed.to_clip[2][column].of[k], w = placed.to_clip[3][column].of[k];
    plane[column] = camera.reversed_depth ? w - z : z - low * w;
  }
  return plane;
}

// True if the near plane cuts the bounds of the part, or they are behind it or the eye.
bool meetsNearPlane(const Camera& camera, const PlacedParts& placed, std::size_t k) {
  if (!(placed.nearest.of[k] > 0)) return true;
  const glm::vec4 plane = nearPlane(camera, placed, k);
  float middle = plane.w, reach = 0;
  for (int axis = 0; axis < 3; ++axis) {
    const float from = placed.bounds.min[axis].of[k], to = placed.bounds.max[axis].of[k];
    middle += 0.5f * (from + to) * plane[axis];
    reach += 0.5f * (to - from) * std::abs(plane[axis]);
  }
  return !(middle > 1.0001f * reach);
}

// True if a node is by more than so many voxels on the positive side of a plane, beyond rounding.
bool isBeyond(const glm::vec4& plane, const glm::vec3& node, float voxels) {
  const float size = glm::dot(glm::abs(glm::vec3(plane)), glm::abs(node)) + std::abs(plane.w);
  return glm::dot(glm::vec3(plane), node) + plane.w > 1e-5f * size + voxels * glm::length(glm::vec3(plane));
}

// True if every ray of a cage begins in one of its faces: no node is behind the eye, or closer than a voxel,
// and the near plane does not cut the inside, which the nodes around it enclose.
bool beginsInFaces(const Camera& camera, const PlacedParts& placed, std::size_t k,
                   const runtime::PosedCage& posed) {
  glm::vec4 w;
  for (int column = 0; column < 4; ++column) w[column] = placed.to_clip[3][column].of[k];
  for (const glm::vec3& node : posed.nodes)
    if (!isBeyond(w, node, 1)) return false;
  const glm::vec4 near = nearPlane(camera, placed, k);
  const Cage& cage = *posed.cage;
  for (std::uint32_t cell = 0; cell < cage.cells(); ++cell)
    for (int face = 0; face < 6; ++face) {
      if (cage.beyond(cell, face) != kCageInside) continue;
      for (int corner = 0; corner < 8; ++corner)
        if ((corner >> (face / 2) & 1) == face % 2 &&
            !isBeyond(near, posed.nodes[cage.node(cell, corner)], 0))
          return false;
    }
  return true;
}

}  // namespace

std::uint32_t DrawList::texelOf(const RecordHead& head) const {
  return static_cast<std::uint32_t>(reinterpret_cast<const glm::uvec4*>(&head) - records_.data());
}

void DrawList::write(const Frame& frame, std::size_t eight, std::size_t count) {
  const PosedParts& posed = posed_[eight];
  const PlacedParts& placed = placed_[eight];
  std::uint32_t outlines[8] = {};
  if (frame.rays == Rays::kView) outlineParts(frame.projection.eye.w == 0, placed, outlines);
  RecordHead unused;
  RecordHead* heads[8];
  Way ways[8] = {};
  // Segments first, because each overwrites what follows it.
  glm::uvec4* const begin = &records_[texels_];
  glm::uvec4* out = begin;
  for (std::size_t k = 0; k < 8; ++k) {
    const Candidate& candidate = block_[8 * eight + k];
    heads[k] = &unused;
    if (k >= count || !candidate.recorded) continue;
    heads[k] = reinterpret_cast<RecordHead*>(out);
    const auto record = static_cast<std::uint32_t>(out - records_.data());
    bool traced = frame.boxes || outlines[k] == 0 || meetsNearPlane(frame.view.camera, placed, k);
    if (traced && !frame.boxes && frame.rays == Rays::kView && candidate.caged)
      traced = !beginsInFaces(frame.view.camera, placed, k, candidate.posed);
    ways[k] = candidate.caged      ? (traced ? Way::kTraced : Way::kCaged)
              : candidate.arcs > 0 ? Way::kSwept
                                   : Way::kSheared;
    out = writeSpline(frame, candidate, posed, k, traced, out + kHeadTexels);
    if (frame.rings) link(candidate, record, static_cast<std::size_t>(out++ - records_.data()));
  }
  if (out == begin) return;
  texels_ += static_cast<std::size_t>(out - begin);
  writeHeads(frame.projection, placed, heads);
  for (std::size_t k = 0; k < count; ++k) {
    if (heads[k] == &unused) continue;
    const Candidate& candidate = block_[8 * eight + k];
    heads[k]->segments = candidate.caged
                             ? kCagedSpline | static_cast<std::uint32_t>(candidate.posed.nodes.size())
                         : candidate.arcs > 0 ? kSweptSpline | candidate.arcs
                                              : static_cast<std::uint32_t>(posed.knots[k].size() - 1);
    heads[k]->outline = outlines[k];
    finish(frame, candidate, ways[k], placed.nearest.of[k], *heads[k]);
  }
}

// Writes the part of a record behind its head: how the part is bent now and in the frame before.
glm::uvec4* DrawList::writeSpline(const Frame& frame, const Candidate& candidate, const PosedParts& posed,
                                  std::size_t k, bool traced, glm::uvec4* out) {
  if (candidate.caged) {
    runtime::PosedCage posed_cage = candidate.posed;
    if (traced || frame.hasTrees())  // its pose was good when it was bounded
      posed_cage = runtime::posedCage(*candidate.instance, static_cast<int>(candidate.part),
                                      candidate.detail.level, runtime::CageUse::kTree)
                       .value();
    out = writeCage(posed_cage, out);
  } else if (candidate.arcs > 0) {
    std::copy_n(&arcs_[candidate.arcs_at], arcTexels(candidate.arcs), out);
    out += arcTexels(candidate.arcs);
  } else {
    out = writeSegments(out, posed.knots[k], posed.extents[k]->y);
  }
  if (frame.movesPictures())
    out = writeMotion(*frame.view.camera.previous_world_to_clip, *candidate.instance, candidate.part,
                      candidate.tolerance, candidate.detail.level, chain_, out);
  return out;
}

// Makes a record the last one of its instance's ring. `place`: where it leads on.
void DrawList::link(const Candidate& candidate, std::uint32_t record, std::size_t place) {
  if (ring_.instance == candidate.index)
    records_[ring_.last] = glm::uvec4(record, 0, 0, 0);
  else
    ring_ = {candidate.index, record, place};
  records_[place] = glm::uvec4(ring_.first, 0, 0, 0);
  ring_.last = place;
}

void DrawList::finish(const Frame& frame, const Candidate& candidate, Way way, float nearest,
                      RecordHead& head) {
  const ResidentAsset& asset = *candidate.asset;
  const ResidentPart& resident = *candidate.resident;
  const bool fog = frame.kind == PartKind::kFog, swept = way == Way::kSwept;
  if (fog && asset.packed[candidate.part].fog->channels() > 1) has_heat_[swept] = true;

  if (candidate.drawn) {
    Ordered& ordered = order_[count_++];
    ordered.key = ascending(frame.projection.eye.w == 0 ? alongView(frame.projection.eye, head)
                                                        : std::max(nearest, 0.0f));
    ordered.key = fog ? (ordered.key & ~kSweptFog) | (swept ? kSweptFog : 0)
                      : ordered.key | static_cast<std::uint32_t>(way) << kWayShift;
    ordered.texel = texelOf(head);
  }

  const bool any = frame.rays == Rays::kAny;
  if (any) worldToPart(head);
  head.tint = candidate.instance->tint;
  head.levels_at = asset.palette() + resident.table;
  head.detail = static_cast<std::uint32_t>(candidate.detail.level |
                                           (any ? 0 : candidate.detail.coarser | candidate.coarse << 7) << 8 |
                                           resident.levels << 16 | resident.distances << 24);
  head.palette = candidate.palette;
  head.instance = candidate.index;
  head.part = candidate.part;
}

// Sorts the parts, and writes the numbers of their records after the records. The order of solids serves
// speed only, and that of fog need only separate visibly different depths. So 13 bits of the depths'
// fractions are enough: three rounds of a stable radix sort.
Result<void> DrawList::writeOrder(PartKind kind) {
  std::fill_n(begins_, kWays + 1, 0u);
  if (count_ == 0) return {};
  rows_ = (texels_ + (count_ + 3) / 4 + kRecordWidth - 1) / kRecordWidth;
  if (!records_.grow(rows_ * kRecordWidth) || !sorted_.grow(count_)) return kNoMemoryForFrame;
  constexpr int kRounds = 3, kLowestBit = 8;
  constexpr std::uint32_t kBuckets = 256;
  const auto bucketOf = [](std::uint32_t key, int round) {
    return key >> (kLowestBit + 8 * round) & (kBuckets - 1);
  };
  std::uint32_t starts[kRounds][kBuckets] = {};
  for (std::size_t i = 0; i < count_; ++i) {
    for (int round = 0; round < kRounds; ++round) ++starts[round][bucketOf(order_[i].key, round)];
  }
  for (auto& of_round : starts) {
    std::uint32_t sum = 0;
    for (std::uint32_t& start : of_round) sum += std::exchange(start, sum);
  }
  for (int round = 0; round < kRounds; ++round) {
    for (std::size_t i = 0; i < count_; ++i)
      sorted_[starts[round][bucketOf(order_[i].key, round)]++] = order_[i];
    std::swap(order_, sorted_);
  }
  if (kind == PartKind::kSolid) {
    for (const Ordered& ordered : order_.span().first(count_)) ++begins_[(ordered.key >> kWayShift) + 1];
    for (std::uint32_t way = 1; way <= kWays; ++way) begins_[way] += begins_[way - 1];
  }
  std::uint32_t* const numbers = reinterpret_cast<std::uint32_t*>(&records_[texels_]);
  for (std::size_t i = 0; i < count_; ++i)
    numbers[i] = order_[kind == PartKind::kFog ? count_ - 1 - i : i].texel;
  return {};
}

}  // namespace kelp::draw
