// SPDX-License-Identifier: MIT
// Builds a TriangleSoup: vertices with equal positions become one, attributes stay with the corners,
// degenerate triangles are counted.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "kelp/common/point_index.h"
#include "kelp/import/core/source_model.h"

namespace kelp::bake {

// The most triangles of one input. Bounds the memory that instancing can ask for.
inline constexpr std::size_t kMaxTriangles = std::size_t{1} << 26;

class SoupBuilder {
 public:
  struct Triangle {
    std::array<glm::vec3, 3> position{};
    std::uint32_t material = 0;
    std::optional<std::array<glm::vec2, 3>> uv;
    std::array<std::optional<std::array<glm::vec2, 3>>, 2> more_uv;
    std::optional<std::array<glm::vec4, 3>> color;  // linear
    std::optional<std::array<std::uint32_t, 3>> skinned;
  };
  // Triangles with a corner that is not finite, or with two corners in one point, are dropped and counted.
  // False when kMaxTriangles is reached.
  bool add(const Triangle& triangle);

  // The triangles that follow form a piece that a compressor rounded to this step, on a grid of its own.
  // Pieces that met before rounding have cracks between them after it: take() closes these.
  void roundedTo(float step);
  // The same for whole multiples of `unit`, which `to_soup` maps into the soup. Triangles on one lattice meet
  // exactly, even if their origins differ by whole steps. So consecutive triangles of one lattice are one
  // piece.
  void roundedTo(float step, const glm::dmat4& to_soup, double unit);

  // The point that all positions are relative to; 0 if it is not set.
  void setOrigin(const glm::dvec3& origin) { origin_ = origin; }
  const glm::dvec3& origin() const { return origin_; }

  std::size_t triangles() const { return soup_.triangles.size(); }
  std::size_t droppedNonFinite() const { return non_finite_; }
  std::size_t droppedDegenerate() const { return degenerate_; }
  TriangleSoup take();

 private:
  std::uint32_t vertex(const glm::vec3& position);

  TriangleSoup soup_;
  PointIndex<glm::vec3> index_;
  glm::dvec3 origin_{0};
  std::size_t non_finite_ = 0;
  std::size_t degenerate_ = 0;
  std::vector<float> steps_{0};  // by piece
  struct Lattice {
    glm::dmat4 to_soup;
    double unit;
  };
  std::optional<Lattice> lattice_;    // of the last piece
  std::vector<std::uint32_t> piece_;  // for each vertex, the first piece that has it
};

// True if a box is so far from 0 that rounding to floats would move its content by more than a millionth of
// its extent.
bool isFar(const glm::dvec3& low, const glm::dvec3& high);

// The middle of a box as floats hold it; nullopt where the box is empty or its middle is beyond floats.
std::optional<glm::dvec3> floatMiddle(const glm::dvec3& low, const glm::dvec3& high);
// If the box of these positions is far: its middle, as floats hold it. Otherwise 0.
glm::dvec3 farMiddle(std::span<const glm::dvec3> positions);

// Merges vertices on open edges of different pieces where rounding to the pieces' steps explains their
// distance. Triangles that have no area afterwards are removed.
void closeSeams(TriangleSoup& soup, const std::vector<std::uint32_t>& piece, const std::vector<float>& steps);

// Cuts a polygon into triangles by clipping ears in its best plane. Convex polygons of at most a thousand
// corners become fans. Returns indices of corners, three a triangle, in the polygon's winding. Non-finite or
// self-intersecting polygons also give size - 2 triangles.
std::vector<std::array<std::uint32_t, 3>> triangulatePolygon(std::span<const glm::vec3> corners);

}  // namespace kelp::bake
