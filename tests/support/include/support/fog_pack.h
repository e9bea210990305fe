// SPDX-License-Identifier: MIT
// Packs of fog made in memory, and what a ray through one must see: double precision, small constant steps,
// the map solved anew at every sample.
#pragma once

#include <algorithm>
#include <cmath>
#include <functional>
#include <vector>

#include "kelp/fields/fields.h"
#include "kelp/formats/fog.h"
#include "support/test_pack.h"

namespace kelp::test {

// 0 to 1 at a place of the unit cube.
using FogShape = std::function<double(const glm::dvec3&)>;

// Round puffs with edges that fade.
inline double puffs(const glm::dvec3& p) {
  constexpr double kPuffs[4][4] = {
      {0.5, 0.25, 0.5, 0.24}, {0.35, 0.55, 0.6, 0.2}, {0.68, 0.6, 0.4, 0.17}, {0.5, 0.84, 0.5, 0.13}};
  double sum = 0;
  for (const auto& puff : kPuffs) {
    const double away = glm::distance(p, glm::dvec3(puff[0], puff[1], puff[2])) / puff[3];
    sum += away < 1 ? (1 - away * away) *
                          (0.6 + 0.4 * std::sin(23 * p.x) * std::sin(31 * p.y) * std::cos(19 * p.z))
                    : 0;
  }
  return std::clamp(sum, 0.0, 1.0);
}

inline fields::FogSamples fogOf(const glm::ivec3& size, const FogShape& density, const FogShape& heat = {}) {
  fields::FogSamples fog;
  fog.size = size;
  for (int z = 0; z < size.z; ++z)
    for (int y = 0; y < size.y; ++y)
      for (int x = 0; x < size.x; ++x) {
        const glm::dvec3 at = (glm::dvec3(x, y, z) + 0.5) / glm::dvec3(size);
        fog.density.push_back(fogCode(density(at)));
        if (heat) fog.heat.push_back(static_cast<std::uint8_t>(std::lround(255 * heat(at))));
      }
  return fog;
}

// One part, placed as partOf's. extinction: optical depth of a voxel's edge where the density is 1.
inline RawPack fogPack(fields::FogSamples fog, float extinction, std::vector<Knot> knots = {}) {
  RawPack pack = packOf({glm::ivec3(8, fog.size.y, 8),
                         std::vector<std::uint8_t>(static_cast<std::size_t>(64 * fog.size.y), 1)});
  RawPart& part = pack.parts[0];
  part.size = fog.size;
  const float s = 1.0f / static_cast<float>(fog.size.y);
  part.to_object[3] =
      s * glm::vec3(-0.5f * static_cast<float>(fog.size.x), 0, -0.5f * static_cast<float>(fog.size.z));
  part.knots = knots.empty() ? figureKnots(kFigure6[0]) : std::move(knots);
  part.fog = RawFog{};
  part.fog->color = {0.9f, 0.8f, 0.7f};
  if (!fog.heat.empty()) {
    part.fog->glow = extinction;
    part.fog->ramp = {{0, 0, 0}, {0.6f, 0.1f, 0}, {1, 0.8f, 0.3f}};
  }
  part.levels.clear();
  while (true) {
    part.levels.push_back(fields::buildFogLevel(fog, 1));
    part.levels.back().extinction = extinction;
    if (std::max({fog.size.x, fog.size.y, fog.size.z}) <= 8) return pack;
    fog = fields::coarserFog(fog, extinction, 1);
  }
}

// The light of a ray.
struct FogSight {
  double through = 1;  // of what is behind
  glm::dvec3 glow{0};
};

// The field of one level of a part as it is defined, and rays through it.
class FogTruth {
 public:
  FogTruth(const RawPart& part, int level)
      : part_(part),
        level_(level),
        samples_(fields::fogSamplesOf(part.levels[static_cast<std::size_t>(level)],
                                      levelSize(part.size, level))) {}

  // At a place of the undeformed part, level-0 voxels; 0 outside of it.
  double density(const glm::dvec3& rest) const {
    return sample(rest, samples_.density, [](std::uint8_t code) { return double{fogDensity(code)}; });
  }
  double heat(const glm::dvec3& rest) const {
    return samples_.heat.empty()
               ? 0
               : sample(rest, samples_.heat, [](std::uint8_t code) { return code / 255.0; });
  }

