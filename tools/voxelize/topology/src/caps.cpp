// SPDX-License-Identifier: MIT
#include "caps.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <unordered_map>

#include "fairing.h"
#include "rim.h"

namespace kelp::bake {
namespace {

// Takes a cycle of oriented edges apart into loops that pass through each vertex once: holes that touch in a
// vertex are two, and a cone for each is much smaller than one for both.
class LoopFinder {
 public:
  void clear() {
    local_ = {};  // clear() would pass over the buckets of the largest hole each time
    vertices_.clear();
  }
  void add(std::uint32_t from, std::uint32_t to) {
    numberOf(to);
    vertices_[numberOf(from)].next.push_back(to);
  }
  // Calls visit(edges) for each loop.
  template <class Visit>
  void find(const Visit& visit) {
    for (std::uint32_t start = 0; start < vertices_.size(); ++start) {
      std::uint32_t at = start;
      while (vertices_[start].used < vertices_[start].next.size() || !path_.empty()) {
        Vertex& vertex = vertices_[at];
        assert(vertex.used < vertex.next.size());  // as many edges leave a vertex as arrive
        const std::uint32_t to = vertex.next[vertex.used++];
        vertex.place = static_cast<std::uint32_t>(path_.size());
        path_.push_back({vertex.name, to});
        at = local_.at(to);
        if (vertices_[at].place == kNowhere) continue;
        const std::size_t first = vertices_[at].place;
        visit(std::span<const std::array<std::uint32_t, 2>>(path_).subspan(first));
        for (std::size_t i = first; i < path_.size(); ++i) vertices_[local_.at(path_[i][0])].place = kNowhere;
        path_.resize(first);
      }
    }
  }

 private:
  static constexpr std::uint32_t kNowhere = 0xffffffffu;
  struct Vertex {
    std::uint32_t name = 0;
    std::vector<std::uint32_t> next;
    std::size_t used = 0;            // of next
    std::uint32_t place = kNowhere;  // on the path
  };
  std::uint32_t numberOf(std::uint32_t name) {
    const auto [at, fresh] = local_.try_emplace(name, static_cast<std::uint32_t>(vertices_.size()));
    if (fresh) vertices_.emplace_back().name = name;
    return at->second;
  }

  std::unordered_map<std::uint32_t, std::uint32_t> local_;
  std::vector<Vertex> vertices_;
  std::vector<std::array<std::uint32_t, 2>> path_;
};

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

// Area vectors of the component's triangles at each corner of a hole, summed.
class RimNormals {
 public:
  void want(const SolidTriangle& cone) {
    sums_.try_emplace(key(cone.component, cone.vertex[0]), glm::dvec3(0));
  }
  void gather(const Topology& mesh) {
    if (sums_.empty()) return;
    for (const SolidTriangle& t : mesh.triangles) {
      for (const std::uint32_t v : t.vertex) {
        const auto at = sums_.find(key(t.component, v));
        if (at != sums_.end()) at->second += mesh.areaVector(t);
      }
    }
  }
  glm::dvec3 at(const SolidTriangle& cone) const { return sums_.at(key(cone.component, cone.vertex[0])); }

