// SPDX-License-Identifier: MIT
#include "palette.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <tuple>
#include <utility>

#include "kelp/bake/bake.h"
#include "kelp/common/parallel.h"

namespace kelp::bake {
namespace {

constexpr std::size_t kEntriesAtOnce = 4096;
// Samples are pooled in cells of this size before clustering, below what the eye tells apart.
constexpr float kCell = 1.0f / 128.0f;
constexpr int kRounds = 8;

auto materialKey(const Material& m) {
  return std::make_tuple(m.base_color.x, m.base_color.y, m.base_color.z, m.base_color.w, m.emissive.x,
                         m.emissive.y, m.emissive.z, m.metallic, m.roughness);
}
bool less(const Material& a, const Material& b) { return materialKey(a) < materialKey(b); }
bool same(const Material& a, const Material& b) { return materialKey(a) == materialKey(b); }

// The numbers of a material that are averaged, in linear light.
using Vector = std::array<double, 9>;
Vector vectorOf(const Material& m) {
  return {m.base_color.x, m.base_color.y, m.base_color.z, m.base_color.w, m.emissive.x,
          m.emissive.y,   m.emissive.z,   m.metallic,     m.roughness};
}
Material meanMaterial(const Vector& sum, double weight) {
  Material m;
  const auto mean = [&](std::size_t i) { return static_cast<float>(sum[i] / weight); };
  m.base_color = {mean(0), mean(1), mean(2), mean(3)};
  m.emissive = {mean(4), mean(5), mean(6)};
  m.metallic = mean(7);
  m.roughness = mean(8);
  return m;
}

struct Pool {
  MaterialPoint point{};
  Vector sum{};
  double weight = 0;
};

// The distinct materials of all samples, ascending, or nothing if they are more than `limit`.
std::vector<Material> distinct(const std::vector<const VoxelGrid*>& grids, std::size_t limit) {
  std::vector<Material> found;
  for (const VoxelGrid* grid : grids) {
    const Material* last = nullptr;
    for (const SurfaceSample& sample : grid->surface) {
      if (last && same(*last, sample.material)) continue;
      last = &sample.material;
      const auto at = std::lower_bound(found.begin(), found.end(), sample.material, less);
      if (at != found.end() && same(*at, sample.material)) continue;
      if (found.size() == limit) return {};
      found.insert(at, sample.material);
    }
  }
  return found;
}

// Samples pooled by cell. `cell_of` gets the pool of each sample, grid by grid.
std::vector<Pool> poolSamples(const std::vector<const VoxelGrid*>& grids, int threads,
                              std::vector<std::uint32_t>& cell_of) {
  using Cell = std::array<std::int16_t, 9>;
  std::vector<Cell> cells;
  std::vector<const Material*> materials;
  for (const VoxelGrid* grid : grids) {
    for (const SurfaceSample& sample : grid->surface) materials.push_back(&sample.material);
  }
  cells.resize(materials.size());
  parallelRanges(materials.size(), kEntriesAtOnce, threads, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const MaterialPoint point = materialPoint(*materials[i]);
      for (std::size_t k = 0; k < point.size(); ++k)
        cells[i][k] = static_cast<std::int16_t>(std::lround(std::clamp(point[k], -250.0f, 250.0f) / kCell));
    }
  });
  std::vector<Cell> known(cells);
  std::sort(known.begin(), known.end());
  known.erase(std::unique(known.begin(), known.end()), known.end());
  cell_of.resize(cells.size());
  parallelRanges(cells.size(), kEntriesAtOnce, threads, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i)
      cell_of[i] =
          static_cast<std::uint32_t>(std::lower_bound(known.begin(), known.end(), cells[i]) - known.begin());
  });
  std::vector<Pool> pools(known.size());
  for (std::size_t i = 0; i < cells.size(); ++i) {
    Pool& pool = pools[cell_of[i]];
    const Vector v = vectorOf(*materials[i]);
    for (std::size_t k = 0; k < v.size(); ++k) pool.sum[k] += v[k];
    pool.weight += 1;
  }
  for (Pool& pool : pools) pool.point = materialPoint(meanMaterial(pool.sum, pool.weight));
  return pools;
}

// Median cut (Heckbert 1982) by variance: the box with the largest squared error is cut at its mean along its
// widest axis.
std::vector<Material> medianCut(std::vector<Pool>& pools, std::size_t count) {
  struct Cut {
    std::size_t begin, end;
    double error = 0;
    std::size_t axis = 0;
    float mean = 0;
  };
  const auto measured = [&](std::size_t begin, std::size_t end) {
    Cut cut{begin, end};
    double weight = 0;
    Vector sum{}, squares{};
    for (std::size_t i = begin; i < end; ++i) {
      weight += pools[i].weight;
      for (std::size_t k = 0; k < sum.size(); ++k) {
        sum[k] += pools[i].weight * static_cast<double>(pools[i].point[k]);
        squares[k] +=
            pools[i].weight * static_cast<double>(pools[i].point[k]) * static_cast<double>(pools[i].point[k]);
      }
    }
    double widest = 0;
    for (std::size_t k = 0; k < sum.size(); ++k) {
      const double variance = std::max(0.0, squares[k] - sum[k] * sum[k] / weight);
      cut.error += variance;
      if (variance > widest) {
        widest = variance;
        cut.axis = k;
        cut.mean = static_cast<float>(sum[k] / weight);
      }
    }
    return cut;
  };
  std::vector<Cut> cuts{measured(0, pools.size())};
  while (cuts.size() < count) {
    const auto worst = std::max_element(cuts.begin(), cuts.end(),
                                        [](const Cut& a, const Cut& b) { return a.error < b.error; });
    const auto begin = pools.begin() + static_cast<std::ptrdiff_t>(worst->begin),
               end = pools.begin() + static_cast<std::ptrdiff_t>(worst->end);
    const std::size_t axis = worst->axis;
    const float mean = worst->mean;
    const auto middle =
        std::stable_partition(begin, end, [&](const Pool& pool) { return pool.point[axis] < mean; });
    if (middle == begin || middle == end) {
      if (worst->error == 0) break;
      worst->error = 0;  // rounding alone: nothing left to cut
      continue;
    }
    const std::size_t at = static_cast<std::size_t>(middle - pools.begin());
    const std::size_t last = worst->end;
    *worst = measured(worst->begin, at);
    cuts.push_back(measured(at, last));
  }
  std::vector<Material> entries;
  for (const Cut& cut : cuts) {
    Vector sum{};
    double weight = 0;
    for (std::size_t i = cut.begin; i < cut.end; ++i) {
      for (std::size_t k = 0; k < sum.size(); ++k) sum[k] += pools[i].sum[k];
      weight += pools[i].weight;
    }
    entries.push_back(meanMaterial(sum, weight));
  }
  return entries;
}

