// SPDX-License-Identifier: MIT
#include "reference/cage_trials.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <numbers>
#include <random>
#include <stdexcept>

#include "kelp/fields/cages.h"
#include "reference/posed_trial.h"
#include "support/boxed_level.h"
#include "support/poses.h"

namespace kelp::reference {
namespace {

using glm::dvec3;
using glm::ivec3;

constexpr double kTurn = 2 * std::numbers::pi;
constexpr int kCageLevels = 6;  // of parts

// The spline of two knots of Figure 6, sheared.
dvec3 sheared(const dvec3& rest, double height, const dvec3& first, const dvec3& second) {
  const double y = rest.y / height;
  const auto at = [&](double t) {
    return t * (1 - t) * (1 - t) * first + t * t * (3 - 2 * t) * dvec3(0, 1, 0) - t * t * (1 - t) * second;
  };
  double low = 0, high = 1;
  for (int n = 0; n < 50; ++n) (at(0.5 * (low + high)).y < y ? low : high) = 0.5 * (low + high);
  return dvec3(rest.x, 0, rest.z) + height * dvec3(at(low).x, y, at(low).z);
}

struct CageRay {
  dvec3 o, r;
  bool outside = true;  // it begins outside of the bounds
};

class CageRayMaker {
 public:
  CageRayMaker(const CagedVolume& volume, const PosedTrial& posed, unsigned seed)
      : volume_(volume), posed_(posed), random_(seed) {
    const Cage& cage = posed.cage();
    const auto& blocks = volume.sources.back().blocks;
    for (int n = 0; n < static_cast<int>(blocks.size()); ++n) {
      if (blocks[static_cast<std::size_t>(n)] == kInsideBlock)
        inside_.push_back({n % cage.grid.x, n / cage.grid.x % cage.grid.y, n / cage.grid.x / cage.grid.y});
    }
  }

  // Not inlined: see RayMaker in trials.cpp.
  [[gnu::noinline]] CageRay make(int kind) {
    const Cage& cage = posed_.cage();
    const auto cell = static_cast<std::uint32_t>(random_() % cage.cells());
    const CageTetrahedron& t = kCageTetrahedra[random_() % 6];
    std::array<dvec3, 4> x;
    for (std::size_t c = 0; c < 4; ++c) x[c] = posed_.node(cage.node(cell, t.corners[c]));
    std::shuffle(x.begin(), x.end(), random_);
    dvec3 d = 2.0 * dvec3(unit(), unit(), unit()) - 1.0 + dvec3(1e-4, 0, 0);
    double a = unit(), b = unit();
    if (a + b > 1) a = 1 - a, b = 1 - b;
    dvec3 target = x[0] + a * (x[1] - x[0]) + b * (x[2] - x[0]) + 0.3 * unit() * (x[3] - x[0]);
    if (kind == 0 || kind == 7) target = besideSolid(cell, t);
    if (kind == 1) target = x[0];
    if (kind == 2) target = x[0] + a * (x[1] - x[0]);
    if (kind == 3 || kind == 4) target = x[0] + a * (x[1] - x[0]) + b * (x[2] - x[0]);
    if (kind == 4) d = x[1] - x[0] + 2 * (unit() - 0.5) * (x[2] - x[0]);
    if (kind == 5) {
      target = x[0];
      d = x[1] - x[0];
    }
    if (kind == 6) {
      d = dvec3(0);
      d[static_cast<int>(random_() % 3)] = 1;
    }
    if (kind == 8) withinVoxelFace(cell, t, target, d);
    if (kind == 10 && !inside_.empty()) target = insideCube();
    if (!(glm::length(d) > 1e-6)) d = dvec3(0, 1, 0);
    d = (random_() & 1 ? 1.0 : -1.0) * glm::normalize(d);
    if (kind >= 9) return {target, d, false};
    const Box& box = posed_.bounds();
    double back = 1e30;
    for (int axis = 0; axis < 3; ++axis) {
      if (d[axis] != 0)
        back = std::min(back, (target[axis] - double{d[axis] > 0 ? box.min[axis] : box.max[axis]}) / d[axis]);
    }
    back = std::max(back, 0.0) + 0.5;
    if (kind == 7) {
      // From far away, the direction rounded there; then moved to the bounds in double precision, as raycast
      // does.
      const double far = 30 * glm::length(dvec3(box.max - box.min));
      const glm::vec3 from(target - far * d), towards(d);
      const dvec3 r = glm::normalize(dvec3(towards));
      return {dvec3(from) + (far - back) * r, r};
    }
    return {target - back * d, d};
  }