 private:
  static std::uint64_t key(std::uint32_t component, std::uint32_t vertex) {
    return std::uint64_t{component} << 32 | vertex;
  }
  std::unordered_map<std::uint64_t, glm::dvec3> sums_;
};

// The cap that continues the surface around a hole; none where the cones are the better guess.
std::vector<SolidTriangle> continueSurface(Topology& mesh, std::span<const SolidTriangle> hole,
                                           const RimNormals& normals) {
  std::vector<glm::dvec3> corners, around;
  for (const SolidTriangle& cone : hole) {
    corners.push_back(mesh.position(cone.vertex[0]));
    around.push_back(normals.at(cone));
  }
  const Rim rim = walkRim(corners, around);
  if (rim.points.empty() || !isTorn(rim)) return {};
  Patch patch = spanPolygon(rim.points);
  fairPatch(patch, rim.beyond);
  const glm::dvec3 apex = mesh.position(hole[0].vertex[2]);
  double reach = 0;
  for (const glm::dvec3& corner : corners) reach = std::max(reach, glm::distance(corner, apex));
  // Even over an upright rim a plate rises by about half the radius of the hole: what goes far beyond has
  // lost its way.
  const auto runsAway = [&](const glm::dvec3& p) { return !(glm::distance(p, apex) <= 1.5 * reach); };
  if (std::any_of(patch.points.begin(), patch.points.end(), runsAway)) return {};

  std::vector<SolidTriangle> cap;
  const auto add = [&](std::uint32_t a, std::uint32_t b, std::uint32_t c, bool seam) {
    SolidTriangle t;
    t.seam = seam;
    t.vertex = {a, b, c};
    t.source = kCap;
    t.component = hole[0].component;
    cap.push_back(t);
  };
  const std::uint32_t first = static_cast<std::uint32_t>(mesh.lattice.size());
  for (const glm::dvec3& p : patch.points)
    mesh.lattice.emplace_back(std::llround(p.x / kLatticeStep), std::llround(p.y / kLatticeStep),
                              std::llround(p.z / kLatticeStep));
  for (const auto& [a, b, c] : patch.triangles) add(first + a, first + b, first + c, false);
  // A band of slivers joins the patch to the hole, corner by corner along the way.
  const std::size_t steps = rim.points.size();
  std::size_t corner = 0, step = 0;
  double walked = glm::distance(corners[0], corners[1 % corners.size()]);
  while (corner < hole.size() || step < steps) {
    if (step == steps || (corner < hole.size() && walked <= static_cast<double>(step + 1) * rim.step)) {
      add(hole[corner].vertex[0], hole[corner].vertex[1], first + static_cast<std::uint32_t>(step % steps),
          true);
      ++corner;
      if (corner < hole.size())
        walked += glm::distance(corners[corner], corners[(corner + 1) % corners.size()]);
    } else {
      add(first + static_cast<std::uint32_t>((step + 1) % steps), first + static_cast<std::uint32_t>(step),
          hole[corner % hole.size()].vertex[0], true);
      ++step;
    }
  }
  return cap;
}

}  // namespace

std::vector<SolidTriangle> makeCones(Topology& mesh, std::span<const BoundaryEdge> boundary) {
  std::vector<SolidTriangle> caps;
  LoopFinder loops;
  for (std::size_t begin = 0; begin < boundary.size();) {
    std::size_t end = begin;
    loops.clear();
    while (end < boundary.size() && boundary[end].component == boundary[begin].component) {
      loops.add(boundary[end].from, boundary[end].to);
      ++end;
    }
    loops.find([&](std::span<const std::array<std::uint32_t, 2>> loop) {
      glm::dvec3 moment(0);
      double length = 0;
      for (const auto& [from, to] : loop) {
        const glm::dvec3 a(mesh.lattice[from]), b(mesh.lattice[to]);
        moment += (a + b) * 0.5 * glm::length(b - a);
        length += glm::length(b - a);
      }
      const glm::dvec3 p = moment / length;
      const std::uint32_t apex = static_cast<std::uint32_t>(mesh.lattice.size());
      mesh.lattice.emplace_back(std::llround(p.x), std::llround(p.y), std::llround(p.z));
      for (const auto& [from, to] : loop) {
        SolidTriangle cap;
        cap.vertex = {from, to, apex};
        cap.source = kCap;
        cap.component = boundary[begin].component;
        caps.push_back(cap);
      }
    });
    begin = end;
  }
  return caps;
}

void addCaps(Topology& mesh, std::vector<SolidTriangle> cones) {
  struct Hole {
    std::span<const SolidTriangle> cones;
    bool large = false;
  };
  std::vector<Hole> holes;
  RimNormals normals;
  for (std::size_t begin = 0; begin < cones.size();) {
    std::size_t end = begin;
    double area = 0;
    for (; end < cones.size() && cones[end].vertex[2] == cones[begin].vertex[2]; ++end)
      area += glm::length(mesh.areaVector(cones[end]));
    const Component& component = mesh.components[cones[begin].component];
    if (component.solid) {
      const std::span<SolidTriangle> of_hole(cones.data() + begin, end - begin);
      if (component.volume < 0) {  // its triangles were turned, so the rim runs the other way
        std::reverse(of_hole.begin(), of_hole.end());
        for (SolidTriangle& cone : of_hole) std::swap(cone.vertex[0], cone.vertex[1]);
      }
      holes.push_back({of_hole, area >= kLeastShare * component.area});
      if (holes.back().large)
        std::for_each(holes.back().cones.begin(), holes.back().cones.end(),
                      [&](const SolidTriangle& cone) { normals.want(cone); });
    }
    begin = end;
  }
  normals.gather(mesh);
  std::vector<SolidTriangle> kept;
  for (const Hole& hole : holes) {
    const std::vector<SolidTriangle> cap =
        hole.large ? continueSurface(mesh, hole.cones, normals) : std::vector<SolidTriangle>();
    mesh.triangles.insert(mesh.triangles.end(), cap.begin(), cap.end());
    mesh.caps += cap.size();
    if (cap.empty()) kept.insert(kept.end(), hole.cones.begin(), hole.cones.end());
  }
  mesh.triangles.insert(mesh.triangles.end(), kept.begin(), kept.end());
  mesh.caps += kept.size();
  mesh.cones = kept.size();
}

}  // namespace kelp::bake
