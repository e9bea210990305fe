// SPDX-License-Identifier: MIT
#include "debug_lines.h"

#include <glm/common.hpp>
#include <glm/geometric.hpp>

namespace kelp::draw {
namespace {

constexpr int kPieces = 24;       // of a segment
constexpr float kKnotPixels = 4;  // from the middle of a knot's mark to its corners
constexpr std::size_t kBoxPoints = 24, kKnotPoints = 8, kSegmentPoints = 2 * kPieces, kFacePoints = 4;
// Linear; blue, green, red.
constexpr std::uint32_t kBoxColor = 0x00a0ff, kEyeInBoxColor = 0x0000ff, kSplineColor = 0xff00c0,
                        kKnotColor = 0x20ff40, kCageColor = 0xffc020;

glm::vec4 toClip(const RecordHead& part, const glm::vec3& at) {
  const glm::vec4 point(at, 1);
  return {glm::dot(part.to_clip[0], point), glm::dot(part.to_clip[1], point),
          glm::dot(part.to_clip[2], point), glm::dot(part.to_clip[3], point)};
}

std::span<const Knot> knotsOf(const RecordHead& part, const runtime::Instance& instance) {
  if (instance.pose) return instance.pose->knots(static_cast<int>(part.part));
  return instance.asset->pack().parts()[part.part].knots;
}

// The cage of the record; null: it has none.
const Cage* cageOf(const RecordHead& record, const runtime::Instance& instance) {
  if (!(record.segments & kCagedSpline) || record.segments >= kSweptSpline) return nullptr;
  const auto& head = reinterpret_cast<const CageHead&>(*(&record + 1));
  return &instance.asset->pack().parts()[record.part].cages[head.shape >> 8 & 255];
}

}  // namespace

Result<void> DebugLines::build(const View& view, const DrawList& list,
                               std::span<const runtime::Instance> instances) {
  const bool boxes = view.debug == DebugView::kBounds, cages = view.debug == DebugView::kCages;
  std::size_t needed = 0;
  for (std::uint32_t i = 0; i < list.parts(); ++i) {
    const RecordHead& part = list.record(i);
    const std::size_t knots = knotsOf(part, instances[part.instance]).size();
    const Cage* const cage = cageOf(part, instances[part.instance]);
    needed += boxes   ? kBoxPoints
              : cages ? (cage ? kFacePoints * cage->faces() : 0)
                      : kSegmentPoints * (knots - 1) + kKnotPoints * knots;
  }
  constexpr std::size_t kRow = kRecordWidth;
  count_ = 0;
  if (!points_.grow((needed + kRow - 1) / kRow * kRow)) return kNoMemoryForFrame;
  const glm::vec2 pixel = 2.0f / glm::vec2(view.camera.viewport);  // clip space at w = 1
  for (std::uint32_t i = 0; i < list.parts(); ++i) {
    const RecordHead& part = list.record(i);
    const runtime::Instance& instance = instances[part.instance];
    if (const Cage* const cage = cages ? cageOf(part, instance) : nullptr)
      addCage(part, *cage);
    else if (!cages)
      boxes ? addBox(part) : addSpline(part, knotsOf(part, instance), pixel);
  }
  return {};
}

std::span<const glm::uvec4> DebugLines::records() const {
  constexpr std::size_t kRow = kRecordWidth;
  return points_.span().first((count_ + kRow - 1) / kRow * kRow);
}

void DebugLines::addLine(const glm::vec4& from, const glm::vec4& to, std::uint32_t color) {
  for (const glm::vec4& at : {from, to})
    points_[count_++] =
        glm::uvec4(glm::floatBitsToUint(at.x), glm::floatBitsToUint(at.y), color, glm::floatBitsToUint(at.w));
}

void DebugLines::addBox(const RecordHead& part) {
  const auto corner = [&part](unsigned i) {
    return toClip(part, glm::mix(part.low, part.high, glm::bvec3(i & 1, i & 2, i & 4)));
  };
  for (unsigned i = 0; i < 8; ++i) {
    for (const unsigned axis : {1u, 2u, 4u}) {
      if (!(i & axis)) addLine(corner(i), corner(i | axis), part.outline ? kBoxColor : kEyeInBoxColor);
    }
  }
}

// The edges of cells that bound the cage's faces, without the diagonals.
void DebugLines::addCage(const RecordHead& part, const Cage& cage) {
  const auto* const nodes = reinterpret_cast<const glm::vec4*>(&part + 1) + kCageHeadTexels;
  for (std::uint32_t i = 0; i < cage.faces(); ++i) {
    const std::uint32_t face = cage.face(i);
    const std::uint32_t* const cell = cage.cell(face >> 5);
    const int(&order)[4] = kCageTetrahedra[face >> 2 & 7].corners;
    const int first = (face & 3) == 0 ? 1 : 0;
    glm::vec4 at[3];
    for (int k = 0; k < 3; ++k) at[k] = toClip(part, glm::vec3(nodes[cageNode(cell, order[first + k])]));
    addLine(at[0], at[1], kCageColor);
    addLine(at[1], at[2], kCageColor);
  }
}

void DebugLines::addSpline(const RecordHead& part, std::span<const Knot> knots, const glm::vec2& pixel) {
  const glm::vec3 middle(0.5f * part.size.x, 0, 0.5f * part.size.z);
  for (std::size_t k = 0; k + 1 < knots.size(); ++k) {
    const Segment segment = makeSegment(knots[k], knots[k + 1], part.size.y);
    glm::vec4 from = toClip(part, middle + segment.p0);
    for (int i = 1; i <= kPieces; ++i) {
      const glm::vec4 to = toClip(part, middle + evaluate(segment, static_cast<float>(i) / kPieces));
      addLine(from, to, kSplineColor);
      from = to;
    }
  }
  for (const Knot& knot : knots) {
    const glm::vec4 at = toClip(part, middle + part.size.y * knot.position);
    const glm::vec2 reach = kKnotPixels * at.w * pixel;
    const glm::vec4 x(reach.x, 0, 0, 0), y(0, reach.y, 0, 0);
    addLine(at + x, at + y, kKnotColor);
    addLine(at + y, at - x, kKnotColor);
    addLine(at - x, at - y, kKnotColor);
    addLine(at - y, at + x, kKnotColor);
  }
}

}  // namespace kelp::draw
