// SPDX-License-Identifier: MIT
#include "solid.h"

#include <algorithm>
#include <atomic>
#include <cmath>

#include "kelp/common/dense_index.h"
#include "kelp/common/parallel.h"
#include "kelp/fields/fields.h"
#include "kelp/formats/brick.h"

namespace kelp::bake {
namespace {

// what has no color: a light gray
const Material kStone{glm::vec4(0.6f, 0.6f, 0.6f, 1), glm::vec3(0), 0, 1};

// Measures the surface: whole constant cells at once where their neighbors are constant too.
class SurfaceScan {
 public:
  SurfaceScan(const VolumeGrid& grid, const VolumeRule& rule) : sampler_(grid), rule_(rule) {}

  void addCube(const glm::ivec3& low, int side, double value) {
    result_.solid += std::pow(static_cast<double>(side), 3);
    result_.box.first = glm::min(result_.box.first, low);
    result_.box.last = glm::max(result_.box.last, low + (side - 1));
    for (int axis = 0; axis < 3; ++axis) {
      for (int sign = -1; sign <= 1; sign += 2) {
        glm::ivec3 beside = low;
        beside[axis] += sign < 0 ? -1 : side;
        addFace(beside, axis, sign, side, rule_.distance(value));
      }
    }
  }
  const SolidBox& result() const { return result_; }

 private:
  // The square of `side` voxels from `beside` on, which touches the solid on its side -sign.
  void addFace(const glm::ivec3& beside, int axis, int sign, int side, double here) {
    const VolumeCell cell = sampler_.cellAt(beside);
    if (cell.side < side) {
      const int part = side == VolumeGrid::kUpperSide   ? VolumeGrid::kLowerSide
                       : side == VolumeGrid::kLowerSide ? VolumeGrid::kLeafSide
                                                        : 1;
      const int u = (axis + 1) % 3, v = (axis + 2) % 3;
      for (int i = 0; i < side; i += part)
        for (int j = 0; j < side; j += part) {
          glm::ivec3 at = beside;
          at[u] += i;
          at[v] += j;
          addFace(at, axis, sign, part, here);
        }
      return;
    }
    const double value = cell.value.x;
    if (rule_.solid(value)) return;
    result_.faces += static_cast<double>(side) * side;
    const double there = rule_.distance(value), share = here / (here - there);
    const double crossing = beside[axis] - sign + sign * (share >= 0 && share <= 1 ? share : 0.5);
    result_.box.low[axis] = std::min(result_.box.low[axis], crossing);
    result_.box.high[axis] = std::max(result_.box.high[axis], crossing);
  }

  VolumeSampler sampler_;
  const VolumeRule& rule_;
  SolidBox result_;
};

class SolidSampler {
 public:
  SolidSampler(const VolumeGrid& grid, const VolumeRule& rule, const Lattice& lattice)
      : sampler_(grid), rule_(rule), lattice_(lattice) {}

  // The field at the center of a part voxel, or `offset` voxels beside it.
  double at(const glm::ivec3& voxel, const glm::dvec3& offset = glm::dvec3(0)) const {
    const glm::dvec3 place = lattice_.center(voxel, offset);
    return lattice_.exact ? sampler_.at(glm::ivec3(glm::round(place))) : sampler_.between(place);
  }

  // Outward, in part voxels. The zero vector where the field does not say.
  glm::dvec3 normal(const glm::ivec3& voxel) const {
    const glm::dvec3 g = rule_.binary ? smoothedGradient(voxel) : centralDifferences(voxel);
    const double length = glm::length(g);
    return length > 0 && std::isfinite(length) ? g / length : glm::dvec3(0, 1, 0);
  }

 private:
  glm::dvec3 centralDifferences(const glm::ivec3& voxel) const {
    glm::dvec3 g;
    for (int axis = 0; axis < 3; ++axis) {
      glm::dvec3 step(0);
      step[axis] = 1;
      g[axis] = at(voxel, step) - at(voxel, -step);
    }
    return rule_.below ? g : -g;
  }

  // Of zeros and ones central differences know few directions: those of the occupancy under a Gaussian of 1.5
  // voxels know all.
  glm::dvec3 smoothedGradient(const glm::ivec3& voxel) const {
    constexpr int kRadius = 3;
    constexpr double kSigma = 1.5;
    glm::dvec3 g(0);
    for (int z = -kRadius; z <= kRadius; ++z)
      for (int y = -kRadius; y <= kRadius; ++y)
        for (int x = -kRadius; x <= kRadius; ++x) {
          const glm::dvec3 offset(x, y, z);
          if (rule_.solid(at(voxel, offset)))
            g -= offset * std::exp(-glm::dot(offset, offset) / (2 * kSigma * kSigma));
        }
    return g;
  }

