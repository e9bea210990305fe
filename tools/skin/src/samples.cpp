// SPDX-License-Identifier: MIT
#include "samples.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "kelp/common/dense_index.h"

namespace kelp::bake {
namespace {

using Weighted = SkinSamples::Weighted;

struct SampledTriangle {
  std::array<glm::dvec3, 3> corners;  // voxels
  glm::dvec3 normal{0};
  double area = 0, longest = 0;

  SampledTriangle(const TriangleSoup& soup, std::size_t t, const Frame& frame) {
    for (std::size_t c = 0; c < 3; ++c)
      corners[c] = glm::dvec3(frame.node_to_voxel *
                              glm::dvec4(glm::dvec3(soup.positions[soup.triangles[t].vertex[c]]), 1));
    const glm::dvec3 across = glm::cross(corners[1] - corners[0], corners[2] - corners[0]);
    area = 0.5 * glm::length(across);
    if (area > 0) normal = across / (2 * area);
    for (std::size_t c = 0; c < 3; ++c)
      longest = std::max(longest, glm::distance(corners[c], corners[(c + 1) % 3]));
  }
  // Small triangles along an edge.
  int cuts(double edge) const {
    constexpr double kMost = 1000;
    return static_cast<int>(std::clamp(std::ceil(longest / edge), 1.0, kMost));
  }
};

glm::ivec3 voxelIn(const glm::ivec3& size, const glm::dvec3& at) {
  return glm::ivec3(glm::clamp(glm::floor(at), glm::dvec3(0), glm::dvec3(size - 1)));
}

}  // namespace

std::uint32_t SkinSamples::heaviestJoint(std::size_t i) const {
  const std::span<const Weighted> all = weights(i);
  return std::max_element(all.begin(), all.end(),
                          [](const Weighted& a, const Weighted& b) { return a.weight < b.weight; })
      ->joint;
}

void addWeights(const SourceSkin& skin, std::uint32_t vertex, double share, std::vector<Weighted>& list) {
  double sum = 0;  // weights are floats: their sum differs from one by rounding
  for (std::uint32_t i = skin.first_influence[vertex]; i < skin.first_influence[vertex + 1]; ++i)
    sum += static_cast<double>(skin.influences[i].weight);
  for (std::uint32_t i = skin.first_influence[vertex]; i < skin.first_influence[vertex + 1]; ++i) {
    const SourceSkin::Influence& its = skin.influences[i];
    const double weight = share * static_cast<double>(its.weight) / sum;
    const auto same =
        std::find_if(list.begin(), list.end(), [&](const Weighted& w) { return w.joint == its.joint; });
    if (same == list.end())
      list.push_back({its.joint, weight});
    else
      same->weight += weight;
  }
}

SkinSamples sampleSkin(const TriangleSoup& soup, const SourceSkin& skin, const Frame& frame, double edge,
                       const glm::dvec2& inside, std::size_t most) {
  double area = 0;
  for (std::size_t t = 0; t < soup.triangles.size(); ++t) area += SampledTriangle(soup, t, frame).area;
  // Small triangles that are about equilateral have less than half of edge^2.
  edge = std::max(edge, std::sqrt(2 * area / static_cast<double>(most)));
  std::size_t count = 0;
  for (std::size_t t = 0; t < soup.triangles.size(); ++t) {
    const auto cuts = static_cast<std::size_t>(SampledTriangle(soup, t, frame).cuts(edge));
    count += cuts * (cuts + 1) / 2;
  }
  // Of tiny triangles, one sample stands for several.
  const double least = count > most ? area / static_cast<double>(most) : 0;
  SkinSamples samples;
  samples.first_weighted.push_back(0);
  samples.spacing = edge;
  double waiting = 0;
  std::vector<Weighted> list;
  for (std::size_t t = 0; t < soup.triangles.size(); ++t) {
    const SampledTriangle triangle(soup, t, frame);
    const int cuts = triangle.cuts(edge);
    for (int i = 0; i < cuts; ++i) {
      for (int j = 0; i + j < cuts; ++j) {
        waiting += 2 * triangle.area / (static_cast<double>(cuts) * (cuts + 1));
        if (!(waiting > least) && t + 1 < soup.triangles.size()) continue;
        const double u = (i + inside.x) / cuts, v = (j + inside.y) / cuts;
        const glm::dvec3 shares(1 - u - v, u, v);
        glm::dvec3 at(0);
        list.clear();
        for (int c = 0; c < 3; ++c) {
          const auto corner = static_cast<std::size_t>(c);
          at += shares[c] * triangle.corners[corner];
          addWeights(skin, soup.skinned[t][corner], shares[c], list);
        }
        std::sort(list.begin(), list.end(),
                  [](const Weighted& a, const Weighted& b) { return a.joint < b.joint; });
        samples.positions.push_back(at);
        samples.normals.push_back(triangle.normal);
        samples.areas.push_back(std::max(waiting, std::numeric_limits<double>::min()));
        samples.triangles.push_back(static_cast<std::uint32_t>(t));
        samples.shares.push_back(shares);
        samples.weighted.insert(samples.weighted.end(), list.begin(), list.end());
        samples.first_weighted.push_back(samples.weighted.size());
        waiting = 0;
      }
    }
  }
  return samples;
}

std::vector<Offset> offsetsOf(const SourceSkin::Morph& morph, const SkinSamples& samples,
                              const TriangleSoup& soup, const SourceSkin& skin, const Frame& frame) {
  std::vector<glm::dvec3> of_vertices(skin.first_influence.size() - 1, glm::dvec3(0));
  for (std::size_t i = 0; i < morph.vertices.size(); ++i)
    of_vertices[morph.vertices[i]] = glm::dmat3(frame.node_to_voxel) * glm::dvec3(morph.offsets[i]);
  std::vector<Offset> offsets;
  for (std::uint32_t s = 0; s < samples.size(); ++s) {
    glm::dvec3 by(0);
    for (int c = 0; c < 3; ++c)
      by +=
          samples.shares[s][c] * of_vertices[soup.skinned[samples.triangles[s]][static_cast<std::size_t>(c)]];
    if (by != glm::dvec3(0)) offsets.push_back({s, by});
  }
  return offsets;
}

SampleFinder::SampleFinder(const SkinSamples& samples, const glm::ivec3& size)
    : samples_(samples), size_(size) {
  for (std::uint32_t i = 0; i < samples.size(); ++i)
    of_voxels_.emplace_back(denseIndex(size_, voxelIn(size_, samples.positions[i])), i);
  std::sort(of_voxels_.begin(), of_voxels_.end());
}

std::uint32_t SampleFinder::nearest(const glm::dvec3& point) const {
  const glm::ivec3 voxel = voxelIn(size_, point);
  std::uint32_t best = 0;
  double least = -1;
  // Twice as far each time: what is nearer than the reach is found then.
  const int most = 2 * std::max({size_.x, size_.y, size_.z});
  for (int reach = 2; reach < 2 * most && (least < 0 || least > (reach / 2.0) * (reach / 2.0)); reach *= 2) {
    const glm::ivec3 low = glm::max(voxel - reach, 0), high = glm::min(voxel + reach, size_ - 1);
    for (int z = low.z; z <= high.z; ++z)
      for (int y = low.y; y <= high.y; ++y) {
        const std::pair first(denseIndex(size_, low.x, y, z), 0u);
        const std::size_t last = denseIndex(size_, high.x, y, z);
        for (auto at = std::lower_bound(of_voxels_.begin(), of_voxels_.end(), first);
             at != of_voxels_.end() && at->first <= last; ++at) {
          const glm::dvec3 apart = samples_.positions[at->second] - point;
          const double distance = glm::dot(apart, apart);
          if (least >= 0 && distance >= least) continue;
          least = distance;
          best = at->second;
        }
      }
  }
  return best;
}

}  // namespace kelp::bake