  // Along o + s r of part space, posed; r is a unit vector. step: of s, level-0 voxels.
  FogSight look(std::span<const Knot> knots, const glm::dvec3& o, const glm::dvec3& r, double s0, double s1,
                double step = 1.0 / 32) const {
    const auto place = [&](const glm::dvec3& p, auto&& visit) {
      if (const std::optional<glm::dvec3> rest = undeform(knots, p)) visit(*rest);
    };
    return lookThrough(place, o, r, s0, s1, step);
  }
  // The same by any map: places(p, visit) visits every place at rest that is at p of part space.
  template <class Places>
  FogSight lookThrough(Places&& places, const glm::dvec3& o, const glm::dvec3& r, double s0, double s1,
                       double step) const {
    FogSight sight;
    const int steps = std::max(1, static_cast<int>(std::ceil((s1 - s0) / step)));
    const double ds = (s1 - s0) / steps;
    for (int i = 0; i < steps; ++i) {
      double depth = 0;
      places(o + (s0 + (i + 0.5) * ds) * r, [&](const glm::dvec3& rest) {
        const double hot = heat(rest);
        if (hot > 0) sight.glow += sight.through * double{part_.fog->glow} * hot * ds * ramp(hot);
        depth += extinction() * density(rest) * ds;
      });
      sight.through *= std::exp(-depth);
    }
    return sight;
  }
  double extinction() const { return part_.levels[static_cast<std::size_t>(level_)].extinction; }

  // Of a place of part space; none above and below the spline.
  std::optional<glm::dvec3> undeform(std::span<const Knot> knots, const glm::dvec3& p) const {
    const double height = part_.size.y;
    const double low = height * double{knots.front().position.y},
                 high = height * double{knots.back().position.y};
    if (p.y < low || p.y > high) return std::nullopt;
    for (std::size_t i = 0; i + 1 < knots.size(); ++i) {
      if (p.y > height * double{knots[i + 1].position.y} && i + 2 < knots.size()) continue;
      double a = 0, b = 1;
      for (int n = 0; n < 60; ++n) {
        const double t = 0.5 * (a + b);
        (height * hermite(knots, i, t).y < p.y ? a : b) = t;
      }
      const glm::dvec3 at = height * hermite(knots, i, 0.5 * (a + b));
      return glm::dvec3(p.x - at.x, (p.y - low) * height / (high - low), p.z - at.z);
    }
    return std::nullopt;
  }

 private:
  // In heights of the part, as the knots.
  static glm::dvec3 hermite(std::span<const Knot> knots, std::size_t i, double t) {
    const double w = double{knots[i + 1].at} - double{knots[i].at};
    return (2 * t * t * t - 3 * t * t + 1) * glm::dvec3(knots[i].position) +
           (t * t * t - 2 * t * t + t) * w * glm::dvec3(knots[i].tangent) +
           (-2 * t * t * t + 3 * t * t) * glm::dvec3(knots[i + 1].position) +
           (t * t * t - t * t) * w * glm::dvec3(knots[i + 1].tangent);
  }
  glm::dvec3 ramp(double heat) const {
    const double at = heat * (static_cast<double>(part_.fog->ramp.size()) - 1);
    const std::size_t below = std::min(static_cast<std::size_t>(at), part_.fog->ramp.size() - 2);
    return glm::mix(glm::dvec3(part_.fog->ramp[below]), glm::dvec3(part_.fog->ramp[below + 1]),
                    at - static_cast<double>(below));
  }
  template <class Value>
  double sample(const glm::dvec3& rest, const std::vector<std::uint8_t>& codes, Value&& value) const {
    for (int axis = 0; axis < 3; ++axis)
      if (rest[axis] < 0 || rest[axis] > part_.size[axis]) return 0;
    const glm::dvec3 q =
        glm::clamp(rest / std::exp2(level_) - 0.5, glm::dvec3(0), glm::dvec3(samples_.size - 1));
    const glm::ivec3 low(glm::floor(q)), high = glm::min(low + 1, samples_.size - 1);
    double sum = 0;
    for (int corner = 0; corner < 8; ++corner) {
      glm::dvec3 weight;
      glm::ivec3 at;
      for (int axis = 0; axis < 3; ++axis) {
        const bool up = corner >> axis & 1;
        at[axis] = up ? high[axis] : low[axis];
        weight[axis] = up ? q[axis] - low[axis] : 1 - (q[axis] - low[axis]);
      }
      sum += weight.x * weight.y * weight.z *
             value(codes[static_cast<std::size_t>(at.x + samples_.size.x * (at.y + samples_.size.y * at.z))]);
    }
    return sum;
  }

  const RawPart& part_;
  int level_;
  fields::FogSamples samples_;
};

}  // namespace kelp::test
