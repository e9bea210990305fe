// SPDX-License-Identifier: MIT
// Levels: occupancy by OR, normals and colors by average.
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <span>
#include <utility>

#include <glm/common.hpp>

#include "kelp/bake/bake.h"
#include "kelp/common/dense_index.h"
#include "kelp/common/parallel.h"
#include "kelp/fields/fields.h"
#include "palette.h"
#include "steps.h"

namespace kelp::bake {
namespace {

// A surface voxel of some level. Coarser levels follow from what level 0 stores, so that a pack that comes
// back through another format has them again; from there on colors and normals stay unrounded from level to
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

// The attribute of a coarser voxel from its children, given by their places in the finer level.
Attribute parentOf(const std::vector<Attribute>& fine, std::uint64_t index,
                   std::span<const std::size_t> children) {
  glm::vec3 normal(0);
  glm::vec4 base(0);
  glm::dvec3 emissive(0);  // of floats without a bound
  float metallic = 0, roughness = 0;
  std::array<std::uint32_t, 8> sources{};
  std::size_t count = 0;
  for (const std::size_t at : children) {
    const Attribute& child = fine[at];
    normal += child.normal;
    base += child.material.base_color;
    emissive += glm::dvec3(child.material.emissive);
    metallic += child.material.metallic;
    roughness += child.material.roughness;
    sources[count++] = child.source;
  }
  const float share = 1.0f / static_cast<float>(count);
  Attribute parent;
  parent.index = index;
  const float length = std::sqrt(glm::dot(normal, normal));
  // Children that face all ways, as on a thin sheet, cancel: any one of them is better than rounding.
  parent.normal = length * share > 0.1f ? normal / length : fine[children.front()].normal;
  parent.material.base_color = base * share;
  parent.material.emissive = glm::vec3(emissive / static_cast<double>(count));
  parent.material.metallic = metallic * share;
  parent.material.roughness = roughness * share;
  parent.source = commonest(sources, count);
  return parent;
}

// One slice of the coarser level, of two of the finer, which begin at `starts` and end at the last of these:
// the children of a row lie in four rows, each in the order of x.
std::vector<Attribute> coarserSlice(const std::vector<Attribute>& fine, const glm::ivec3& fine_size,
                                    const glm::ivec3& coarse_size, int z,
                                    const std::array<std::size_t, 3>& starts) {
  struct Row {
    std::size_t at, end;
    std::uint64_t first;  // the index of its voxel 0
    int parent(const std::vector<Attribute>& fine) const {
      return at == end ? std::numeric_limits<int>::max() : static_cast<int>((fine[at].index - first) / 2);
    }
  };
  std::vector<Attribute> coarse;
  std::array<std::size_t, 2> next = {starts[0], starts[1]};  // of each fine slice
  for (int y = 0; y < coarse_size.y; ++y) {
    std::array<Row, 4> rows;
    for (std::size_t r = 0; r < 4; ++r) {
      std::size_t& at = next[r / 2];
      rows[r].first =
          denseIndex(fine_size, 0, 2 * y + static_cast<int>(r % 2), 2 * z + static_cast<int>(r / 2));
      rows[r].at = at;
      while (at < starts[r / 2 + 1] &&
             fine[at].index - rows[r].first < static_cast<std::uint64_t>(fine_size.x))
        ++at;
      rows[r].end = at;
    }
    for (;;) {
      int x = std::numeric_limits<int>::max();
      for (const Row& row : rows) x = std::min(x, row.parent(fine));
      if (x == std::numeric_limits<int>::max()) break;
      std::array<std::size_t, 8> children{};
      std::size_t count = 0;
      for (Row& row : rows)
        while (row.parent(fine) == x) children[count++] = row.at++;
      coarse.push_back(parentOf(fine, denseIndex(coarse_size, x, y, z), std::span(children).first(count)));
    }
  }
  return coarse;
}

std::vector<Attribute> coarserAttributes(const std::vector<Attribute>& fine, const glm::ivec3& fine_size,
                                         const glm::ivec3& coarse_size, int threads) {
  const auto slices = static_cast<std::size_t>(coarse_size.z);
  const auto firstOf = [&](int slice) {
    const std::uint64_t first = denseIndex(fine_size, 0, 0, slice);
    return static_cast<std::size_t>(
        std::lower_bound(fine.begin(), fine.end(), first,
                         [](const Attribute& a, std::uint64_t index) { return a.index < index; }) -
        fine.begin());
  };
  std::vector<std::vector<Attribute>> found(slices);
  parallelRanges(slices, 1, threads, [&](std::size_t slice, std::size_t) {
    const int z = static_cast<int>(slice);
    found[slice] = coarserSlice(fine, fine_size, coarse_size, z,
                                {firstOf(2 * z), firstOf(2 * z + 1), firstOf(2 * z + 2)});
  });
  std::size_t count = 0;
  for (const auto& its : found) count += its.size();
  std::vector<Attribute> coarse;
  coarse.reserve(count);
  for (const auto& its : found) coarse.insert(coarse.end(), its.begin(), its.end());
  return coarse;
}

// encodeNormal() and decodeNormal(), which take long, of normals that come again soon: neighbors often share
// a triangle.
class NormalCodes {
 public:
  struct Code {
    glm::vec3 normal{std::numeric_limits<float>::quiet_NaN()}, decoded{0};  // not a number: none yet
    std::uint32_t code = 0;
  };
  explicit NormalCodes(int ones) : ones_(ones) {}

