// SPDX-License-Identifier: MIT
#include "caps.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>

#include "fairing.h"
#include "rim.h"

namespace kelp::bake {
namespace {

// of the component's surface; what bulges in smaller holes is no voxel in a thousand
constexpr double kLeastShare = 0.0025;

// Whether the surface around goes on over the hole. Not if it dips there, nor if it stands upright or flares:
// so a sleeve, a neck or a bowl ends. Nor if the rim lies in a plane: so openings are made, and tears are
// not.
bool isTorn(const Rim& rim) {
  constexpr double kLeastRise = 0.1, kMostRise = 0.9, kLeastInward = -0.25, kPlane = 0.005;
  return rim.rise > kLeastRise && rim.rise < kMostRise && rim.inward > kLeastInward &&
         rim.unevenness > kPlane;
}

void appendCone(const Hole& hole, std::vector<SolidTriangle>& cones) {
  for (std::size_t i = 0; i < hole.corners.size(); ++i) {
    SolidTriangle cone;
    cone.vertex = {hole.corners[i], hole.corners[(i + 1) % hole.corners.size()], hole.apex};
    cone.source = kCap;
    cone.component = hole.component;
    cones.push_back(cone);
  }
}

double coneArea(const Topology& mesh, const Hole& hole) {
  std::vector<SolidTriangle> cone;
  appendCone(hole, cone);
  return std::accumulate(cone.begin(), cone.end(), 0.0, [&](double area, const SolidTriangle& t) {
    return area + glm::length(mesh.areaVector(t));
  });
}

// The cap that continues the surface around a hole; none where the cones are the better guess.
std::vector<SolidTriangle> continueSurface(Topology& mesh, const Hole& hole) {
  std::vector<glm::dvec3> corners;
  for (const std::uint32_t corner : hole.corners) corners.push_back(mesh.position(corner));
  const Rim rim = walkRim(corners, hole.normals);
  if (rim.points.empty() || !isTorn(rim)) return {};
  Patch patch = spanPolygon(rim.points);
  fairPatch(patch, rim.beyond);
  const glm::dvec3 apex = mesh.position(hole.apex);
  double reach = 0;
  for (const glm::dvec3& corner : corners) reach = std::max(reach, glm::distance(corner, apex));
  // Even over an upright rim a plate rises by about half the radius of the hole: what goes far beyond has
  // lost its way.
  for (const OpenMesh::VertexHandle vertex : patch.mesh.vertices()) {
    if (!(glm::distance(pointOf(patch.mesh, vertex), apex) <= 1.5 * reach)) return {};
  }

  std::vector<SolidTriangle> cap;
  const auto add = [&](std::uint32_t a, std::uint32_t b, std::uint32_t c, bool seam) {
    SolidTriangle t;
    t.seam = seam;
    t.vertex = {a, b, c};
    t.source = kCap;
    t.component = hole.component;
    cap.push_back(t);
  };
  const std::uint32_t first = static_cast<std::uint32_t>(mesh.lattice.size());
  for (const OpenMesh::VertexHandle vertex : patch.mesh.vertices()) {
    const glm::dvec3 p = pointOf(patch.mesh, vertex);
    mesh.lattice.emplace_back(std::llround(p.x / kLatticeStep), std::llround(p.y / kLatticeStep),
                              std::llround(p.z / kLatticeStep));
  }
  for (const OpenMesh::SmartFaceHandle face : patch.mesh.faces()) {
    std::array<std::uint32_t, 3> corner{};
    std::size_t k = 0;
    for (const OpenMesh::SmartVertexHandle vertex : face.vertices())
      corner[k++] = first + static_cast<std::uint32_t>(vertex.idx());
    add(corner[0], corner[1], corner[2], false);
  }
  // A band of slivers joins the patch to the hole, corner by corner along the way.
  const std::size_t steps = rim.points.size();
  std::size_t corner = 0, step = 0;
  double walked = glm::distance(corners[0], corners[1 % corners.size()]);
  const std::size_t count = hole.corners.size();
  while (corner < count || step < steps) {
    if (step == steps || (corner < count && walked <= static_cast<double>(step + 1) * rim.step)) {
      add(hole.corners[corner], hole.corners[(corner + 1) % count],
          first + static_cast<std::uint32_t>(step % steps), true);
      ++corner;
      if (corner < count) walked += glm::distance(corners[corner], corners[(corner + 1) % count]);
    } else {
      add(first + static_cast<std::uint32_t>((step + 1) % steps), first + static_cast<std::uint32_t>(step),
          hole.corners[corner % count], true);
      ++step;
    }
  }
  return cap;
}

}  // namespace

std::vector<SolidTriangle> makeCones(Topology& mesh, std::vector<Hole>& holes) {
  std::vector<SolidTriangle> cones;
  for (Hole& hole : holes) {
    glm::dvec3 moment(0);
    double length = 0;
    for (std::size_t i = 0; i < hole.corners.size(); ++i) {
      const glm::dvec3 a(mesh.lattice[hole.corners[i]]),
          b(mesh.lattice[hole.corners[(i + 1) % hole.corners.size()]]);
      moment += (a + b) * 0.5 * glm::length(b - a);
      length += glm::length(b - a);
    }
    const glm::dvec3 p = moment / length;
    hole.apex = static_cast<std::uint32_t>(mesh.lattice.size());
    mesh.lattice.emplace_back(std::llround(p.x), std::llround(p.y), std::llround(p.z));
    appendCone(hole, cones);
  }
  return cones;
}

void addCaps(Topology& mesh, std::vector<Hole> holes) {
  std::vector<SolidTriangle> cones;
  for (Hole& hole : holes) {
    const Component& component = mesh.components[hole.component];
    if (!component.solid) continue;
    if (component.volume < 0) hole.turn();  // its triangles were turned, so the rim runs the other way
    std::vector<SolidTriangle> cap;
    if (coneArea(mesh, hole) >= kLeastShare * component.area) cap = continueSurface(mesh, hole);
    mesh.triangles.insert(mesh.triangles.end(), cap.begin(), cap.end());
    mesh.caps += cap.size();
    if (cap.empty()) appendCone(hole, cones);
  }
  mesh.triangles.insert(mesh.triangles.end(), cones.begin(), cones.end());
  mesh.caps += cones.size();
  mesh.cones = cones.size();
}

}  // namespace kelp::bake
