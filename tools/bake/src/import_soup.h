// SPDX-License-Identifier: MIT
// Building a TriangleSoup: vertices with equal positions become one, attributes stay with the corners, degenerate input is counted.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <unordered_map>
#include <vector>

#include "kelp/bake/source_model.h"

namespace kelp::bake {

// IEC 61966-2-1, the transfer function of sRGB; 0..1 to 0..1.
float srgbToLinear(float value);

// Most triangles one input may have: bounds the memory that instancing can ask for.
inline constexpr std::size_t kMaxTriangles = std::size_t{1} << 26;

class SoupBuilder {
 public:
  struct Triangle {
    std::array<glm::vec3, 3> position{};
    std::uint32_t material = 0;
    std::optional<std::array<glm::vec2, 3>> uv;
    std::array<std::optional<std::array<glm::vec2, 3>>, 2> more_uv;
    std::optional<std::array<glm::vec4, 3>> color;  // linear
  };
  // Triangles with a non-finite corner, or whose corners are not three different points, are dropped and counted.
  // False when kMaxTriangles are reached.
  bool add(const Triangle& triangle);

  // The triangles that follow come from numbers that a compressor rounded to this step, on a grid of their own. Where such pieces meet, they
  // do so no longer: take() closes the seams between them.
  void roundedTo(float step);
  // The same of whole multiples of `unit`, which `to_soup` brings here. Triangles on one such lattice still meet exactly, also where it begins elsewhere: those that follow each
  // other are one piece.
  void roundedTo(float step, const glm::dmat4& to_soup, double unit);

  // What all positions are relative to, for whoever takes the soup; 0 unless it is said.
  void setOrigin(const glm::dvec3& origin) { origin_ = origin; }
  const glm::dvec3& origin() const { return origin_; }

  std::size_t triangles() const { return soup_.triangles.size(); }
  std::size_t droppedNonFinite() const { return non_finite_; }
  std::size_t droppedDegenerate() const { return degenerate_; }
  TriangleSoup take();

 private:
  std::uint32_t vertex(glm::vec3 position);

  struct Hash {
    std::size_t operator()(const std::array<std::uint32_t, 3>& bits) const;
  };
  TriangleSoup soup_;
  std::unordered_map<std::array<std::uint32_t, 3>, std::uint32_t, Hash> index_;
  glm::dvec3 origin_{0};
  std::size_t non_finite_ = 0;
  std::size_t degenerate_ = 0;
  std::vector<float> steps_{0};        // of each piece
  struct Lattice {
    glm::dmat4 to_soup;
    double unit;
  };
  std::optional<Lattice> lattice_;     // of the last one
  std::vector<std::uint32_t> piece_;   // of each vertex: the first that has it
};

// Whether a box lies so far from 0 that floats would cost what is in it more than a millionth of its extent.
bool isFar(const glm::dvec3& low, const glm::dvec3& high);

// Of positions whose box is far: its middle, as floats hold it. 0 of others.
glm::dvec3 farMiddle(std::span<const glm::dvec3> positions);

// Moves vertices on open edges of different pieces onto one of them where rounding to the pieces' steps explains the distance. Triangles that
// this leaves without an area go.
void closeSeams(TriangleSoup& soup, const std::vector<std::uint32_t>& piece, const std::vector<float>& steps);

// Cuts a polygon into triangles by clipping ears in the plane it lies in best; convex ones become fans, but for those of more than a thousand corners. Answers
// corners of the polygon, three a triangle, in the polygon's winding. Non-finite or self-intersecting polygons still give size - 2 triangles.
std::vector<std::array<std::uint32_t, 3>> triangulatePolygon(std::span<const glm::vec3> corners);

}  // namespace kelp::bake
