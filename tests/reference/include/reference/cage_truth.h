// SPDX-License-Identifier: MIT
// Ground truth for caged parts, in double precision and independent of shaders/cage.glsl: all tetrahedra of
// all cells, and of the cubes inside, each clipped by itself and its voxels gone through one by one. None is
// walked to from another. Those that are inverted draw nothing.
#pragma once

#include <array>
#include <functional>
#include <span>
#include <vector>

#include "kelp/formats/cage.h"
#include "reference/judge.h"

namespace kelp::reference {

// A level in its cage, at rest.
struct CagedLevel {
  const Cage* cage = nullptr;
  CageSource source;
  int level = 0;
  Volume volume;  // of the level
  // For each voxel, how many levels above it was taken from; empty: none.
  std::span<const std::uint8_t> coarser;
};

class CageTruth {
 public:
  // A boundary face by which a ray enters, and where.
  struct Start {
    double s = 0;
    std::uint32_t face = 0;
  };

  // nodes: where those of the cage are. corner: where a point of the lattice is that is no node. The level
  // must outlive this.
  CageTruth(const CagedLevel& level, std::span<const glm::vec3> nodes,
            const std::function<glm::vec3(const glm::ivec3&)>& corner);

  Truth truthOf(const glm::dvec3& o, const glm::dvec3& r, double s_max) const;
  // Ascending.
  std::vector<Start> starts(const glm::dvec3& o, const glm::dvec3& r, double s_max) const;
  // Tetrahedra of cells that are inverted or flat.
  int inverted() const { return inverted_; }

 private:
  friend class CageDistance;
  struct Ball {
    glm::dvec3 middle{0};
    double radius = 0;
  };
  // rest = turn * point + at, in voxels of the level from the cube's corner.
  struct Tetrahedron {
    glm::dmat3 turn{1};
    glm::dvec3 at{0};
    std::array<int, 3> axes{};
    bool thick = false;  // not nearly flat: it owes what it holds
  };
  struct Cube {
    Ball ball;
    glm::ivec3 corner{0};  // its first voxel
    int cell = -1;         // -1: inside
    std::size_t first = 0, end = 0;
    std::uint32_t first_face = 0, end_face = 0;
  };
  struct Group {
    Ball ball;
    std::size_t first = 0, end = 0;
  };
  struct Line;

  void add(const glm::ivec3& place, int cell, const std::array<glm::dvec3, 8>& corners);
  bool isSolid(const Cube& cube, const glm::ivec3& voxel) const;
  bool isJoined(const Cube& cube, const glm::ivec3& voxel) const;
  void search(const Cube& cube, const Tetrahedron& tetrahedron, const glm::dvec3& o, const glm::dvec3& r,
              double s_max, Truth& truth) const;
  std::optional<double> firstPossible(const Cube& cube, const Line& line) const;
  std::optional<double> firstOwed(const Cube& cube, const Line& line) const;

  CagedLevel level_;
  int side_;                            // of a cube, voxels of the level
  std::vector<std::uint32_t> mask_at_;  // for each cell, where its mask begins in the source's, bytes
  std::vector<glm::vec3> nodes_;
  std::vector<Cube> cubes_;
  std::vector<Tetrahedron> tetrahedra_;
  std::vector<Group> groups_;
  int inverted_ = 0;
};

}  // namespace kelp::reference