  VolumeSampler sampler_;
  const VolumeRule& rule_;
  const Lattice& lattice_;
};

// Of the active values around a place, as much as trilinear interpolation would take of each; false if there
// are none.
bool colorAt(const VolumeSampler& color, const glm::dvec3& place, glm::dvec3& result) {
  // Places on the lattice itself, up to rounding: the voxel's own value.
  const glm::dvec3 near = glm::round(place),
                   at = glm::all(glm::lessThan(glm::abs(place - near), glm::dvec3(1e-4))) ? near : place;
  const glm::dvec3 floor = glm::floor(at), f = at - floor;
  double sum = 0;
  result = glm::dvec3(0);
  for (int corner = 0; corner < 8; ++corner) {
    const glm::ivec3 step(corner & 1, corner >> 1 & 1, corner >> 2 & 1);
    const double weight = (step.x ? f.x : 1 - f.x) * (step.y ? f.y : 1 - f.y) * (step.z ? f.z : 1 - f.z);
    if (!(weight > 0)) continue;
    const VolumeCell cell = color.cellAt(glm::ivec3(floor) + step);
    if (!cell.active || !std::isfinite(cell.value.x + cell.value.y + cell.value.z)) continue;
    result += weight * cell.value;
    sum += weight;
  }
  if (sum > 0) result /= sum;
  return sum > 0;
}

}  // namespace

SolidBox solidBox(const InputFiles& files, const std::string& place, const VolumeGrid& grid,
                  const VolumeRule& rule) {
  SurfaceScan scan(grid, rule);
  grid.tree->visit(
      [&](const VolumeCell& cell) {
        if (rule.solid(cell.value.x)) scan.addCube(cell.low, cell.side, cell.value.x);
      },
      [&](const VolumeLeaf& leaf) {
        for (std::size_t i = 0; i < VolumeGrid::kLeafVoxels; ++i)
          if (const double value = leaf.values[i]; rule.solid(value)) scan.addCube(leaf.voxel(i), 1, value);
      });
  if (scan.result().solid == 0)
    refuse(Exit::kInvalid, files.input(), place,
           std::string("has no voxel at or ") + (rule.below ? "below" : "above") +
               " the isovalue: nothing is inside; give another --isovalue");
  return scan.result();
}

VoxelGrid sampleSolid(const InputFiles& files, const VolumeGrid& grid, const VolumeRule& rule,
                      const Lattice& lattice, const SolidLooks& looks, int threads, ColorCounts& counts) {
  const VolumeGrid* const color = looks.color;
  VoxelGrid out;
  out.size = lattice.size;
  const auto side = glm::u64vec3(lattice.size);
  out.solid.assign(denseCount(out.size), 0);
  parallelRanges(side.z, 1, threads, [&](std::size_t begin, std::size_t end) {
    const SolidSampler sampler(grid, rule, lattice);
    for (std::size_t z = begin; z < end; ++z)
      for (std::size_t y = 0; y < side.y; ++y)
        for (std::size_t x = 0; x < side.x; ++x)
          out.solid[denseIndex(out.size, x, y, z)] = rule.solid(sampler.at(glm::ivec3(x, y, z))) ? 1 : 0;
  });
  fields::Occupancy occupancy{out.size, std::move(out.solid)};
  const std::vector<std::uint64_t> surface = fields::surfaceVoxels(occupancy, threads);
  out.solid = std::move(occupancy.solid);
  if (surface.empty())
    refuse(Exit::kInvalid, files.input(), "", "has no solid voxel at this resolution; give a larger one");
  out.surface.resize(surface.size());
  const glm::dmat4 to_color =
      color != nullptr ? glm::inverse(color->to_world) * grid.to_world : glm::dmat4(1);
  const VolumeGrid* const attribute = looks.attribute;
  const glm::dmat4 to_attribute =
      attribute != nullptr ? glm::inverse(attribute->to_world) * grid.to_world : glm::dmat4(1);
  // of directions, where the lattice is exact
  const glm::mat3 to_part(glm::transpose(glm::dmat3(lattice.to_index)));
  std::atomic<std::uint64_t> missing{0}, clipped{0}, unpainted{0};
  parallelRanges(surface.size(), 4096, threads, [&](std::size_t begin, std::size_t end) {
    const SolidSampler sampler(grid, rule, lattice);
    std::optional<VolumeSampler> colors;
    if (color != nullptr) colors.emplace(*color);
    std::optional<VolumeSampler> attributes;
    if (attribute != nullptr) attributes.emplace(*attribute);
    for (std::size_t i = begin; i < end; ++i) {
      const std::uint64_t index = surface[i];
      const glm::ivec3 voxel = voxelAt(out.size, index);
      SurfaceSample& sample = out.surface[i];
      sample = {index, glm::vec3(0), kStone};
      PaintedVoxel painted;
      const bool has_paint =
          attributes &&
          paintedVoxel(*attributes, glm::dvec3(to_attribute * glm::dvec4(lattice.center(voxel), 1)), painted);
      sample.normal = has_paint ? to_part * painted.normal : glm::vec3(sampler.normal(voxel));
      glm::dvec3 value;
      if (colors) {
        const glm::dvec3 place = glm::dvec3(to_color * glm::dvec4(lattice.center(voxel), 1));
        if (onLattice(place) && colorAt(*colors, place, value)) {
          const glm::dvec3 shown = glm::clamp(value, 0.0, 1.0);
          if (shown != value) ++clipped;
          sample.material.base_color = glm::vec4(glm::vec3(shown), 1);
        } else {
          ++missing;
        }
      }
      if (has_paint && painted.entry < looks.palette.size() &&
          glm::vec3(sample.material.base_color) == glm::vec3(looks.palette[painted.entry].base_color)) {
        sample.material = looks.palette[painted.entry];
        sample.source = static_cast<std::uint32_t>(painted.entry);
      } else {
        ++unpainted;
      }
    }
  });
  counts = {missing, clipped, unpainted};
  return out;
}

}  // namespace kelp::bake
