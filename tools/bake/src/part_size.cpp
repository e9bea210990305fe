// SPDX-License-Identifier: MIT
#include "part_size.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <tuple>

#include "kelp/common/parallel.h"
#include "kelp/formats/brick.h"
#include "kelp/voxelize/fill/scan.h"
#include "kelp/voxelize/surface/touched_cells.h"

namespace kelp::bake {
namespace {

// For each triangle: true if an earlier one has the same corners in any order. Such corners are filled once.
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
  std::sort(faces.begin(), faces.end(), [](const Face& a, const Face& b) {
    return std::tie(a.corners, a.triangle) < std::tie(b.corners, b.triangle);
  });
  std::vector<bool> again(faces.size(), false);
  for (std::size_t i = 1; i < faces.size(); ++i)
    again[faces[i].triangle] = faces[i].corners == faces[i - 1].corners;
  return again;
}

}  // namespace

PartSize partSize(const SourcePart& part, const Frame& frame, const glm::ivec3& pad, int threads) {
  if (part.grid) {
    const auto solid = std::count_if(part.grid->solid.begin(), part.grid->solid.end(),
                                     [](std::uint8_t voxel) { return voxel != 0; });
    return volumeSize(part.grid->size, pad, static_cast<double>(part.grid->surface.size()),
                      static_cast<double>(solid));
  }
  if (part.fog) return fogSize(part.fog->size, pad, !part.fog->heat.empty());
  PartSize result{frame.size, part.soup.triangles.size(), part.soup.positions.size()};
  // Volume by the divergence theorem, about the middle of the box: right for closed meshes, and something
  // between for open ones.
  const glm::dmat3 turn(frame.node_to_voxel);
  const glm::dvec3 origin = glm::dvec3(frame.node_to_voxel[3]) - 0.5 * glm::dvec3(frame.size);
  const std::vector<TriangleSoup::Triangle>& triangles = part.soup.triangles;
  const auto corner = [&](std::size_t triangle, std::size_t i) {
    return turn * glm::dvec3(part.soup.positions[triangles[triangle].vertex[i]]) + origin;
  };
  const auto area = [&](std::size_t triangle) {
    return 0.5 *
           glm::cross(corner(triangle, 1) - corner(triangle, 0), corner(triangle, 2) - corner(triangle, 0));
  };
  double volume = 0;
  glm::dvec3 crossings(0);
  for (std::size_t i = 0; i < triangles.size(); ++i) {
    const glm::dvec3 its = area(i);
    volume += glm::dot(corner(i, 0), its) / 3;
    crossings += glm::abs(its);
  }
  // Below, analysing the triangles takes more than their crossings do, and it does not matter how many are
  // there twice.
  constexpr double kMany = 6;  // crossings of a triangle
  if (std::max({crossings.x, crossings.y, crossings.z}) > kMany * static_cast<double>(triangles.size())) {
    const std::vector<bool> again = repeatedFaces(part.soup);
    for (std::size_t i = 0; i < triangles.size(); ++i)
      if (again[i]) crossings -= glm::abs(area(i));
  }
  result.crossings = crossings;
  result.scan_bytes = std::min(std::max({crossings.x, crossings.y, crossings.z}),
                               static_cast<double>(kMostCrossings) + static_cast<double>(triangles.size())) *
                      kCrossingBytes;
  std::array<double, 2> touched{};
  parallelRanges(touched.size(), 1, threads, [&](std::size_t i, std::size_t) {
    touched[i] = touchedCells(part.soup, frame, i == 0 ? 1 : kBrickSide);
  });
  result.surface_voxels = std::min(touched[0], result.voxels());
  result.surface_bricks = std::min(touched[1], result.surface_voxels);
  result.solid_voxels = std::min(std::abs(volume) + 0.5 * result.surface_voxels, result.voxels());
  return result;
}

bool isPile(const PartSize& part) {
  constexpr double kOverEachOther = 2048, kLong = 1e7;
  for (int axis = 0; axis < 3; ++axis)
    if (part.crossings[axis] > kLong &&
        part.crossings[axis] > kOverEachOther * part.voxels() / part.size[axis])
      return true;
  return false;
}

}  // namespace kelp::bake