 private:
  double unit() { return std::uniform_real_distribution<double>(0, 1)(random_); }
  // Where a point of a cell is, by its coordinates there.
  dvec3 posed(std::uint32_t cell, const CageTetrahedron& t, const dvec3& f) const {
    const auto corner = [&](int i) { return posed_.node(posed_.cage().node(cell, t.corners[i])); };
    dvec3 at = corner(0);
    for (int e = 0; e < 3; ++e) at += f[t.axes[e]] * (corner(e + 1) - corner(e));
    return at;
  }
  // Close to a solid voxel of the cell, in one of its tetrahedra.
  dvec3 besideSolid(std::uint32_t cell, const CageTetrahedron& t) {
    const fields::Occupancy& voxels = volume_.voxels[0];
    const int side = posed_.cage().side >> volume_.level;
    dvec3 f(unit(), unit(), unit());
    for (int i = 0; i < 200; ++i) {
      const ivec3 v(dvec3(side) * dvec3(unit(), unit(), unit()));
      const ivec3 at = side * posed_.cage().place(cell) + v;
      const bool there = at.x < voxels.size.x && at.y < voxels.size.y && at.z < voxels.size.z;
      if (!there || !voxels.solid[voxels.index(at)]) continue;
      f = (dvec3(v) - 0.25 + 1.5 * dvec3(unit(), unit(), unit())) / static_cast<double>(side);
      break;
    }
    return posed(cell, inOrder(f, t), f);
  }
  // The tetrahedron that holds a point, or about.
  static const CageTetrahedron& inOrder(const dvec3& f, const CageTetrahedron& otherwise) {
    for (const CageTetrahedron& t : kCageTetrahedra)
      if (f[t.axes[0]] >= f[t.axes[1]] && f[t.axes[1]] >= f[t.axes[2]]) return t;
    return otherwise;
  }
  void withinVoxelFace(std::uint32_t cell, const CageTetrahedron& t, dvec3& target, dvec3& d) {
    const int side = posed_.cage().side >> volume_.level, axis = static_cast<int>(random_() % 3);
    dvec3 f(unit(), unit(), unit()), beside(unit(), unit(), unit());
    f[axis] = beside[axis] = static_cast<double>(random_() % static_cast<unsigned>(side + 1)) / side;
    const CageTetrahedron& in = inOrder(f, t);
    target = posed(cell, in, f);
    d = posed(cell, in, beside) - target;
  }
  dvec3 insideCube() {
    const ivec3 place = inside_[random_() % inside_.size()];
    // The corner of the cube may be a node: those of cells beside.
    dvec3 middle(0);
    double sum = 0;
    for (int c = 0; c < 8; ++c) {
      const double weight = unit() + 0.1;
      middle += weight * dvec3(posed_.corner(place + ivec3(c & 1, c >> 1 & 1, c >> 2)));
      sum += weight;
    }
    return middle / sum;
  }

