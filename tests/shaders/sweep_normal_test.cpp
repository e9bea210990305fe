// SPDX-License-Identifier: MIT
// Normals of swept parts, from arc.glsl compiled as C++, beside finite differences of the map in double
// precision.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>

#include "reference/sweep_trials.h"
#include "reference/sweep_truth.h"
#include "trace_cpp.h"

namespace kelp {
namespace {

using glm::dvec3;
using reference::SweepRig;

constexpr double kDegree = std::numbers::pi / 180;
const glm::ivec3 kSweptSize(72, 256, 64);

// A surface in the slice of one arc: a place, from the middle of the section, and the normal at rest.
struct Surface {
  int arc;
  dvec3 place, normal;
};

class Swept {
 public:
  explicit Swept(const SweepRig& rig) : random_(7) {
    EXPECT_TRUE(makeArcs(rig.knots, kSweptSize, rig.roll, kArcTolerance, chain_)) << rig.name;
    arcs_ = reference::arcsAs<trace::KelpArc>(chain_);
    joints_ = reference::jointsAs<trace::KelpJoint>(chain_);
  }
  int arcs() const { return chain_.count; }

  Surface any() {
    Surface s{static_cast<int>(random_() % arcs_.size()), dvec3(0), dvec3(0)};
    const double low = from(s).y, high = to(s).y;
    s.place = {(unit() - 0.5) * kSweptSize.x, low + (high - low) * unit(), (unit() - 0.5) * kSweptSize.z};
    do s.normal = 2.0 * dvec3(unit(), unit(), unit()) - 1.0;
    while (glm::length(s.normal) > 1 || glm::length(s.normal) < 0.1);
    s.normal = glm::normalize(s.normal);
    return s;
  }
  // On joint i, as the slice before and the one behind it have it.
  std::pair<Surface, Surface> onJoint(int i) {
    Surface before = any();
    before.arc = i - 1;
    before.place.y = joints_[static_cast<std::size_t>(i)].y;
    Surface behind = before;
    behind.arc = i;
    return {before, behind};
  }

  // As drawn.
  dvec3 shaded(const Surface& s) const { return normal(s, from(s), to(s)); }
  // With the arc's own curvature.
  dvec3 ofArc(const Surface& s) const {
    const trace::KelpArc& arc = this->arc(s);
    trace::KelpJoint own = from(s);
    own.curvature = arc.curvature * arc.bend;
    own.rise = arc.rise;
    return normal(s, own, own);
  }
  // The inverse transpose of the derivative of the arc's map.
  dvec3 byDifferences(const Surface& s) const {
    const Arc& arc = chain_.arcs[s.arc];
    const dvec3 rest = s.place + dvec3(0.5 * kSweptSize.x, 0, 0.5 * kSweptSize.z);
    glm::dmat3 derivative;
    for (int axis = 0; axis < 3; ++axis) {
      dvec3 step(0);
      step[axis] = 1e-3;
      derivative[axis] =
          (reference::swept(arc, kSweptSize, rest + step) - reference::swept(arc, kSweptSize, rest - step)) /
          2e-3;
    }
    return glm::normalize(glm::transpose(glm::inverse(derivative)) * s.normal);
  }

 private:
  double unit() { return std::uniform_real_distribution<double>(0, 1)(random_); }
  const trace::KelpArc& arc(const Surface& s) const { return arcs_[static_cast<std::size_t>(s.arc)]; }
  const trace::KelpJoint& from(const Surface& s) const { return joints_[static_cast<std::size_t>(s.arc)]; }
  const trace::KelpJoint& to(const Surface& s) const { return joints_[static_cast<std::size_t>(s.arc) + 1]; }
  dvec3 normal(const Surface& s, const trace::KelpJoint& from, const trace::KelpJoint& to) const {
    const glm::vec3 p(s.place);
    return glm::normalize(
        dvec3(trace::kelpSweepNormal(arc(s), from, to, p.x, p.y, p.z, glm::vec3(s.normal))));
  }

  ArcChain chain_;
  std::vector<trace::KelpArc> arcs_;
  std::vector<trace::KelpJoint> joints_;
  std::mt19937 random_;
};

double angle(const dvec3& a, const dvec3& b) {
  return std::atan2(glm::length(glm::cross(a, b)), glm::dot(a, b));
}

std::vector<SweepRig> rigs() {
  std::vector<SweepRig> all = reference::namedSweeps(kSweptSize);
  for (unsigned seed = 0; seed < 100; ++seed) all.push_back(reference::randomSweep(kSweptSize, seed));
  return all;
}

TEST(SweepNormals, OfAnArcAreThoseOfItsMap) {
  for (const SweepRig& rig : rigs()) {
    Swept swept(rig);
    for (int i = 0; i < 300; ++i) {
      const Surface s = swept.any();
      EXPECT_LT(angle(swept.ofArc(s), swept.byDifferences(s)), 0.1 * kDegree) << rig.name;
    }
  }
}

// The mean angle between the normals as drawn and those of the arcs.
double meanOff(const SweepRig& rig) {
  Swept swept(rig);
  double sum = 0;
  constexpr int kCount = 3000;
  for (int i = 0; i < kCount; ++i) {
    const Surface s = swept.any();
    sum += angle(swept.shaded(s), swept.ofArc(s));
  }
  return sum / kCount;
}

TEST(SweepNormals, AsDrawnAreNearThoseOfTheArcs) {
  for (const SweepRig& rig : reference::namedSweeps(kSweptSize)) EXPECT_LT(meanOff(rig), kDegree) << rig.name;
  double sum = 0;
  for (unsigned seed = 0; seed < 100; ++seed) {
    const double off = meanOff(reference::randomSweep(kSweptSize, seed));
    EXPECT_LT(off, 1.5 * kDegree) << seed;
    sum += off;
  }
  EXPECT_LT(sum / 100, 0.7 * kDegree);
  EXPECT_GT(sum, 0.0);  // they do differ
}

TEST(SweepNormals, AsDrawnDoNotJumpAtJoints) {
  double most_of_arcs = 0;
  for (const SweepRig& rig : rigs()) {
    Swept swept(rig);
    for (int joint = 1; joint < swept.arcs(); ++joint) {
      for (int i = 0; i < 30; ++i) {
        const auto [before, behind] = swept.onJoint(joint);
        EXPECT_LT(angle(swept.shaded(before), swept.shaded(behind)), 0.2 * kDegree) << rig.name;
        most_of_arcs = std::max(most_of_arcs, angle(swept.ofArc(before), swept.ofArc(behind)));
      }
    }
  }
  EXPECT_GT(most_of_arcs, 2 * kDegree);  // but these are not drawn
}

}  // namespace
}  // namespace kelp
