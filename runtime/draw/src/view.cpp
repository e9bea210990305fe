// SPDX-License-Identifier: MIT
// View: its checks, and the level that it draws at a pixel.
#include <cmath>

#include <glm/geometric.hpp>

#include "detail.h"
#include "kelp/cages/posed_cage.h"
#include "placing.h"
#include "record_spline.h"

namespace kelp::draw {
namespace {

constexpr int kMostBatches = 16;
constexpr float kWidestSun = 20;  // degrees

bool isGood(const Quality& quality) {
  return quality.finest_level >= 0 && quality.pixels_per_voxel >= 0 && quality.smallest_pixels >= 0 &&
         quality.shading <= Shading::kSmooth && quality.occlusion_rays >= 0 && quality.occlusion_rays <= 16 &&
         std::isfinite(quality.occlusion_reach) && quality.occlusion_reach > 0 && quality.soft_shadows >= 0 &&
         quality.soft_shadows <= kWidestSun && quality.depth_batches >= 1 &&
         quality.depth_batches <= kMostBatches;
}

}  // namespace

Result<void> checkView(const View& view, Features features) {
  const Camera& camera = view.camera;
  if (camera.viewport.x < 0 || camera.viewport.y < 0 || camera.clip_range > ClipRange::kZeroToOne ||
      view.output > Output::kDisplay || view.debug > DebugView::kCages)
    return Error{ErrorCode::kMisuse,
                 "the view has a negative viewport, or an unknown clip range, output or debug view"};
  const float length = glm::length(view.light.sun_direction);
  if (!std::isfinite(length) || !(length > 0)) return Error{ErrorCode::kMisuse, "the sun has no direction"};
  if (!isGood(view.quality))
    return Error{ErrorCode::kMisuse,
                 "the quality has a negative number, an unknown shading, more than 16 occlusion rays, "
                 "soft_shadows above 20 degrees, or depth_batches outside 1 .. 16"};
  if (!has(features, Features::kDistances) && usesDistances(view.quality))
    return Error{ErrorCode::kMisuse, "soft_shadows and occlusion need Features::kDistances"};
  if (!has(features, Features::kSecondaryRays) &&
      (view.quality.self_shadow || view.quality.occlusion_rays > 0))
    return Error{ErrorCode::kMisuse, "self_shadow and occlusion_rays need Features::kSecondaryRays"};
  if (has(features, Features::kGradientOnly) && view.quality.shading != Shading::kGradient)
    return Error{ErrorCode::kMisuse, "Features::kGradientOnly leaves kFaces and kSmooth out"};
  return {};
}

std::optional<int> levelAt(const View& view, const runtime::Instance& instance, int part,
                           const glm::ivec2& pixel) {
  if (!checkView(view, Features::kSecondaryRays | Features::kDistances) || !hasPixels(view))
    return std::nullopt;
  const auto projection = makeProjection(view);
  if (!projection || !instance.asset || part < 0 ||
      static_cast<std::size_t>(part) >= instance.asset->pack().parts().size())
    return std::nullopt;
  const Part& of = instance.asset->pack().parts()[static_cast<std::size_t>(part)];
  const std::span<const Knot> knots = instance.pose ? instance.pose->knots(part) : of.knots;
  const Result<glm::mat4> placed_at = runtime::partToWorld(instance, part);
  if (of.kind == PartKind::kEmpty || knots.size() != of.knots.size() || !placed_at) return std::nullopt;
  const glm::mat4 to_world = *placed_at;
  constexpr glm::mat4x3 kSame(1);
  const glm::vec4 extent(glm::vec3(of.size), static_cast<float>(of.levels));
  PosedParts parts;
  for (int i = 0; i < 8; ++i)
    parts.knots[i] = knots, parts.to_world[i] = &to_world, parts.to_object[i] = &kSame,
    parts.extents[i] = &extent;
  PlacedParts placed;
  // As the draw list bounds it.
  const auto boundAll = [&](const Box& box) {
    for (std::size_t i = 0; i < 8; ++i) setBounds(box, parts, i, placed);
    placeParts(*projection, parts, placed);
  };
  if (!of.cages.empty()) {
    const auto posed = runtime::posedCage(instance, part, 0, runtime::CageUse::kBounds);
    if (!posed) return std::nullopt;
    boundAll(posed->bounds);
  } else if (of.bend == Bend::kSweep) {
    boundAll(boxOfKnots(knots, of.size));
    JudgedParts judged;
    judgeParts(*projection, view, Rays::kView, placed, judged);
    ArcChain chain;
    float tolerance;
    const float roll = rollOf(of, instance.pose, part);
    if (!makeDrawnArcs(knots, of.kind, of.size, roll, judged.level.of[0], chain, tolerance))
      return std::nullopt;
    boundAll(chain.bounds);
  } else {
    if (!boundParts(parts, placed)) return std::nullopt;
    placeParts(*projection, parts, placed);
  }
  if (!placed.invertible) return std::nullopt;
  const Detail detail = detailAt(view, placed.pixels.of[0], of.levels);
  return detail.level + (drawsCoarser(detail, pixel) ? 1 : 0);
}

}  // namespace kelp::draw