  const CagedVolume& volume_;
  const PosedTrial& posed_;
  std::vector<ivec3> inside_;
  std::mt19937 random_;
};

void judgeInto(CageTally& tally, const Truth& truth, const trace::KelpHit& hit, double s,
               const std::string& what) {
  tally.tetrahedra += static_cast<std::uint64_t>(hit.clips);
  tally.most_tetrahedra = std::max(tally.most_tetrahedra, hit.clips);
  if (!tally.count(truth, hit, s)) return;
  char text[160];
  std::snprintf(text, sizeof text, ": %s %.4f cell %d.%d; owed %.4f, possible %.4f",
                hit.found ? "hit" : "no hit", s, hit.segment >> 3, hit.segment & 7, truth.owed.value_or(-1),
                truth.possible.value_or(-1));
  tally.first_failure = what + text;
}

}  // namespace

CagedVolume cagedVolume(std::string name, const fields::Occupancy& volume, int cell, int level, bool lost) {
  CagedVolume out;
  out.name = std::move(name) + ", cells " + std::to_string(cell) + ", level " + std::to_string(level);
  out.size = volume.size;
  out.level = level;
  out.lost = lost;
  out.sources = fields::buildCages(fields::SolidBits(volume, 1), kCageLevels, cell);
  out.sources.resize(static_cast<std::size_t>(level) + 1);
  out.cages.reserve(out.sources.size());
  for (std::size_t i = 0; i < out.sources.size(); ++i) {
    out.memories.push_back(std::make_unique<CageMemory>());
    Result<Cage> made =
        makeCage(out.sources[i].source(), volume.size, kCageLevels, cell, static_cast<int>(i),
                 i > 0 ? &out.cages[i - 1] : nullptr, std::uint64_t{1} << 30, *out.memories[i]);
    if (!made) throw std::runtime_error(made.error().detail);
    out.cages.push_back(*made);
  }
  fields::Occupancy voxels = volume;
  for (int l = 0; l <= out.cage().last_level; ++l) {
    if (l > 0) voxels = fields::coarser(voxels);
    if (l < level) continue;
    out.levels.push_back(test::boxedLevel(voxels, test::plainSurface(voxels), 1));
    out.voxels.push_back(voxels);
  }
  return out;
}

std::vector<CagePose> namedCagePoses(const ivec3& size) {
  const dvec3 s(size), lift(3.7, 17.3, -2.9);
  std::vector<CagePose> poses{{"rest", [=](const dvec3& p) { return p + lift; }}};
  for (const std::size_t i : {1u, 3u, 5u}) {
    const test::FigurePose& pose = test::kFigure6[i];
    poses.push_back(
        {pose.name, [=](const dvec3& p) { return sheared(p, s.y, dvec3(pose.first), dvec3(pose.second)); }});
  }
  poses.push_back({"bent", [=](const dvec3& p) {
                     const double radius = std::max(4 * s.y / kTurn, 0.7 * s.x), a = 0.25 * kTurn * p.y / s.y;
                     const double out = radius - (p.x - 0.5 * s.x);
                     return dvec3(radius - out * std::cos(a), out * std::sin(a), p.z);
                   }});
  poses.push_back({"twisted", [=](const dvec3& p) {
                     const double a = kTurn * p.y / s.y, x = p.x - 0.5 * s.x, z = p.z - 0.5 * s.z;
                     return dvec3(std::cos(a) * x - std::sin(a) * z, p.y, std::sin(a) * x + std::cos(a) * z);
                   }});
  poses.push_back({"1.5 times as large", [=](const dvec3& p) { return 1.5 * p + lift; }});
  poses.push_back({"squeezed", [=](const dvec3& p) { return dvec3(0.2, 1.1, 0.7) * p + lift; }});
  return poses;
}

CagePose shakenPose(double shaken) {
  char name[40];
  std::snprintf(name, sizeof name, "shaken by %g", shaken);
  return {name, [](const dvec3& p) { return p + dvec3(3.7, 17.3, -2.9); }, shaken};
}

void CageTally::add(const CageTally& more) {
  TrialTally::add(more);
  inverted += more.inverted;
  tetrahedra += more.tetrahedra;
  most_tetrahedra = std::max(most_tetrahedra, more.most_tetrahedra);
  inside += more.inside;
}

CageTallies runCageTrial(const CagedVolume& volume, const CagePose& pose, int rays, unsigned seed) {
  const PosedTrial posed(volume, pose, seed);
  CageTallies tallies;
  tallies.traced.inverted = tallies.walked.inverted = static_cast<std::uint64_t>(posed.truth().inverted());
  const float s_max = 2 * glm::length(posed.bounds().max - posed.bounds().min) + 2;
  CageRayMaker make(volume, posed, seed);
  for (int i = 0; i < rays; ++i) {
    // Where tetrahedra are inverted, nothing is known of the inside.
    const int kinds = tallies.traced.inverted > 0 ? kCageRayKinds - 1 : kCageRayKinds, kind = i % kinds;
    const CageRay ray = make.make(kind);
    const glm::vec3 o(ray.o), r(ray.r);
    const Truth truth = posed.truth().truthOf(dvec3(o), dvec3(r), double{s_max});
    char what[240];
    std::snprintf(what, sizeof what, "%s, %s, seed %u, kind %d: o (%a %a %a) r (%a %a %a)",
                  volume.name.c_str(), pose.name.c_str(), seed, kind, double{o.x}, double{o.y}, double{o.z},
                  double{r.x}, double{r.y}, double{r.z});
    const trace::KelpHit hit = trace::kelpTraceCaged(posed.context(), o, r, 0.0f, s_max);
    judgeInto(tallies.traced, truth, hit, double{hit.s}, std::string(what) + ", traced");
    tallies.traced.inside += kind == 10 && hit.found && hit.s == 0;
    if (!ray.outside) continue;
    double s;
    const trace::KelpHit walked =
        walkCaged(posed.context(), posed.truth().starts(dvec3(o), dvec3(r), double{s_max}), o, r, s_max, s);
    judgeInto(kind >= 1 && kind <= 5 ? tallies.aimed : tallies.walked, truth, walked, s,
              std::string(what) + ", walked");
  }
  return tallies;
}

}  // namespace kelp::reference
