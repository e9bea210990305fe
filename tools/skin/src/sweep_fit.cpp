// SPDX-License-Identifier: MIT
#include "sweep_fit.h"

#include <algorithm>
#include <atomic>
#include <cmath>

#include "kelp/common/parallel.h"
#include "rigid.h"

namespace kelp::bake {
namespace {

// A fitted pose would not fold if the part were so much larger: between keys it bends a little more.
constexpr glm::ivec3 kSpare{2, 0, 2};  // voxels

}  // namespace

// Knots in part space, voxels, and the x axis of the section at the first.
struct SweepFit::Curve {
  std::vector<glm::dvec3> places, slopes;
  glm::dvec3 x{1, 0, 0};

  glm::dmat3 frame() const {
    const glm::dvec3 along = glm::normalize(slopes.front()),
                     across = glm::normalize(x - glm::dot(x, along) * along);
    return {across, along, glm::cross(across, along)};
  }
};

// The points under a curve: their section's place and direction, and where they come to be.
struct SweepFit::Reached {
  std::vector<glm::dvec3> centers, along, places;
  double error = 0;  // the sum of area times squared distance
};

SweepFit::SweepFit(const SkinSamples& samples, const SkinSweep& sweep,
                   const std::vector<std::uint32_t>& members)
    : samples_(samples), sweep_(sweep) {
  constexpr std::size_t kMostPoints = 600;
  const std::size_t stride = (members.size() + kMostPoints - 1) / kMostPoints;
  for (std::size_t i = 0; i < members.size(); i += stride) {
    Point point;
    point.sample = members[i];
    point.area = samples.areas[members[i]];
    point.straight = sweep.straightened(sweep.toPart(samples.positions[members[i]]));
    const double at = std::clamp(static_cast<double>(point.straight.y) / sweep.height(), 0.0, 1.0);
    const auto atOf = [&](std::size_t knot) { return static_cast<double>(sweep.knots[knot].at); };
    while (point.span + 2 < sweep.knots.size() && atOf(point.span + 1) <= at) ++point.span;
    point.t = (at - atOf(point.span)) / (atOf(point.span + 1) - atOf(point.span));
    area_ += point.area;
    points_.push_back(point);
  }
}

std::vector<glm::dvec3> SweepFit::drawn(const SkinMoments& moments, std::size_t moment) const {
  std::vector<glm::dvec3> places;
  for (const Point& point : points_)
    places.push_back(sweep_.toPart(skinnedPoint(samples_, point.sample, moments, moment)));
  return places;
}

// Each knot moves as the surface around it does.
SweepFit::Curve SweepFit::begin(const std::vector<glm::dvec3>& drawn) const {
  const std::size_t count = sweep_.knots.size();
  struct Sums {
    double weight = 0;
    glm::dvec3 from{0}, to{0};
    glm::dmat3 cross{0};
  };
  std::vector<Sums> sums(count);
  std::vector<glm::dvec3> rest;
  for (const Point& point : points_) rest.push_back(sweep_.toPart(samples_.positions[point.sample]));
  const auto each = [&](const auto& add) {
    for (std::size_t i = 0; i < points_.size(); ++i) {
      add(sums[points_[i].span], points_[i].area * (1 - points_[i].t), i);
      add(sums[points_[i].span + 1], points_[i].area * points_[i].t, i);
    }
  };
  each([&](Sums& sum, double weight, std::size_t i) {
    sum.weight += weight;
    sum.from += weight * rest[i];
    sum.to += weight * drawn[i];
  });
  for (Sums& sum : sums)
    if (sum.weight > 0) {
      sum.from /= sum.weight;
      sum.to /= sum.weight;
    }
  each([&](Sums& sum, double weight, std::size_t i) {
    sum.cross += weight * glm::outerProduct(drawn[i] - sum.to, rest[i] - sum.from);
  });
  // Knots beyond the surface move as their neighbors do.
  for (std::size_t k = 1; k < count; ++k)
    if (!(sums[k].weight > 0)) sums[k] = sums[k - 1];
  for (std::size_t k = count - 1; k-- > 0;)
    if (!(sums[k].weight > 0)) sums[k] = sums[k + 1];
  Curve curve;
  const double height = sweep_.height();
  for (std::size_t k = 0; k < count; ++k) {
    const glm::dmat3 turn = nearestRotation(sums[k].cross);
    const Knot& knot = sweep_.knots[k];
    const glm::dvec3 place = height * glm::dvec3(knot.position) + sweep_.corner();
    curve.places.push_back(sums[k].to + turn * (place - sums[k].from));
    curve.slopes.push_back(turn * (height * glm::dvec3(knot.tangent)));
    if (k == 0) curve.x = turn[0];
  }
  return curve;
}

std::vector<Knot> SweepFit::knotsOf(const Curve& curve) const {
  const glm::dmat3 back = glm::transpose(curve.frame()) / sweep_.height();
  std::vector<Knot> knots;
  for (std::size_t k = 0; k < curve.places.size(); ++k)
    knots.push_back({sweep_.knots[k].at, glm::vec3(back * (curve.places[k] - curve.places[0])),
                     glm::vec3(back * curve.slopes[k])});
  knots.front().tangent.x = knots.front().tangent.z = 0;
  return knots;
}

// Also turns the whole about the center line so that it fits best.
std::optional<SweepFit::Reached> SweepFit::reach(Curve& curve, const std::vector<glm::dvec3>& drawn) const {
  // Thin: whether the part folds is asked in the end.
  ArcChain arcs;
  const glm::ivec3 thin(1, sweep_.size.y, 1);
  if (!makeArcs(knotsOf(curve), thin, 0, kArcTolerance, arcs)) return std::nullopt;
  const glm::dmat3 frame = curve.frame();
  const glm::dvec3 thin_corner(0.5, 0, 0.5), corner = sweep_.corner();
  Reached out;
  std::vector<glm::dvec3> across;
  double cosine = 0, sine = 0;
  for (std::size_t i = 0; i < points_.size(); ++i) {
    const glm::dmat4x3 section(sectionAt(arcs, points_[i].straight.y));
    const glm::dvec3 straight(points_[i].straight), along = frame * section[1];
    const glm::dvec3 r =
        frame * ((straight.x - corner.x) * section[0] + (straight.z - corner.z) * section[2]);
    out.centers.push_back(curve.places[0] + frame * (section[3] - thin_corner));
    out.along.push_back(along);
    across.push_back(r);
    const glm::dvec3 to = drawn[i] - out.centers.back();
    cosine += points_[i].area * (glm::dot(r, to) - glm::dot(r, along) * glm::dot(along, to));
    sine += points_[i].area * glm::dot(glm::cross(along, r), to);
  }
  const double length = std::hypot(cosine, sine);
  if (length > 0) {
    cosine /= length;
    sine /= length;
    curve.x = cosine * frame[0] + sine * glm::cross(frame[1], frame[0]);
  } else {
    cosine = 1;
  }
  for (std::size_t i = 0; i < points_.size(); ++i) {
    out.places.push_back(out.centers[i] + cosine * across[i] + sine * glm::cross(out.along[i], across[i]));
    const glm::dvec3 off = drawn[i] - out.places[i];
    out.error += points_[i].area * glm::dot(off, off);
  }
  return out;
}

// Gauss and Newton: as if sections turned with the center line alone.
SweepFit::Curve SweepFit::step(const Curve& curve, const Reached& reached,
                               const std::vector<glm::dvec3>& drawn, double stiffness) const {
  const std::size_t count = curve.places.size();
  NormalEquations equations(6 * count);
  for (std::size_t i = 0; i < points_.size(); ++i) {
    const Point& point = points_[i];
    const double t = point.t, t2 = t * t, t3 = t2 * t;
    const double width = static_cast<double>(sweep_.knots[point.span + 1].at) -
                         static_cast<double>(sweep_.knots[point.span].at);
    // Of the place and the slope of both knots: what a unit does to the center, and to its derivative by t.
    const double values[4] = {2 * t3 - 3 * t2 + 1, (t3 - 2 * t2 + t) * width, 3 * t2 - 2 * t3,
                              (t3 - t2) * width};
    const double slopes[4] = {6 * t2 - 6 * t, (3 * t2 - 4 * t + 1) * width, 6 * t - 6 * t2,
                              (3 * t2 - 2 * t) * width};
    const glm::dvec3& along = reached.along[i];
    const glm::dvec3 across = reached.places[i] - reached.centers[i];
    const double speed =
        std::max(glm::distance(curve.places[point.span], curve.places[point.span + 1]), 1e-6);
    std::array<glm::dmat3, 4> effects;
    for (int k = 0; k < 4; ++k)
      effects[static_cast<std::size_t>(k)] =
          values[k] * glm::dmat3(1) - slopes[k] / speed * glm::outerProduct(along, across);
    equations.add(6 * point.span, effects, drawn[i] - reached.places[i], point.area);
  }
  // Weakly towards no change: knots beyond the surface stay.
  constexpr double kStay = 1e-3;
  for (std::size_t k = 0; k < count; ++k) {
    const double before = k > 0 ? static_cast<double>(sweep_.knots[k - 1].at) : 0;
    const double after = k + 1 < count ? static_cast<double>(sweep_.knots[k + 1].at) : 1;
    equations.damp(6 * k, kStay * area_ / static_cast<double>(count));
    equations.damp(6 * k + 3,
                   kStay * area_ / static_cast<double>(count) * (after - before) * (after - before));
  }
  // The integral of the squared second derivative of each span, so that thickness over radius of curvature
  // costs as much as an equal distance in voxels.
  const double ratio = 0.5 * std::max(sweep_.size.x, sweep_.size.z) / (sweep_.height() * sweep_.height());
  for (std::size_t k = 0; k + 1 < count && stiffness > 0; ++k) {
    const double width =
        static_cast<double>(sweep_.knots[k + 1].at) - static_cast<double>(sweep_.knots[k].at);
    const double weight = stiffness * area_ * ratio * ratio / width;
    const glm::dmat3 one(1);
    equations.add(6 * k, {glm::dmat3(0), -one, glm::dmat3(0), one}, curve.slopes[k] - curve.slopes[k + 1],
                  weight);
    const double to_slope = std::sqrt(12.0) / width, half = 0.5 * std::sqrt(12.0);
    equations.add(
        6 * k, {-to_slope * one, -half * one, to_slope * one, -half * one},
        half * (curve.slopes[k] + curve.slopes[k + 1]) - to_slope * (curve.places[k + 1] - curve.places[k]),
        weight);
  }
  const std::vector<double> change = equations.solve();
  Curve next = curve;
  for (std::size_t k = 0; k < count; ++k)
    for (int axis = 0; axis < 3; ++axis) {
      next.places[k][axis] += change[6 * k + static_cast<std::size_t>(axis)];
      next.slopes[k][axis] += change[6 * k + 3 + static_cast<std::size_t>(axis)];
    }
  return next;
}

std::optional<SweepFit::Curve> SweepFit::improve(Curve curve, const std::vector<glm::dvec3>& drawn,
                                                 double stiffness) const {
  constexpr int kRounds = 6;
  constexpr double kEnough = 0.99;
  std::optional<Reached> reached = reach(curve, drawn);
  for (int round = 0; round < kRounds && reached; ++round) {
    Curve next = step(curve, *reached, drawn, stiffness);
    std::optional<Reached> there = reach(next, drawn);
    // Stiffer than it was at first, the curve may get farther away.
    if (!there || (there->error >= reached->error && (stiffness == 0 || round > 1))) break;
    const bool enough = there->error > kEnough * reached->error;
    curve = std::move(next);
    reached = std::move(there);
    if (enough && round > 1) break;
  }
  if (!reached) return std::nullopt;
  return curve;
}

bool SweepFit::pose(const SkinMoments& moments, std::size_t moment, double stiffness, SkinPose& pose) const {
  const std::vector<glm::dvec3> wanted = drawn(moments, moment);
  Curve curve = begin(wanted);
  const std::optional<Curve> found = improve(curve, wanted, stiffness);
  if (found) curve = *found;
  pose.knots = knotsOf(curve);
  const glm::dmat3 turn = curve.frame();
  const glm::dvec3 corner = sweep_.corner();
  // In part space the first knot goes from `corner` to its place; in skin space that is the same turn, seen
  // along other axes.
  const glm::dmat3 axes = linearOf(sweep_.place), spun = axes * turn * glm::inverse(axes);
  const glm::dvec3 from = sweep_.toSkin(corner), to = sweep_.toSkin(curve.places[0]);
  pose.motion = rigid(spun, to - spun * from);
  return !found || !checkSweep(pose.knots, sweep_.size + kSpare);
}

SweepFit::Poses SweepFit::poses(const SkinMoments& moments, int threads) const {
  constexpr double kStiffest = 30;
  Poses out;
  out.of_moments.resize(moments.size());
  for (const double stiffness : {0.0, 0.1, 0.3, 1.0, 3.0, 10.0, kStiffest}) {
    std::vector<std::uint8_t> folds(moments.size(), 0);
    std::atomic<bool> too_soft{false};  // then the others need no answer
    parallelRanges(moments.size(), 1, threads, [&](std::size_t begin, std::size_t end) {
      for (std::size_t t = begin; t < end && !too_soft; ++t) {
        folds[t] = pose(moments, t, stiffness, out.of_moments[t]);
        if (folds[t] && stiffness < kStiffest) too_soft = true;
      }
    });
    out.folding = static_cast<std::size_t>(std::find(folds.begin(), folds.end(), 1) - folds.begin());
    if (!out.fold()) break;
  }
  return out;
}

double SweepFit::meanSquare(const SkinPose& pose, const SkinMoments& moments, std::size_t moment) const {
  const PosedSweep posed(sweep_, pose);
  double sum = 0;
  for (const Point& point : points_) {
    const glm::dvec3 off = posed.at(point.straight) - skinnedPoint(samples_, point.sample, moments, moment);
    sum += point.area * glm::dot(off, off);
  }
  return sum / area_;
}

NormalEquations::NormalEquations(std::size_t unknowns)
    : unknowns_(unknowns), lower_(unknowns * kBand, 0), right_(unknowns, 0) {}

void NormalEquations::add(std::size_t first, const std::array<glm::dmat3, 4>& effects,
                          const glm::dvec3& wanted, double weight) {
  for (std::size_t a = 0; a < 4; ++a) {
    const glm::dmat3 back = weight * glm::transpose(effects[a]);
    const glm::dvec3 right = back * wanted;
    for (int i = 0; i < 3; ++i) right_[first + 3 * a + static_cast<std::size_t>(i)] += right[i];
    for (std::size_t b = 0; b <= a; ++b) {
      const glm::dmat3 block = back * effects[b];
      for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j) {
          const std::size_t row = first + 3 * a + static_cast<std::size_t>(i),
                            column = first + 3 * b + static_cast<std::size_t>(j);
          if (column <= row) at(row, column) += block[j][i];
        }
    }
  }
}

