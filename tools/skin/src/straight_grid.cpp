// SPDX-License-Identifier: MIT
#include "straight_grid.h"

#include <algorithm>
#include <cmath>

#include "kelp/common/dense_index.h"
#include "kelp/common/parallel.h"
#include "rigid.h"

namespace kelp::bake {
namespace {

// From the part's voxels to those of the whole, and back, by the center line of the bind pose.
class BindPose {
 public:
  BindPose(const SkinSweep& sweep, const SkinSpace& space, const VoxelGrid& whole)
      : sweep_(sweep), place_(sweep.place), whole_(whole) {
    for (int column = 0; column < 4; ++column) place_[column] *= space.voxels;
  }
  const glm::dmat4x3& place() const { return place_; }

  // The sections of a layer of voxels.
  glm::dmat4x3 layer(int y) const {
    return compose(place_, glm::dmat4x3(sectionAt(sweep_.arcs, static_cast<float>(y) + 0.5f)));
  }
  // The center of a voxel of the part, in the whole.
  glm::dvec3 inWhole(const glm::dmat4x3& layer, const glm::ivec3& at) const {
    const glm::dvec3 off = glm::dvec3(at) + 0.5 - sweep_.corner();
    return layer * glm::dvec4(off.x, 0, off.z, 1);
  }
  // The voxel of the part where the center of one of the whole goes; outside of it: false.
  bool inPart(std::uint64_t index, glm::ivec3& voxel) const {
    const glm::dmat3 axes = linearOf(place_);
    const glm::dvec3 center = glm::dvec3(voxelAt(whole_.size, index)) + 0.5;
    const auto rest =
        unsweepPoint(sweep_.arcs, sweep_.size, glm::vec3(glm::transpose(axes) * (center - place_[3])));
    if (!rest) return false;
    voxel = glm::ivec3(glm::floor(*rest));
    return glm::all(glm::greaterThanEqual(voxel, glm::ivec3(0))) &&
           glm::all(glm::lessThan(voxel, sweep_.size));
  }

 private:
  const SkinSweep& sweep_;
  glm::dmat4x3 place_;  // voxels of the whole <- of the part, where the part begins
  const VoxelGrid& whole_;
};

// The voxels of the whole that a part has.
class ListedVoxels {
 public:
  static constexpr std::uint64_t kNone = ~std::uint64_t{0};
  ListedVoxels(const std::vector<std::uint64_t>& list, const VoxelOwners& owners, const VoxelGrid& whole)
      : owners_(owners), whole_(whole), listed_(whole.solid.size(), 0) {
    for (const std::uint64_t index : list) listed_[index] = 1;
  }

  bool isSurface(std::uint64_t index) const { return whole_.surface[owners_.surface[index]].index == index; }

  // The listed voxel that a point within the mesh belongs to, or kNone. Deep inside it is the one around it;
  // near the surface the nearest triangle decides, so that the surface is as smooth as that of the whole.
  std::uint64_t sourceAt(const glm::dvec3& point, const MeshSurface& surface) const {
    const glm::ivec3 at(glm::floor(point));
    if (isInBox(at)) {
      const std::uint64_t here = denseIndex(whole_.size, at);
      if (whole_.solid[here] && !listed_[here]) return kNone;  // another part's
      if (listed_[here]) {
        const glm::ivec3 off = voxelAt(whole_.size, whole_.surface[owners_.surface[here]].index) - at;
        if (glm::dot(glm::vec3(off), glm::vec3(off)) > 3 || surface.contains(point).value_or(true))
          return here;
        return kNone;
      }
    }
    std::uint64_t nearest = kNone;
    double least = 1e9;
    eachAround(at, [&](const glm::ivec3& voxel, std::uint64_t index) {
      const glm::dvec3 off = glm::dvec3(voxel) + 0.5 - point;
      if (!listed_[index] || glm::dot(off, off) >= least) return;
      least = glm::dot(off, off);
      nearest = index;
    });
    return nearest != kNone && surface.contains(point).value_or(false) ? nearest : kNone;
  }

  // True if one of the voxels around is marked.
  bool isKeptAround(std::uint64_t index, const std::vector<std::uint8_t>& kept) const {
    bool found = false;
    eachAround(voxelAt(whole_.size, index),
               [&](const glm::ivec3&, std::uint64_t other) { found = found || kept[other]; });
    return found;
  }

 private:
  bool isInBox(const glm::ivec3& at) const {
    return glm::all(glm::greaterThanEqual(at, glm::ivec3(0))) && glm::all(glm::lessThan(at, whole_.size));
  }
  template <class Visit>
  void eachAround(const glm::ivec3& at, const Visit& visit) const {
    for (int z = -1; z <= 1; ++z)
      for (int y = -1; y <= 1; ++y)
        for (int x = -1; x <= 1; ++x) {
          const glm::ivec3 voxel = at + glm::ivec3(x, y, z);
          if (isInBox(voxel)) visit(voxel, denseIndex(whole_.size, voxel));
        }
  }

