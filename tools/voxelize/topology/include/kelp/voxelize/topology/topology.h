// SPDX-License-Identifier: MIT
// A triangle soup made ready to fill: snapped, welded, consistently wound, holes closed.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "kelp/import/core/frame.h"
#include "kelp/import/core/source_model.h"
#include "kelp/voxelize/topology/fill_report.h"

namespace kelp::bake {

// Vertices lie on a lattice of 2^-kLatticeBits voxel, so all decisions are exact integer arithmetic. 8192
// voxels need 27 bits, products of differences 57.
inline constexpr int kLatticeBits = 14;
inline constexpr double kLatticeStep = 1.0 / (1 << kLatticeBits);

struct SolidTriangle {
  std::array<std::uint32_t, 3> vertex{};
  std::uint32_t source = 0;  // index into the soup; of caps: kCap
  std::uint32_t component = 0;
  // corners 1 and 2 are swapped against the soup: the triangle's winding was wrong. In a sheet: it differed
  // from most of the triangles around it.
  bool swapped = false;
  // modeled from both sides, and the component it is attached to is nearer to closed without it
  bool wall = false;

  void turn() {
    std::swap(vertex[1], vertex[2]);
    swapped = !swapped;
  }
};
inline constexpr std::uint32_t kCap = 0xffffffffu;

struct Component {
  bool solid = false;           // has an inside
  bool thin = false;            // thinner than a voxel in the mean (solid or not)
  bool closed = false;          // had no boundary before its holes were capped
  bool wall = false;            // walls between bodies, or leaves on a body: only solid with Fill::kSolid
  std::uint32_t triangles = 0;  // without caps
  double area = 0;              // voxels^2, without caps
  double cap_area = 0;
  double volume = 0;    // voxels^3, with caps; negative where the file wound it inside out
  double cut_area = 0;  // voxels^2 that its material cuts out, once it was asked for
  EdgeCounts diagnosis;
};

struct Topology {
  std::vector<glm::i64vec3> lattice;  // vertices in lattice units
  // Wound outward in solid components. Order: the file's triangles, then those that close holes.
  std::vector<SolidTriangle> triangles;
  std::size_t caps = 0;  // how many close holes
  std::vector<Component> components;
  bool closed = false;  // all components were closed
  // "solid: 3 of 4 components closed, 1 with 5 holes closed by fans (1.2 % of its surface)"
  std::string summary;

  glm::dvec3 position(std::uint32_t vertex) const { return glm::dvec3(lattice[vertex]) * kLatticeStep; }
  glm::dvec3 areaVector(const SolidTriangle& t) const {
    const glm::dvec3 a = position(t.vertex[0]);
    return 0.5 * glm::cross(position(t.vertex[1]) - a, position(t.vertex[2]) - a);
  }
};

// Holes of a component may have this share of its surface before it counts as an open sheet.
inline constexpr double kMaxHoleShare = 0.17;

// Decides which components are solid and which are sheets. A component is a set of triangles connected by
// shared edges; walls are connected only to walls. The boundary of a component is a cycle of oriented edges.
// A fan from a point to that cycle closes the component exactly, whatever the shape of the holes, so the
// signed crossings along any line sum to zero. kAuto: solid if the fans are small beside the surface.
// kSolid, kSurface: all are.
Topology analyze(const TriangleSoup& soup, const Frame& frame, Fill fill, int threads = 1);

// A component of which this share of the surface is cut out is a sheet around something: hair, a hat, armor.
inline constexpr double kMaxCutShare = 0.1;

// Makes sheets of solid components whose cut_area, which the caller has set, is that large; what closed their
// holes goes. After analyze() with Fill::kAuto.
void openCutOuts(Topology& mesh);

}  // namespace kelp::bake