void NormalEquations::damp(std::size_t first, double weight) {
  for (std::size_t i = first; i < first + 3; ++i) at(i, i) += weight;
}

std::vector<double> NormalEquations::solve() const {
  NormalEquations factor = *this;
  for (std::size_t i = 0; i < unknowns_; ++i) {
    const std::size_t low = i + 1 >= kBand ? i + 1 - kBand : 0;
    for (std::size_t j = low; j <= i; ++j) {
      double sum = factor.at(i, j);
      for (std::size_t k = std::max(low, j + 1 >= kBand ? j + 1 - kBand : 0); k < j; ++k)
        sum -= factor.at(i, k) * factor.at(j, k);
      if (i != j)
        factor.at(i, j) = sum / factor.at(j, j);
      else if (sum > 0)
        factor.at(i, i) = std::sqrt(sum);
      else
        return std::vector<double>(unknowns_, 0);
    }
  }
  std::vector<double> x = right_;
  for (std::size_t i = 0; i < unknowns_; ++i) {
    for (std::size_t k = i + 1 >= kBand ? i + 1 - kBand : 0; k < i; ++k) x[i] -= factor.at(i, k) * x[k];
    x[i] /= factor.at(i, i);
  }
  for (std::size_t i = unknowns_; i-- > 0;) {
    for (std::size_t k = i + 1; k < std::min(unknowns_, i + kBand); ++k) x[i] -= factor.at(k, i) * x[k];
    x[i] /= factor.at(i, i);
  }
  return x;
}

}  // namespace kelp::bake
