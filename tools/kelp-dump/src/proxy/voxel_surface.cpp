// SPDX-License-Identifier: MIT
#include "proxy/voxel_surface.h"

#include <algorithm>
#include <bit>
#include <limits>
#include <numeric>
#include <optional>
#include <utility>

#include <glm/geometric.hpp>

namespace kelp::dump {
namespace {

constexpr std::uint32_t kNoCorner = std::numeric_limits<std::uint32_t>::max();
constexpr int kSmoothing = 24;        // steps
constexpr double kWithinCell = 0.45;  // voxels along an axis: neighbours' cells do not meet

int sideOf(const glm::ivec3& normal) {
  const int axis = normal.x != 0 ? 0 : normal.y != 0 ? 1 : 2;
  return 2 * axis + (normal[axis] > 0 ? 1 : 0);
}

// Finds a face by its voxel and its side.
class FaceTable {
 public:
  explicit FaceTable(const std::vector<VoxelFace>& faces)
      : faces_(faces), slots_(std::bit_ceil(2 * faces.size() + 1), kNoCorner) {
    for (std::uint32_t i = 0; i < faces.size(); ++i) {
      std::size_t slot = slotOf(faces[i].voxel, faces[i].side);
      while (slots_[slot] != kNoCorner) slot = (slot + 1) & (slots_.size() - 1);
      slots_[slot] = i;
    }
  }
  std::uint32_t find(const glm::ivec3& voxel, int side) const {
    std::size_t slot = slotOf(voxel, side);
    while (faces_[slots_[slot]].voxel != voxel || faces_[slots_[slot]].side != side)
      slot = (slot + 1) & (slots_.size() - 1);
    return slots_[slot];
  }

 private:
  std::size_t slotOf(const glm::ivec3& v, int side) const {
    std::uint64_t hash = 0;
    for (const int part : {v.x, v.y, v.z, side})
      hash = (hash ^ static_cast<std::uint64_t>(part)) * 0x9E3779B97F4A7C15u;
    return static_cast<std::size_t>(hash >> 20) & (slots_.size() - 1);
  }
  const std::vector<VoxelFace>& faces_;
  std::vector<std::uint32_t> slots_;
};

// What lies across an edge of a face.
struct Across {
  VoxelFace face;
  bool shared_edge = false;  // only by two voxels that touch at it
};

Across across(const LevelVoxels& level, const VoxelFace& face, int edge) {
  const glm::ivec3 outward = face.outward(), sideways = face.sideways(edge);
  const bool beside = level.solid(face.voxel + sideways);
  if (level.solid(face.voxel + sideways + outward))
    return {{face.voxel + sideways + outward, sideOf(-sideways)}, !beside};
  if (beside) return {{face.voxel + sideways, face.side}};
  return {{face.voxel, sideOf(sideways)}};
}

int cornerAt(const VoxelFace& face, const glm::ivec3& place) {
  for (int i = 0; i < 3; ++i)
    if (face.corner(i) == place) return i;
  return 3;
}

class Builder {
 public:
  Builder(const LevelVoxels& level, const std::vector<VoxelFace>& faces)
      : level_(level),
        faces_(faces),
        table_(faces),
        fan_(4 * faces.size()),
        middle_(4 * faces.size(), kNoCorner) {
    std::iota(fan_.begin(), fan_.end(), 0u);
    for (std::uint32_t f = 0; f < faces.size(); ++f)
      for (int edge = 0; edge < 4; ++edge) connect(f, edge);
    number();
  }

  VoxelSurface build(double most) {
    smooth(most);
    for (std::size_t f = 0; f < faces_.size(); ++f) {
      surface_.owner.push_back(static_cast<std::uint32_t>(surface_.triangles.size()));
      triangulate(polygon(f));
    }
    return std::move(surface_);
  }

 private:
  std::uint32_t root(std::uint32_t corner) {
    while (fan_[corner] != corner) corner = fan_[corner] = fan_[fan_[corner]];
    return corner;
  }

  // The corners at the ends of an edge belong to the same fans as those of the face across it.
  void connect(std::uint32_t f, int edge) {
    const VoxelFace& face = faces_[f];
    const Across other = across(level_, face, edge);
    const std::uint32_t g = table_.find(other.face.voxel, other.face.side);
    const int next = (edge + 1) % 4;
    const int from = cornerAt(other.face, face.corner(edge)), to = cornerAt(other.face, face.corner(next));
    const auto join = [&](std::uint32_t a, std::uint32_t b) {
      a = root(a), b = root(b);
      fan_[std::max(a, b)] = std::min(a, b);
    };
    join(4 * f + static_cast<std::uint32_t>(edge), 4 * g + static_cast<std::uint32_t>(from));
    join(4 * f + static_cast<std::uint32_t>(next), 4 * g + static_cast<std::uint32_t>(to));
    if (!other.shared_edge) return;
    // The other face runs along the edge from `to` to `from`.
    std::uint32_t& mine = middle_[4 * f + static_cast<std::uint32_t>(edge)];
    if (mine != kNoCorner) return;
    mine = static_cast<std::uint32_t>(middles_.size());
    middle_[4 * g + static_cast<std::uint32_t>(to)] = mine;
    middles_.push_back((glm::dvec3(face.corner(edge)) + glm::dvec3(face.corner(next))) * 0.5);
  }

