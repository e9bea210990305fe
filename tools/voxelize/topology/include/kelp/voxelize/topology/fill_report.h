// SPDX-License-Identifier: MIT
// Ways to fill a mesh, and the numbers and reasons of a fill for the report.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace kelp::bake {

struct Topology;
struct TriangleSoup;

enum class Fill : std::uint8_t { kAuto, kSolid, kSurface };

// A mesh as in the file, with corners at equal positions merged.
struct MeshCounts {
  std::uint64_t vertices = 0, triangles = 0;
  std::uint64_t boundary_edges = 0;      // edges of one triangle
  std::uint64_t boundaries = 0;          // connected chains of these: rims of holes and of open sheets
  std::uint64_t non_manifold_edges = 0;  // edges of three triangles or more
  std::uint64_t dropped = 0;             // triangles not counted above: without area, or not finite
};

// Faults that the half-edge mesh of a component shows; zeros for closed, manifold ones, which need none.
struct EdgeCounts {
  std::uint64_t open_edges = 0;      // edges of one triangle
  std::uint64_t split_edges = 0;     // edges of three triangles or more, made into edges of two and of one
  std::uint64_t cut_edges = 0;       // where a surface with one side (a Moebius strip) was cut open
  std::uint64_t split_vertices = 0;  // vertices added where triangles around a point share no edge there
  std::uint64_t holes = 0;           // loops of edges of one triangle, after all that

  EdgeCounts& operator+=(const EdgeCounts& other) {
    open_edges += other.open_edges;
    split_edges += other.split_edges;
    cut_edges += other.cut_edges;
    split_vertices += other.split_vertices;
    holes += other.holes;
    return *this;
  }
};

// The result of a fill, after welding to a fraction of a voxel.
struct FillCounts {
  // components are connected by edges; walls are faces between bodies, modeled from both sides
  std::uint64_t components = 0, closed = 0, capped = 0, sheets = 0, walls = 0;
  // triangles left out: duplicates, or degenerate ones
  std::uint64_t doubled = 0;
  std::uint64_t turned = 0;         // triangles with the wrong winding
  std::uint64_t cap_triangles = 0;  // triangles that close holes
  // solid voxels whose center is in no body: sheets, and parts thinner than a voxel
  std::uint64_t kept_voxels = 0;
  EdgeCounts diagnosis;  // of all components
};

// Triangles connected by shared edges: why they became solid or stayed a surface.
struct ComponentReport {
  std::uint64_t triangles = 0;
  double surface_share = 0;  // of the part's area
  bool solid = false;
  EdgeCounts diagnosis;
  std::string why;  // "closed", "closed, but encloses nothing: ...", "5 holes closed by fans (2.2 % of its
                    // surface)", "open: ..."
};
// The most ComponentReports of a part; the largest by area are kept.
inline constexpr std::size_t kMaxComponentReports = 64;

// Counts the mesh as in the file. Takes 24 bytes for each triangle and 8 for each vertex while it runs.
MeshCounts countMesh(const TriangleSoup& soup, int threads = 1);
// All of FillCounts except kept_voxels. `triangles`: of the mesh in the file.
FillCounts countFill(const Topology& mesh, std::uint64_t triangles);
// One line for the part.
std::string summarizeFill(const Topology& mesh, Fill fill);
// One entry per component, the largest kMaxComponentReports by area, in that order.
std::vector<ComponentReport> describeComponents(const Topology& mesh, Fill fill);

}  // namespace kelp::bake
