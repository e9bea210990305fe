// SPDX-License-Identifier: MIT
#include "kelp/runtime/soft_body.h"

#include <algorithm>

#include "cage_map.h"
#include "solid_voxels.h"

namespace kelp::runtime {
namespace {

// Null: the part has none.
Result<const Cage*> finestCage(const Asset& asset, int part) {
  const std::span<const Part> parts = asset.pack().parts();
  if (part < 0 || static_cast<std::size_t>(part) >= parts.size())
    return Error{ErrorCode::kMisuse, "there is no part of that index"};
  const std::span<const Cage> cages = parts[static_cast<std::size_t>(part)].cages;
  return cages.empty() ? nullptr : &cages[0];
}

// Shares each solid voxel of a cell among its nodes.
void addCell(const Cage& cage, std::uint32_t cell, const glm::ivec3& size, const SolidVoxels& voxels,
             std::span<float> volumes) {
  const glm::ivec3 first = cage.side * cage.place(cell), end = glm::min(first + cage.side, size);
  double shares[8] = {};
  glm::ivec3 v;
  for (v.z = first.z; v.z < end.z; ++v.z)
    for (v.y = first.y; v.y < end.y; ++v.y)
      for (v.x = first.x; v.x < end.x; ++v.x) {
        if (!isOfPiece(cage, cell, v, 1) || !voxels.isSolid(v)) continue;
        const glm::dvec3 f = (glm::dvec3(v - first) + 0.5) / double(cage.side);
        const CageTetrahedron& t = kCageTetrahedra[tetrahedronAt(f)];
        double left = 1;
        for (int k = 0; k < 3; ++k) {
          shares[t.corners[k]] += left - f[t.axes[k]];
          left = f[t.axes[k]];
        }
        shares[t.corners[3]] += left;
      }
  for (int corner = 0; corner < 8; ++corner)
    volumes[cage.node(cell, corner)] += static_cast<float>(shares[corner]);
}

// Half of a third of the cubes in the middle that follow one another beyond a face of a cell.
void addMiddle(const Cage& cage, std::uint32_t cell, int face, std::span<float> volumes) {
  if (cage.beyond(cell, face) != kCageInside) return;
  // Several cells of a cube may have this face; it counts once.
  if (cell > 0 && cage.place(cell - 1) == cage.place(cell) && cage.beyond(cell - 1, face) == kCageInside)
    return;
  glm::ivec3 step(0);
  step[face / 2] = face % 2 ? 1 : -1;
  int cubes = 0;
  for (glm::ivec3 cube = cage.place(cell) + step; isEmptyCube(cage, cube); cube += step) ++cubes;
  const double voxels = double(cubes) * cage.side * cage.side * cage.side;
  for (int corner = 0; corner < 8; ++corner)
    if ((corner >> (face / 2) & 1) == face % 2)
      volumes[cage.node(cell, corner)] += static_cast<float>(voxels / (2 * 3 * 4));
}

}  // namespace

Result<void> nodeVolumes(const Asset& asset, int part, std::span<float> volumes) {
  const Result<const Cage*> found = finestCage(asset, part);
  if (!found) return found.error();
  if (volumes.size() != (*found ? (*found)->nodes() : 0))
    return Error{ErrorCode::kMisuse, "a volume for each node of the part's finest cage is wanted"};
  if (!*found) return {};
  const Cage& cage = **found;
  if (asset.residentLevel(part, 0) != 0)
    return Error{ErrorCode::kNotYet, "the finest voxels of the part are not in memory"};
  const SolidVoxels voxels(asset, part);
  const glm::ivec3 size = asset.pack().parts()[static_cast<std::size_t>(part)].size;
  std::fill(volumes.begin(), volumes.end(), 0.0f);
  for (std::uint32_t cell = 0; cell < cage.cells(); ++cell) {
    addCell(cage, cell, size, voxels, volumes);
    for (int face = 0; face < 6; ++face) addMiddle(cage, cell, face, volumes);
  }
  return {};
}

Result<Buffer<NodeEdge>> nodeEdges(const Asset& asset, int part, const Allocator& allocator) {
  const Result<const Cage*> found = finestCage(asset, part);
  if (!found) return found.error();
  Buffer<NodeEdge> edges(allocator);
  if (!*found) return edges;
  const Cage& cage = **found;
  // Two corners of a cell are neighbors if one has all the axes of the other.
  constexpr std::uint32_t kPairs = 19;
  if (const Result<void> made = edges.reset(std::uint64_t{kPairs} * cage.cells()); !made) return made.error();
  std::size_t count = 0;
  for (std::uint32_t cell = 0; cell < cage.cells(); ++cell)
    for (int high = 1; high < 8; ++high)
      for (int low = 0; low < high; ++low) {
        if ((low & high) != low) continue;
        const std::uint32_t a = cage.node(cell, low), b = cage.node(cell, high);
        edges[count++] = {std::min(a, b), std::max(a, b)};
      }
  std::sort(edges.begin(), edges.end());
  const auto unique = std::unique(edges.begin(), edges.end());
  Buffer<NodeEdge> once(allocator);
  if (const Result<void> made = once.reset(static_cast<std::uint64_t>(unique - edges.begin())); !made)
    return made.error();
  std::copy(edges.begin(), unique, once.begin());
  return once;
}

}  // namespace kelp::runtime