std::vector<MaterialPoint> pointsOf(const std::vector<Material>& entries) {
  std::vector<MaterialPoint> points;
  points.reserve(entries.size());
  for (const Material& entry : entries) points.push_back(materialPoint(entry));
  return points;
}

std::vector<std::uint8_t> assign(const std::vector<Pool>& pools, const std::vector<Material>& entries,
                                 int threads) {
  const std::vector<MaterialPoint> points = pointsOf(entries);
  std::vector<std::uint8_t> index(pools.size());
  parallelRanges(pools.size(), 256, threads, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i)
      index[i] = static_cast<std::uint8_t>(nearestEntry(points, pools[i].point));
  });
  return index;
}

// Lloyd's iteration: each entry moves to the mean of what is nearest to it; an entry that nothing is nearest
// to stays.
void refine(const std::vector<Pool>& pools, int threads, std::vector<Material>& entries) {
  for (int round = 0; round < kRounds; ++round) {
    const std::vector<std::uint8_t> index = assign(pools, entries, threads);
    std::vector<Vector> sums(entries.size());
    std::vector<double> weights(entries.size(), 0);
    for (std::size_t i = 0; i < pools.size(); ++i) {
      for (std::size_t k = 0; k < pools[i].sum.size(); ++k) sums[index[i]][k] += pools[i].sum[k];
      weights[index[i]] += pools[i].weight;
    }
    for (std::size_t e = 0; e < entries.size(); ++e) {
      if (weights[e] > 0) entries[e] = meanMaterial(sums[e], weights[e]);
    }
  }
}

}  // namespace

std::size_t nearestEntry(const std::vector<MaterialPoint>& entries, const MaterialPoint& point) {
  std::size_t best = 0;
  float best_squared = std::numeric_limits<float>::infinity();
  for (std::size_t e = 0; e < entries.size(); ++e) {
    const float squared = squaredDistance(entries[e], point);
    if (squared < best_squared) {
      best_squared = squared;
      best = e;
    }
  }
  return best;
}

double colorDistance(const Material& a, const Material& b) {
  const glm::vec3 miss = toOklab(glm::vec3(a.base_color)) - toOklab(glm::vec3(b.base_color));
  return std::sqrt(static_cast<double>(miss.x * miss.x + miss.y * miss.y + miss.z * miss.z));
}

std::size_t countDistinct(const std::vector<const VoxelGrid*>& grids, std::size_t limit) {
  const bool none =
      std::all_of(grids.begin(), grids.end(), [](const VoxelGrid* grid) { return grid->surface.empty(); });
  const std::size_t found = distinct(grids, limit).size();
  return none || found > 0 ? found : limit + 1;
}

Palette clusterPalette(const std::vector<const VoxelGrid*>& grids, std::size_t limit, int threads) {
  Palette palette;
  palette.entries = distinct(grids, limit);
  if (!palette.entries.empty()) {
    for (const VoxelGrid* grid : grids) {
      std::vector<std::uint8_t>& indices = palette.indices.emplace_back(grid->surface.size());
      for (std::size_t i = 0; i < indices.size(); ++i) {
        indices[i] =
            static_cast<std::uint8_t>(std::lower_bound(palette.entries.begin(), palette.entries.end(),
                                                       grid->surface[i].material, less) -
                                      palette.entries.begin());
      }
    }
    return palette;
  }
  std::vector<std::uint32_t> cell_of;
  const std::vector<Pool> pools = poolSamples(grids, threads, cell_of);
  if (pools.empty()) {  // no sample at all
    palette.entries.emplace_back();
    palette.indices.resize(grids.size());
    return palette;
  }
  std::vector<Pool> cut(pools);
  palette.entries = medianCut(cut, limit);
  refine(pools, threads, palette.entries);
  std::sort(palette.entries.begin(), palette.entries.end(), less);
  const std::vector<std::uint8_t> index = assign(pools, palette.entries, threads);

  double error = 0;
  std::size_t at = 0;
  for (const VoxelGrid* grid : grids) {
    std::vector<std::uint8_t>& indices = palette.indices.emplace_back();
    for (const SurfaceSample& sample : grid->surface) {
      indices.push_back(index[cell_of[at++]]);
      error += colorDistance(sample.material, palette.entries[indices.back()]);
    }
  }
  palette.mean_error = error / static_cast<double>(at);
  return palette;
}

}  // namespace kelp::bake
