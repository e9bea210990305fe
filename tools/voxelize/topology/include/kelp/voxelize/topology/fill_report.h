// SPDX-License-Identifier: MIT
// How a mesh is to be filled, and what the fill made of it: numbers for the report.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>

namespace kelp::bake {

enum class Fill : std::uint8_t { kAuto, kSolid, kSurface };

// A mesh as the file has it, corners in equal places being one.
struct MeshCounts {
  std::uint64_t vertices = 0, triangles = 0;
  std::uint64_t boundary_edges = 0;      // of one triangle alone
  std::uint64_t boundaries = 0;          // what those hang together to: the rims of holes and of open sheets
  std::uint64_t non_manifold_edges = 0;  // of three triangles or more
  std::uint64_t dropped = 0;             // triangles that are not among these: without an area, or not finite
};

// What the fill made of it, after welding to a fraction of a voxel.
struct FillCounts {
  // what hangs together by edges; walls: faces modelled from both sides between bodies
  std::uint64_t components = 0, closed = 0, capped = 0, sheets = 0, walls = 0;
  // triangles left out: modelled twice, or no more than a line that others have as a side
  std::uint64_t doubled = 0;
  std::uint64_t turned = 0;         // triangles wound against their neighbours, or inside out
  std::uint64_t cap_triangles = 0;  // that close holes
  // solid though their centres lie in no body: sheets, and what is thinner than a voxel
  std::uint64_t kept_voxels = 0;
};

// What hangs together by shared edges: why it became solid or stayed a surface.
struct ComponentReport {
  std::uint64_t triangles = 0;
  double surface_share = 0;  // of the part's area
  bool solid = false;
  std::string why;  // "closed", "holes of 2.2 % of its surface were capped", "open: ..."
};
// The most ComponentReports of a part: the largest by area.
inline constexpr std::size_t kMaxComponentReports = 64;

}  // namespace kelp::bake
