// SPDX-License-Identifier: MIT
#include "memory_estimate.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <tuple>

#include <fmt/format.h>
#ifdef __GLIBC__
#include <malloc.h>
#endif
#include <sys/resource.h>
#include <unistd.h>

#include "fill_scan.h"
#include "frame.h"
#include "kelp/fields/fields.h"
#include "kelp/formats/fog.h"
#include "surface_count.h"

namespace kelp::bake {

PartSize volumeSize(const glm::ivec3& size, const glm::ivec3& pad, double surface_voxels, double solid_voxels) {
  PartSize result{size + 2 * pad, 0, surface_voxels, surface_voxels / 64, solid_voxels};
  result.volume_voxels = static_cast<double>(size.x) * size.y * size.z;
  return result;
}

PartSize fogSize(const glm::ivec3& size, const glm::ivec3& pad, bool heat) {
  PartSize result = volumeSize(size, pad, 0, 0);
  result.fog_channels = heat ? 2 : 1;
  return result;
}

namespace {

// Of each triangle: whether another before it has the same corners, in whatever order. Those are filled once.
std::vector<bool> repeatedFaces(const TriangleSoup& soup) {
  struct Face {
    std::array<std::uint32_t, 3> corners;
    std::uint32_t triangle;
  };
  std::vector<Face> faces;
  faces.reserve(soup.triangles.size());
  for (std::uint32_t i = 0; i < soup.triangles.size(); ++i) {
    Face& face = faces.emplace_back(Face{soup.triangles[i].vertex, i});
    std::sort(face.corners.begin(), face.corners.end());
  }
  std::sort(faces.begin(), faces.end(), [](const Face& a, const Face& b) { return std::tie(a.corners, a.triangle) < std::tie(b.corners, b.triangle); });
  std::vector<bool> again(faces.size(), false);
  for (std::size_t i = 1; i < faces.size(); ++i) again[faces[i].triangle] = faces[i].corners == faces[i - 1].corners;
  return again;
}

}  // namespace

PartSize partSize(const SourcePart& part, const Frame& frame, const glm::ivec3& pad) {
  if (part.grid) {
    const auto solid = std::count_if(part.grid->solid.begin(), part.grid->solid.end(), [](std::uint8_t voxel) { return voxel != 0; });
    return volumeSize(part.grid->size, pad, static_cast<double>(part.grid->surface.size()), static_cast<double>(solid));
  }
  if (part.fog) return fogSize(part.fog->size, pad, !part.fog->heat.empty());
  PartSize result{frame.size, part.soup.triangles.size()};
  // Volume by the divergence theorem, about the middle of the box: right for closed meshes, and something between for open ones.
  const glm::dmat3 turn(frame.node_to_voxel);
  const glm::dvec3 origin = glm::dvec3(frame.node_to_voxel[3]) - 0.5 * glm::dvec3(frame.size);
  const std::vector<TriangleSoup::Triangle>& triangles = part.soup.triangles;
  const auto corner = [&](std::size_t triangle, std::size_t i) { return turn * glm::dvec3(part.soup.positions[triangles[triangle].vertex[i]]) + origin; };
  const auto area = [&](std::size_t triangle) { return 0.5 * glm::cross(corner(triangle, 1) - corner(triangle, 0), corner(triangle, 2) - corner(triangle, 0)); };
  double volume = 0;
  glm::dvec3 crossings(0);
  for (std::size_t i = 0; i < triangles.size(); ++i) {
    const glm::dvec3 its = area(i);
    volume += glm::dot(corner(i, 0), its) / 3;
    crossings += glm::abs(its);
  }
  // Below, analysing the triangles takes more than their crossings do, and it does not matter how many are there twice.
  constexpr double kMany = 6;  // crossings of a triangle
  if (std::max({crossings.x, crossings.y, crossings.z}) > kMany * static_cast<double>(triangles.size())) {
    const std::vector<bool> again = repeatedFaces(part.soup);
    for (std::size_t i = 0; i < triangles.size(); ++i)
      if (again[i]) crossings -= glm::abs(area(i));
  }
  result.crossings = crossings;
  result.surface_voxels = std::min(touchedCells(part.soup, frame, 1), result.voxels());
  result.surface_bricks = std::min(touchedCells(part.soup, frame, kBrickSide), result.surface_voxels);
  result.solid_voxels = std::min(std::abs(volume) + 0.5 * result.surface_voxels, result.voxels());
  return result;
}

bool PartSize::isPile() const {
  constexpr double kOverEachOther = 2048, kLong = 1e7;
  for (int axis = 0; axis < 3; ++axis)
    if (crossings[axis] > kLong && crossings[axis] > kOverEachOther * voxels() / size[axis]) return true;
  return false;
}

std::uint64_t estimateMemory(std::span<const PartSize> parts, std::uint64_t image_bytes) {
  // Measured on real files (tools/bake/README.md). Bytes for each triangle: as it was read, while the mesh is analysed, and with its hierarchy. While the
  // surface is found and looked at: for each brick that it passes through, which OpenVDB's trees hold whole, and for each surface voxel. While levels are built:
  // for each surface voxel.
  constexpr double kProgram = 23e6, kVoxelizer = 15e6, kTriangle = 50, kAnalysing = 315, kHierarchy = 120, kTrees = 7500, kFinding = 36, kLeveling = 42;
  // Reductions of images hold a third as many texels, each four times as large.
  double kept = kProgram + static_cast<double>(image_bytes) * (1 + 4.0 / 3);
  for (const PartSize& part : parts) kept += static_cast<double>(part.triangles) * kTriangle;
  double peak = kept;
  const auto gridBytes = [](const PartSize& part) {
    if (part.fog_channels > 0) return part.voxels() * part.fog_channels * sizeof(std::uint16_t);
    return part.voxels() + part.surface_voxels * sizeof(SurfaceSample);
  };
  for (const PartSize& part : parts) {
    const double triangles = static_cast<double>(part.triangles);
    if (part.triangles > 0) {
      const double finding = part.surface_bricks * kTrees + part.surface_voxels * kFinding;
      const double scanning = std::min(std::max({part.crossings.x, part.crossings.y, part.crossings.z}), static_cast<double>(kMostCrossings) + triangles) * kCrossingBytes;
      peak = std::max({peak, kept + triangles * kAnalysing, kept + part.voxels() + triangles * kAnalysing + scanning, kept + kVoxelizer + part.voxels() + triangles * kHierarchy + finding});
    }
    kept += gridBytes(part);
    peak = std::max(peak, kept + part.source_bytes);
    peak = std::max(peak, kept + part.volume_voxels * (part.fog_channels > 0 ? sizeof(std::uint16_t) : 1));  // both, while it is padded
  }
  if (std::any_of(parts.begin(), parts.end(), [](const PartSize& part) { return part.triangles > 0; })) kept += kVoxelizer;
  for (const PartSize& part : parts) {
    if (part.fog_channels > 0) {
      // As codes, and which cubes are not clear; bricks for all of it at worst.
      const double bricks = part.voxels() / kBrickVoxels;
      peak = std::max(peak, kept + part.voxels() * ((part.fog_channels + 1.0)) + static_cast<double>(fields::peakBytes(part.size, static_cast<std::uint64_t>(bricks))));
      kept += bricks * kFogSamples * part.fog_channels - gridBytes(part);
      continue;
    }
    // Those that the surface passes through, of which one half is solid, and those within.
    const double bricks = part.surface_bricks + std::max(0.0, part.solid_voxels / kBrickVoxels - 0.5 * part.surface_bricks);
    peak = std::max(peak, kept + part.surface_voxels * kLeveling + static_cast<double>(fields::peakBytes(part.size, static_cast<std::uint64_t>(bricks))));
    // The voxels go, the level stays.
    kept += bricks * kBrickVoxels + part.surface_voxels * sizeof(std::uint32_t) - gridBytes(part);
  }
  return static_cast<std::uint64_t>(peak);
}

namespace {

// The least of 1 to `most` steps with fits(step), which holds for `most`, by halves; the last call is for that one.
int leastThatFits(int most, const std::function<bool(int)>& fits) {
  int too_little = 0, enough = most;
  while (enough - too_little > 1) {
    const int middle = too_little + (enough - too_little) / 2;
    (fits(middle) ? enough : too_little) = middle;
  }
  fits(enough);
  return enough;
}

// "--resolution 100 would fit", with the least change that does; empty where none does. Steps of a voxel along the longest side, or of a hundredth of a voxel's edge.
std::string largestThatFits(const std::function<std::uint64_t(const Settings&)>& need, const Settings& settings, int resolution, std::uint64_t limit) {
  constexpr double kStep = 1.01;
  constexpr int kSteps = 1200;  // beyond a hundred thousand times as long
  Settings changed = settings;
  const auto fits = [&](int step) {
    if (settings.voxel_size) {
      // As it will be printed.
      changed.voxel_size = std::stod(fmt::format("{:.4g}", *settings.voxel_size * std::pow(kStep, step)));
      if (*changed.voxel_size <= *settings.voxel_size || *changed.voxel_size > kLargestVoxel) return false;
    } else {
      changed.resolution = resolution - step;
      changed.resolution_given = true;
    }
    return need(changed) <= limit;
  };
  const int most = settings.voxel_size ? kSteps : resolution - 1;
  if (most < 1 || !fits(most)) return "";
  leastThatFits(most, fits);
  return settings.voxel_size ? fmt::format("--voxel-size {:.4g} would fit", *changed.voxel_size) : fmt::format("--resolution {} would fit", changed.resolution);
}

}  // namespace

std::uint64_t requireMemory(std::span<const PartSize> parts, const std::function<std::vector<PartSize>(const Settings&)>& sizes, std::uint64_t image_bytes, const Settings& settings, int resolution, const std::filesystem::path& input) {
  const std::uint64_t limit = settings.max_memory > 0 ? settings.max_memory : physicalMemory();
  const auto need = [&](const Settings& changed) { return estimateMemory(sizes(changed), image_bytes); };
  const std::uint64_t estimate = estimateMemory(parts, image_bytes);
  if (estimate <= limit) return estimate;
  std::string advice = largestThatFits(need, settings, resolution, limit);
  if (settings.pad > 0) {
    Settings bare = settings;
    bare.pad = 0;
    if (need(bare) <= limit) {
      const int pad = leastThatFits(settings.pad, [&](int less) {
        bare.pad = settings.pad - less;
        return need(bare) <= limit;
      });
      advice += fmt::format("{}--pad {} would fit", advice.empty() ? "" : ", or ", settings.pad - pad);
    } else if (advice.empty()) {
      advice = largestThatFits(need, bare, resolution, limit);
      if (!advice.empty()) advice = fmt::format("no resolution would fit with --pad {}; without it {}", settings.pad, advice);
    }
  }
  advice = advice.empty() ? "no resolution would fit: the file itself is too large" : advice + "; take that";
  throw BakeError(Exit::kRuntime, fmt::format("{}: baking needs about {} of memory, {} is the limit ({}); {}, or raise --max-memory", input.filename().string(), printBytes(estimate), printBytes(limit),
                                              settings.max_memory > 0 ? "--max-memory" : "this machine's memory", advice));
}

std::uint64_t physicalMemory() { return static_cast<std::uint64_t>(sysconf(_SC_PHYS_PAGES)) * static_cast<std::uint64_t>(sysconf(_SC_PAGESIZE)); }

std::uint64_t peakMemory() {
  rusage usage{};
  return getrusage(RUSAGE_SELF, &usage) == 0 ? static_cast<std::uint64_t>(usage.ru_maxrss) * 1024 : 0;  // Linux counts KiB
}

void returnFreedMemory() {
#ifdef __GLIBC__
  malloc_trim(0);
#endif
}

std::string printBytes(std::uint64_t bytes) {
  const double kib = static_cast<double>(bytes) / 1024.0;
  if (kib < 1024) return fmt::format("{:.1f} KiB", kib);
  if (kib < 1024 * 1024) return fmt::format("{:.1f} MiB", kib / 1024);
  return fmt::format("{:.1f} GiB", kib / (1024 * 1024));
}

}  // namespace kelp::bake
