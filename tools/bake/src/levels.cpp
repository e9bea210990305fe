// SPDX-License-Identifier: MIT
// Levels: occupancy by OR, normals and colours by average.
#include "levels.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <utility>

#include "kelp/bake/bake.h"
#include "kelp/common/dense_index.h"
#include "kelp/common/parallel.h"
#include "kelp/fields/fields.h"
#include "palette.h"

namespace kelp::bake {
namespace {

// A surface voxel of some level. Coarser levels follow from what level 0 stores, so that a pack that comes
// back through another format has them again; from there on colours and normals stay unrounded from level to
// level.
using Attribute = SurfaceSample;

// Low bits of the normals of coarser levels that are all ones: 0.16 degrees off in the mean, 0.32 at worst,
// where nobody sees it, and two thirds of the bytes.
constexpr int kCoarseOnes = 3;

// The commonest of at most eight sources; the lowest of several.
std::uint32_t commonest(const std::array<std::uint32_t, 8>& sources, std::size_t count) {
  std::uint32_t best = sources[0];
  std::ptrdiff_t most = 0;
  for (std::size_t i = 0; i < count; ++i) {
    const std::ptrdiff_t votes =
        std::count(sources.begin(), sources.begin() + static_cast<std::ptrdiff_t>(count), sources[i]);
    if (votes < most || (votes == most && sources[i] >= best)) continue;
    most = votes;
    best = sources[i];
  }
  return best;
}

std::vector<Attribute> coarserAttributes(const std::vector<Attribute>& fine, const glm::ivec3& fine_size,
                                         const glm::ivec3& coarse_size) {
  struct Child {
    std::uint64_t parent;
    std::size_t at;
  };
  std::vector<Child> children(fine.size());
  for (std::size_t i = 0; i < fine.size(); ++i) {
    children[i] = {denseIndex(coarse_size, voxelAt(fine_size, fine[i].index) / 2), i};
  }
  std::sort(children.begin(), children.end(), [](const Child& a, const Child& b) {
    return a.parent != b.parent ? a.parent < b.parent : a.at < b.at;
  });
  std::vector<Attribute> coarse;
  for (std::size_t begin = 0; begin < children.size();) {
    std::size_t end = begin;
    glm::vec3 normal(0);
    glm::vec4 base(0);
    glm::dvec3 emissive(0);  // of floats without a bound
    float metallic = 0, roughness = 0;
    std::array<std::uint32_t, 8> sources{};
    for (; end < children.size() && children[end].parent == children[begin].parent; ++end) {
      const Attribute& child = fine[children[end].at];
      normal += child.normal;
      base += child.material.base_color;
      emissive += glm::dvec3(child.material.emissive);
      metallic += child.material.metallic;
      roughness += child.material.roughness;
      sources[end - begin] = child.source;
    }
    const float share = 1.0f / static_cast<float>(end - begin);
    Attribute& parent = coarse.emplace_back();
    parent.index = children[begin].parent;
    const float length = std::sqrt(glm::dot(normal, normal));
    // Children that face all ways, as on a thin sheet, cancel: any one of them is better than rounding.
    parent.normal = length * share > 0.1f ? normal / length : fine[children[begin].at].normal;
    parent.material.base_color = base * share;
    parent.material.emissive = glm::vec3(emissive / static_cast<double>(end - begin));
    parent.material.metallic = metallic * share;
    parent.material.roughness = roughness * share;
    parent.source = commonest(sources, end - begin);
    begin = end;
  }
  return coarse;
}

}  // namespace

int levelCount(const glm::ivec3& size, int asked) {
  int count = 1;
  for (int side = std::max({size.x, size.y, size.z}); side > kBrickSide && count < kMaxLevels;
       side = (side + 1) / 2)
    ++count;
  return asked > 0 ? std::min(asked, count) : count;
}

std::vector<RawLevel> buildLevels(VoxelGrid grid, const std::vector<std::uint8_t>& palette_indices,
                                  const std::vector<Material>& palette, int levels, int threads,
                                  const Progress& progress, const std::vector<std::uint32_t>& sources) {
  std::vector<MaterialPoint> points;
  points.reserve(palette.size());
  for (const Material& entry : palette) points.push_back(materialPoint(entry));
  // The entries of each source, if sources are kept apart.
  std::map<std::uint32_t, std::vector<std::size_t>> entries_of;
  std::map<std::uint32_t, std::vector<MaterialPoint>> points_of;
  for (std::size_t e = 0; e < sources.size(); ++e) {
    entries_of[sources[e]].push_back(e);
    points_of[sources[e]].push_back(points[e]);
  }
  const auto nearestOf = [&](const Attribute& attribute) {
    const MaterialPoint point = materialPoint(attribute.material);
    return sources.empty()
               ? nearestEntry(points, point)
               : entries_of.at(attribute.source)[nearestEntry(points_of.at(attribute.source), point)];
  };
  std::vector<Attribute> attributes = std::move(grid.surface);

  std::vector<RawLevel> built;
  fields::Occupancy occupancy{grid.size, std::move(grid.solid)};
  const int count = levelCount(grid.size, levels);
  for (int level = 0; level < count; ++level) {
    if (progress && !progress("levels", 1 - std::pow(4.0, -level)))
      throw ToolError(Exit::kInterrupted, "interrupted");
    if (level > 0) {
      fields::Occupancy coarse = fields::coarser(occupancy, threadCount(threads));
      attributes = coarserAttributes(attributes, occupancy.size, coarse.size);
      occupancy = std::move(coarse);
    }
    std::vector<fields::SurfaceVoxel> surface(attributes.size());
    parallelRanges(attributes.size(), 4096, threads, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) {
        const std::size_t entry = level == 0 ? palette_indices[i] : nearestOf(attributes[i]);
        const std::uint32_t normal = encodeNormal(attributes[i].normal, level == 0 ? 0 : kCoarseOnes);
        surface[i] = {attributes[i].index, makeAttribute(static_cast<std::uint8_t>(entry), normal)};
        if (level > 0) continue;
        attributes[i].material = palette[entry];
        attributes[i].normal = decodeNormal(normal);
      }
    });
    built.push_back(fields::buildLevel(occupancy, surface, threadCount(threads)));
  }
  if (progress && !progress("levels", 1.0)) throw ToolError(Exit::kInterrupted, "interrupted");
  return built;
}

}  // namespace kelp::bake