  const VoxelOwners& owners_;
  const VoxelGrid& whole_;
  std::vector<std::uint8_t> listed_;
};

}  // namespace

Nearest MeshSurface::nearest(const glm::dvec3& point) const {
  return bvh_.nearest(point, std::numeric_limits<double>::infinity(),
                      [&](std::uint32_t i) { return mesh_.triangles[i].source != kCap; });
}

std::optional<bool> MeshSurface::contains(const glm::dvec3& point) const {
  const Nearest first = bvh_.nearest(point);
  if (!mesh_.components[mesh_.triangles[first.triangle].component].solid) return std::nullopt;
  // Between two triangles, the one that is seen less from aside tells.
  constexpr double kAlike = 1e-6;
  const Nearest second = bvh_.nearest(point, std::sqrt(first.squared) + kAlike,
                                      [&](std::uint32_t i) { return i != first.triangle; });
  const auto side = [&](const Nearest& nearest) {
    const glm::dvec3 area = mesh_.areaVector(mesh_.triangles[nearest.triangle]);
    return glm::dot(point - nearest.point, area) / std::max(glm::length(area), 1e-12);
  };
  double told = side(first);
  if (second.triangle != kCap && std::abs(side(second)) > std::abs(told)) told = side(second);
  return told < 0;
}

glm::vec3 openDirection(const fields::Occupancy& occupancy, const glm::ivec3& at) {
  constexpr int kFar = 2;
  glm::vec3 sum(0);
  for (int z = -kFar; z <= kFar; ++z)
    for (int y = -kFar; y <= kFar; ++y)
      for (int x = -kFar; x <= kFar; ++x) {
        const glm::ivec3 to = at + glm::ivec3(x, y, z);
        const bool inside =
            glm::all(glm::greaterThanEqual(to, glm::ivec3(0))) && glm::all(glm::lessThan(to, occupancy.size));
        if (!inside || !occupancy.solid[occupancy.index(to)]) sum += glm::vec3(x, y, z);
      }
  const float length = glm::length(sum);
  return length > 0 ? sum / length : glm::vec3(0);
}

VoxelGrid straightGrid(const SkinSweep& sweep, const SkinSpace& space, const MeshSurface& surface,
                       const std::vector<std::uint64_t>& list, const VoxelOwners& owners,
                       const VoxelGrid& whole, int threads) {
  const BindPose bind(sweep, space, whole);
  const ListedVoxels listed(list, owners, whole);
  fields::Occupancy occupancy{sweep.size, std::vector<std::uint8_t>(denseCount(sweep.size), 0)};
  // Of solid voxels: the listed voxel that they come from.
  std::vector<std::uint64_t> sources(occupancy.solid.size(), ListedVoxels::kNone);
  parallelRanges(static_cast<std::size_t>(sweep.size.y), 1, threads, [&](std::size_t begin, std::size_t end) {
    for (int y = static_cast<int>(begin); y < static_cast<int>(end); ++y) {
      const glm::dmat4x3 layer = bind.layer(y);
      for (int z = 0; z < sweep.size.z; ++z)
        for (int x = 0; x < sweep.size.x; ++x)
          sources[occupancy.index({x, y, z})] = listed.sourceAt(bind.inWhole(layer, {x, y, z}), surface);
    }
  });
  std::vector<std::uint8_t> kept(whole.solid.size(), 0);
  for (std::size_t i = 0; i < sources.size(); ++i) {
    if (sources[i] == ListedVoxels::kNone) continue;
    occupancy.solid[i] = 1;
    kept[sources[i]] = 1;
  }
  for (const std::uint64_t from : list) {
    glm::ivec3 voxel;
    if (!listed.isSurface(from) || listed.isKeptAround(from, kept) || !bind.inPart(from, voxel)) continue;
    occupancy.solid[occupancy.index(voxel)] = 1;
    sources[occupancy.index(voxel)] = from;
  }
  VoxelGrid grid;
  grid.size = sweep.size;
  grid.to_node = glm::mat4x3(compose(glm::dmat4x3(whole.to_node), bind.place()));
  const std::vector<std::uint64_t> shown = fields::surfaceVoxels(occupancy, threads);
  grid.surface.resize(shown.size());
  parallelRanges(shown.size(), 256, threads, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const glm::ivec3 at = voxelAt(grid.size, shown[i]);
      const glm::dmat4x3 layer = bind.layer(at.y);
      SurfaceSample& sample = grid.surface[i];
      sample = whole.surface[owners.surface[sources[shown[i]]]];
      glm::dvec3 normal(sample.normal);
      const glm::dvec3 point = bind.inWhole(layer, at);
      const Nearest nearest = surface.nearest(point);
      // The surface of the whole, or a cut through its inside.
      constexpr double kNear = 1.5, kTooNear = 0.02;
      const glm::vec3 open = nearest.squared > kNear * kNear ? openDirection(occupancy, at) : glm::vec3(0);
      if (nearest.squared <= kNear * kNear) {
        sample.material = surface.look().materialAt(nearest);
        sample.source = surface.look().sourceAt(nearest);
        if (nearest.squared > kTooNear * kTooNear) {
          const glm::dvec3 away = glm::normalize(point - nearest.point);
          normal = glm::dot(away, normal) < 0 ? -away : away;
        }
      }
      sample.normal =
          open != glm::vec3(0) ? open : glm::vec3(glm::normalize(glm::transpose(linearOf(layer)) * normal));
      sample.index = shown[i];
    }
  });
  grid.solid = std::move(occupancy.solid);
  return grid;
}

}  // namespace kelp::bake