  const Code& of(const glm::vec3& normal) {
    const glm::uvec3 bits = glm::floatBitsToUint(normal);
    Code& its = known_[((bits.x * 0x9e3779b1u) ^ (bits.y * 0x85ebca6bu) ^ (bits.z * 0xc2b2ae35u)) >> 22];
    if (its.normal != normal) {
      its.normal = normal;
      its.code = encodeNormal(normal, ones_);
      its.decoded = decodeNormal(its.code);
    }
    return its;
  }

 private:
  int ones_;
  std::array<Code, 1024> known_{};
};

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
  fields::SolidBits bits({grid.size, std::move(grid.solid)}, threadCount(threads));
  const int count = levelCount(grid.size, levels);
  for (int level = 0; level < count; ++level) {
    if (progress && !progress("levels", 1 - std::pow(4.0, -level)))
      throw ToolError(Exit::kInterrupted, "interrupted");
    if (level > 0) {
      fields::SolidBits coarse = fields::coarser(bits, threadCount(threads));
      attributes = coarserAttributes(attributes, bits.size(), coarse.size(), threads);
      bits = std::move(coarse);
    }
    std::vector<fields::SurfaceVoxel> surface(attributes.size());
    parallelRanges(attributes.size(), 4096, threads, [&](std::size_t begin, std::size_t end) {
      NormalCodes codes(level == 0 ? 0 : kCoarseOnes);
      for (std::size_t i = begin; i < end; ++i) {
        const std::size_t entry = level == 0 ? palette_indices[i] : nearestOf(attributes[i]);
        const NormalCodes::Code& normal = codes.of(attributes[i].normal);
        surface[i] = {attributes[i].index, makeAttribute(static_cast<std::uint8_t>(entry), normal.code)};
        if (level > 0) continue;
        attributes[i].material = palette[entry];
        attributes[i].normal = normal.decoded;
      }
    });
    built.push_back(fields::buildLevel(bits, surface, threadCount(threads)));
  }
  if (progress && !progress("levels", 1.0)) throw ToolError(Exit::kInterrupted, "interrupted");
  return built;
}

// Level by level: of the voxels, and then of halvings of the coarsest level.
std::vector<RawDistances> buildDistances(const RawPart& part, int threads, const Progress& progress) {
  const int voxel_levels = static_cast<int>(part.levels.size());
  const int count = distanceLevels(part.size, voxel_levels);
  std::vector<RawDistances> built;
  fields::Occupancy coarse;  // beyond the voxels' levels
  for (int level = 0; level < count; ++level) {
    if (progress && !progress("distances", 1 - std::pow(4.0, -level)))
      throw ToolError(Exit::kInterrupted, "interrupted");
    const DistanceBand band = distanceBand(part.size, voxel_levels, level);
    if (level < voxel_levels) {
      built.push_back(fields::buildDistances(part.levels[static_cast<std::size_t>(level)],
                                             levelSize(part.size, level), band, threadCount(threads)));
      continue;
    }
    if (level == voxel_levels)
      coarse = fields::occupancyOf(part.levels.back(), levelSize(part.size, level - 1));
    coarse = fields::coarser(coarse, threadCount(threads));
    built.push_back(fields::buildDistances(coarse, band, threadCount(threads)));
  }
  if (progress && !progress("distances", 1.0)) throw ToolError(Exit::kInterrupted, "interrupted");
  return built;
}

}  // namespace kelp::bake
