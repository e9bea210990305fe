// SPDX-License-Identifier: MIT
// The surface of a skin as points that are dense enough to be labeled.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <numeric>
#include <vector>

#include <glm/glm.hpp>

#include "kelp/import/core/frame.h"
#include "kelp/import/core/source_model.h"

namespace kelp::bake {

// The space in which skins are divided: the box's longest side is 128 units long, so that the parts do not
// depend on the resolution.
struct SkinSpace {
  glm::dmat4 from_soup{1};
  glm::dmat4 to_soup{1};
  double voxels = 1;  // a unit's
};
inline constexpr double kSkinSide = 128;
SkinSpace skinSpace(const Frame& frame);

// Points of the triangles, refined until edges are short. Where linear blend skinning draws point i at a
// moment: the sum over its weighted points of motion(joint) x. Between corners this is what is drawn: the
// triangle of the moved corners.
struct SkinSamples {
  struct Weighted {
    std::uint32_t joint = 0;
    glm::dvec4 x{0};  // the sum of weight (position, 1); x.w is the joint's weight
  };
  struct Edge {
    std::uint32_t a = 0, b = 0;
    double width = 0;  // of the strip between the two: the length that a seam has there
  };
  struct Neighbor {
    std::uint32_t sample = 0;
    double width = 0;
  };
  std::vector<glm::dvec3> positions;  // in the bind pose
  std::vector<double> areas;
  std::vector<std::size_t> first_weighted;  // of each sample, and the end
  std::vector<Weighted> weighted;           // each joint once
  std::vector<std::array<std::uint32_t, 3>> triangles;
  std::vector<Edge> edges;
  std::vector<std::size_t> first_neighbor;  // of each sample, and the end
  std::vector<Neighbor> neighbors;
  double area = 0;

  std::size_t size() const { return positions.size(); }
  // The weight of the joint at sample i.
  double weight(std::size_t i, std::uint32_t joint) const;
  std::uint32_t heaviestJoint(std::size_t i) const;
};

// Samples of a soup that has skinned corners; no more than about `most`.
SkinSamples makeSkinSamples(const TriangleSoup& soup, const SourceSkin& skin, const SkinSpace& space,
                            std::size_t most = 200000);

// The least value that, with those below it, has this share of the weight. At least one value.
inline double weightedQuantile(const std::vector<double>& values, const std::vector<double>& weights,
                               double share) {
  std::vector<std::size_t> order(values.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
    return values[a] < values[b] || (values[a] == values[b] && a < b);
  });
  const double wanted = share * std::accumulate(weights.begin(), weights.end(), 0.0);
  double below = 0;
  for (const std::size_t i : order) {
    below += weights[i];
    if (below >= wanted) return values[i];
  }
  return values[order.back()];
}

}  // namespace kelp::bake
