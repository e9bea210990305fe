// SPDX-License-Identifier: MIT
#include "proxy/surface_distance.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace kelp::dump {
namespace {

constexpr double kFar = std::numeric_limits<double>::max();

TreeBox boxOf(const VoxelFace& face) {
  glm::vec3 low(face.voxel), high(face.voxel + 1);
  (face.side % 2 ? low : high)[face.axis()] = (face.side % 2 ? high : low)[face.axis()];
  return {low, high};
}

std::vector<TreeBox> boxesOf(const std::vector<VoxelFace>& faces) {
  std::vector<TreeBox> boxes;
  boxes.reserve(faces.size());
  for (const VoxelFace& face : faces) boxes.push_back(boxOf(face));
  return boxes;
}

// A face is its own box.
double squaredDistance(const glm::dvec3& p, const VoxelFace& face) {
  const TreeBox box = boxOf(face);
  const glm::dvec3 out = glm::max(glm::max(glm::dvec3(box.low) - p, p - glm::dvec3(box.high)), glm::dvec3(0));
  return glm::dot(out, out);
}

BoxTree treeOf(const ProxyMesh& mesh) {
  std::vector<TreeBox> boxes;
  boxes.reserve(mesh.triangles.size());
  for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
    const Triangle t = mesh.triangle(i);
    // Rounded to float, and a bit more.
    const glm::vec3 low(glm::min(t.a, glm::min(t.b, t.c))), high(glm::max(t.a, glm::max(t.b, t.c)));
    const glm::vec3 more = 1e-6f * glm::max(glm::abs(low), glm::abs(high));
    boxes.push_back({low - more, high + more});
  }
  return BoxTree(boxes);
}

// The largest distance of a triangle's points, at most `tolerance` too large. The distance to one thing is
// convex, so it is largest at a corner; and a distance grows by no more than the way: what is in a triangle
// is at most its radius farther away than its middle. Triangles that could exceed what was found so far are
// cut in two. `nearest(p)` is a BoxTree::Nearest, `squared(p, thing)` the distance to a thing.
template <class NearestTo, class Squared>
class Farthest {
 public:
  Farthest(const NearestTo& nearest, const Squared& squared, double tolerance)
      : nearest_(nearest), squared_(squared), tolerance_(tolerance) {}
  void see(const glm::dvec3& p) { found_ = std::max(found_, std::sqrt(nearest_(p).squared)); }
  void see(const Triangle& triangle) {
    const double bound = found_ + tolerance_;
    const BoxTree::Nearest at = nearest_(triangle.middle());
    const double middle = std::sqrt(at.squared);
    found_ = std::max(found_, middle);
    if (middle + triangle.radius() <= bound) return;
    const double most = bound * bound;
    if (squared_(triangle.a, at.thing) <= most && squared_(triangle.b, at.thing) <= most &&
        squared_(triangle.c, at.thing) <= most)
      return;
    Triangle halves[2];
    triangle.split(halves[0], halves[1]);
    for (const Triangle& half : halves) see(half);
  }
  double bound() const { return found_ + tolerance_; }

 private:
  const NearestTo& nearest_;
  const Squared& squared_;
  const double tolerance_;
  double found_ = 0;
};

}  // namespace

SurfaceDistance::SurfaceDistance(const LevelVoxels& level, const std::vector<VoxelFace>& faces)
    : level_(level), faces_(faces), tree_(boxesOf(faces)) {}

BoxTree::Nearest SurfaceDistance::nearest(const glm::dvec3& p, double limit) const {
  return tree_.nearest(p, limit, [&](std::uint32_t face) { return squaredDistance(p, faces_[face]); });
}

// An upper bound of the distance, found at once: from the faces of the cell that p is in.
double SurfaceDistance::bound(const glm::dvec3& p) const {
  const glm::ivec3 cell(glm::floor(p));
  const bool solid = level_.solid(cell);
  double least = kFar;
  for (int side = 0; side < 6; ++side) {
    const double at = p[side / 2] - cell[side / 2], apart = side % 2 ? 1 - at : at;
    if (apart < least && level_.solid(cell + VoxelFace{cell, side}.outward()) != solid) least = apart;
  }
  return least;
}

bool SurfaceDistance::within(const Triangle& triangle, double most) const {
  const double radius = triangle.radius();
  const glm::dvec3 middle = triangle.middle();
  if (bound(middle) + radius <= most) return true;
  const double limit = most * most;
  const BoxTree::Nearest at = nearest(middle, limit);
  if (at.thing == BoxTree::kNothing) return false;
  if (std::sqrt(at.squared) + radius <= most) return true;
  const VoxelFace& face = faces_[at.thing];
  if (squaredDistance(triangle.a, face) <= limit && squaredDistance(triangle.b, face) <= limit &&
      squaredDistance(triangle.c, face) <= limit)
    return true;
  if (radius < most / 15) return false;
  Triangle one, two;
  triangle.split(one, two);
  return within(one, most) && within(two, most);
}

double SurfaceDistance::fromMesh(const ProxyMesh& mesh, double error) const {
  const auto nearestFace = [&](const glm::dvec3& p) { return nearest(p, kFar); };
  const auto squared = [&](const glm::dvec3& p, std::uint32_t i) { return squaredDistance(p, faces_[i]); };
  Farthest farthest(nearestFace, squared, tolerance(error));
  for (const glm::dvec3& p : mesh.points) farthest.see(p);
  for (std::size_t i = 0; i < mesh.triangles.size(); ++i) farthest.see(mesh.triangle(i));
  return farthest.bound();
}

double SurfaceDistance::toMesh(const ProxyMesh& mesh, double error) const {
  const BoxTree tree = treeOf(mesh);
  const auto squared = [&](const glm::dvec3& p, std::uint32_t i) {
    return kelp::dump::squaredDistance(p, mesh.triangle(i));
  };
  const auto nearestTriangle = [&](const glm::dvec3& p) {
    return tree.nearest(p, kFar, [&](std::uint32_t i) { return squared(p, i); });
  };
  Farthest farthest(nearestTriangle, squared, tolerance(error));
  for (const VoxelFace& face : faces_) farthest.see(glm::dvec3(face.corner(0)));
  for (const VoxelFace& face : faces_) {
    const glm::dvec3 corners[4] = {face.corner(0), face.corner(1), face.corner(2), face.corner(3)};
    farthest.see(Triangle{corners[0], corners[1], corners[2]});
    farthest.see(Triangle{corners[0], corners[2], corners[3]});
  }
  return farthest.bound();
}

}  // namespace kelp::dump