  // From fans of corners to numbered vertices. A fan's root is its lowest corner.
  void number() {
    std::vector<std::uint32_t> vertex(fan_.size());
    for (std::uint32_t corner = 0; corner < fan_.size(); ++corner) {
      const std::uint32_t first = root(corner);
      if (first == corner) {
        vertex[corner] = static_cast<std::uint32_t>(surface_.origin.size());
        surface_.origin.emplace_back(faces_[corner / 4].corner(static_cast<int>(corner % 4)));
      }
      vertex[corner] = vertex[first];
    }
    fan_ = std::move(vertex);
    for (std::uint32_t& middle : middle_)
      if (middle != kNoCorner) middle += static_cast<std::uint32_t>(surface_.origin.size());
    surface_.origin.insert(surface_.origin.end(), middles_.begin(), middles_.end());
  }

  struct Polygon {
    std::uint32_t vertices[8];
    int count = 0;
  };
  Polygon polygon(std::size_t f) const {
    Polygon polygon;
    for (std::size_t corner = 4 * f; corner < 4 * f + 4; ++corner) {
      polygon.vertices[polygon.count++] = fan_[corner];
      if (middle_[corner] != kNoCorner) polygon.vertices[polygon.count++] = middle_[corner];
    }
    return polygon;
  }

  bool isMiddle(std::uint32_t vertex) const { return vertex >= surface_.origin.size() - middles_.size(); }

  void smooth(double most) {
    std::vector<glm::dvec3>& place = surface_.place;
    place = surface_.origin;
    std::vector<glm::dvec3> sum(place.size());
    std::vector<std::uint32_t> neighbours(place.size());
    const auto add = [&](std::uint32_t vertex, const glm::dvec3& neighbour) {
      sum[vertex] += neighbour;
      ++neighbours[vertex];
    };
    for (int step = 0; step < kSmoothing; ++step) {
      std::fill(sum.begin(), sum.end(), glm::dvec3(0));
      std::fill(neighbours.begin(), neighbours.end(), 0u);
      for (std::size_t f = 0; f < faces_.size(); ++f) {
        const Polygon p = polygon(f);
        glm::dvec3 middle(0);
        for (int i = 0; i < p.count; ++i) middle += place[p.vertices[i]] / static_cast<double>(p.count);
        for (int i = 0; i < p.count; ++i) {
          add(p.vertices[i], place[p.vertices[(i + 1) % p.count]]);
          // Else the two copies of an edge would stay in one place.
          if (isMiddle(p.vertices[i])) add(p.vertices[i], middle);
        }
      }
      for (std::size_t v = 0; v < place.size(); ++v) {
        glm::dvec3 move = sum[v] / static_cast<double>(neighbours[v]) - surface_.origin[v];
        move = glm::clamp(move, -kWithinCell, kWithinCell);
        if (const double length = glm::length(move); length > most) move *= most / length;
        place[v] = surface_.origin[v] + move;
      }
    }
  }

  // Along the shorter diagonal; a polygon with vertices on its edges as a fan around the first of them.
  void triangulate(const Polygon& p) {
    const auto at = [&](int i) -> const glm::dvec3& { return surface_.place[p.vertices[i % p.count]]; };
    int first = p.count == 4 && glm::distance(at(1), at(3)) < glm::distance(at(0), at(2)) ? 1 : 0;
    if (p.count > 4)
      while (!isMiddle(p.vertices[first])) ++first;
    for (int i = 1; i + 1 < p.count; ++i)
      surface_.triangles.push_back(
          {p.vertices[first], p.vertices[(first + i) % p.count], p.vertices[(first + i + 1) % p.count]});
  }

  const LevelVoxels& level_;
  const std::vector<VoxelFace>& faces_;
  FaceTable table_;
  std::vector<std::uint32_t> fan_;     // of each corner of each face; from number() on: its vertex
  std::vector<std::uint32_t> middle_;  // of each edge of each face: its vertex, or kNoCorner
  std::vector<glm::dvec3> middles_;
  VoxelSurface surface_;
};

}  // namespace

glm::ivec3 VoxelFace::corner(int i) const {
  const int u = (axis() + 1) % 3, v = (axis() + 2) % 3;
  const int at = side % 2 ? i : 3 - i;  // (0,0) (1,0) (1,1) (0,1), or back
  glm::ivec3 corner = voxel;
  corner[axis()] += side % 2;
  corner[u] += at == 1 || at == 2 ? 1 : 0;
  corner[v] += at >= 2 ? 1 : 0;
  return corner;
}

glm::ivec3 VoxelFace::sideways(int i) const {
  // Twice the edge's middle less twice the face's.
  const glm::ivec3 edge = corner(i) + corner((i + 1) % 4);
  return edge - (corner(0) + corner(2));
}

std::vector<VoxelFace> facesOf(const LevelVoxels& level) {
  std::vector<VoxelFace> faces;
  level.eachSolid([&](const glm::ivec3& voxel) {
    for (int side = 0; side < 6; ++side) {
      const VoxelFace face{voxel, side};
      if (!level.solid(voxel + face.outward())) faces.push_back(face);
    }
  });
  return faces;
}

VoxelSurface surfaceOf(const LevelVoxels& level, const std::vector<VoxelFace>& faces, double most) {
  return Builder(level, faces).build(most);
}

}  // namespace kelp::dump
