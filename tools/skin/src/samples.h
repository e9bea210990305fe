// SPDX-License-Identifier: MIT
// The surface of a skin as points.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include <glm/glm.hpp>

#include "kelp/import/core/frame.h"
#include "kelp/import/core/source_model.h"

namespace kelp::bake {

// Points on the triangles, in voxels of a frame. Linear blend skinning takes sample i to the sum over its
// weights of weight x motion(joint) x position.
struct SkinSamples {
  struct Weighted {
    std::uint32_t joint = 0;
    double weight = 0;  // above 0; those of a sample sum to 1
  };
  std::vector<glm::dvec3> positions;        // in the bind pose
  std::vector<glm::dvec3> normals;          // of their triangles; 0: it has no area
  std::vector<double> areas;                // above 0
  std::vector<std::uint32_t> triangles;     // of the soup
  std::vector<glm::dvec3> shares;           // of its corners
  std::vector<std::size_t> first_weighted;  // of each sample, and the end
  std::vector<Weighted> weighted;           // of a sample: each joint once, ascending
  std::vector<double> slopes;               // of each of these: slopesUnder(); may be empty: 0
  double spacing = 0;                       // voxels between neighbors, at most

  std::size_t size() const { return positions.size(); }
  std::span<const Weighted> weights(std::size_t i) const {
    return {weighted.data() + first_weighted[i], first_weighted[i + 1] - first_weighted[i]};
  }
  std::uint32_t heaviestJoint(std::size_t i) const;
};

// Each triangle is cut into small ones with edges of at most `edge` voxels, or more so that there are no more
// than about `most` samples. One sample lies in each, where `inside` says: its coordinates along two edges.
SkinSamples sampleSkin(const TriangleSoup& soup, const SourceSkin& skin, const Frame& frame, double edge,
                       const glm::dvec2& inside, std::size_t most);

// Adds a share of a vertex's weights to a list.
void addWeights(const SourceSkin& skin, std::uint32_t vertex, double share,
                std::vector<SkinSamples::Weighted>& list);

// Where a morph target moves samples, or nodes, if its weight is 1; ascending.
struct Offset {
  std::uint32_t index = 0;
  glm::dvec3 by{0};  // voxels
};
std::vector<Offset> offsetsOf(const SourceSkin::Morph& morph, const SkinSamples& samples,
                              const TriangleSoup& soup, const SourceSkin& skin, const Frame& frame);

// Finds samples by the voxels that they are in.
class SampleFinder {
 public:
  // size: voxels of the box. The samples must outlive the object.
  SampleFinder(const SkinSamples& samples, const glm::ivec3& size);
  // The nearest sample to a point of the box.
  std::uint32_t nearest(const glm::dvec3& point) const;

 private:
  const SkinSamples& samples_;
  glm::ivec3 size_;
  std::vector<std::pair<std::size_t, std::uint32_t>> of_voxels_;
};

}  // namespace kelp::bake
