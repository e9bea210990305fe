// SPDX-License-Identifier: MIT
#include "sweep.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "rigid.h"

namespace kelp::bake {
namespace {

constexpr double kEnds = 4;            // units that the part goes on beyond its samples, for shared voxels
constexpr double kMostLayers = 32768;  // voxels along a part: joints may be anywhere
constexpr double kMostOfBox = 0.25;    // of the cube around the whole: a larger straight part stays rigid
constexpr double kNearJoints = 2;      // units: the line passes by joints that are nearer to the one before
constexpr double kBeside = 1;          // voxels beside the samples

// A line through joints; it goes on beyond both ends.
class Polyline {
 public:
  explicit Polyline(std::vector<glm::dvec3> points) : points_(std::move(points)) {
    starts_.push_back(0);
    for (std::size_t i = 1; i < points_.size(); ++i)
      starts_.push_back(starts_.back() + glm::distance(points_[i - 1], points_[i]));
  }
  double startOf(std::size_t point) const { return starts_[point]; }
  // The length along the line up to the place nearest to `at`.
  double lengthTo(const glm::dvec3& at) const {
    double nearest = std::numeric_limits<double>::infinity(), length = 0;
    for (std::size_t i = 0; i + 1 < points_.size(); ++i) {
      const glm::dvec3 bone = directionOf(i);
      const double most = starts_[i + 1] - starts_[i];
      double along = glm::dot(at - points_[i], bone);
      if (i > 0) along = std::max(along, 0.0);
      if (i + 2 < points_.size()) along = std::min(along, most);
      const double distance = glm::distance(at, points_[i] + along * bone);
      if (distance >= nearest) continue;
      nearest = distance;
      length = starts_[i] + along;
    }
    return length;
  }
  glm::dvec3 at(double length) const {
    const std::size_t i = boneAt(length);
    return points_[i] + (length - starts_[i]) * directionOf(i);
  }
  glm::dvec3 direction(double length) const { return directionOf(boneAt(length)); }

 private:
  std::size_t boneAt(double length) const {
    std::size_t i = 0;
    while (i + 2 < points_.size() && starts_[i + 1] <= length) ++i;
    return i;
  }
  glm::dvec3 directionOf(std::size_t i) const { return glm::normalize(points_[i + 1] - points_[i]); }

  std::vector<glm::dvec3> points_;
  std::vector<double> starts_;
};

// Where knots are.
std::vector<double> stationsOf(double low, double high, std::size_t count) {
  std::vector<double> stations;
  for (std::size_t k = 0; k < count; ++k)
    stations.push_back(low + (high - low) * static_cast<double>(k) / static_cast<double>(count - 1));
  return stations;
}

// The middles of the surface around the line there.
std::vector<glm::dvec3> middlesOf(const SkinSamples& samples, const std::vector<std::uint32_t>& members,
                                  const std::vector<double>& lengths, const Polyline& line,
                                  const std::vector<double>& stations) {
  constexpr double kLeastWindow = 4;
  const std::size_t count = stations.size();
  std::vector<glm::dvec3> offsets(count, glm::dvec3(0));
  std::vector<bool> known(count, false);
  for (std::size_t k = 1; k + 1 < count; ++k) {
    const double window = std::max(kLeastWindow, 0.5 * (stations[k + 1] - stations[k - 1]));
    double sum = 0;
    for (std::size_t i = 0; i < members.size(); ++i) {
      const double weight =
          samples.areas[members[i]] * std::max(0.0, 1 - std::abs(lengths[i] - stations[k]) / window);
      sum += weight;
      offsets[k] += weight * (samples.positions[members[i]] - line.at(lengths[i]));
    }
    known[k] = sum > 0;
    if (!known[k]) continue;
    offsets[k] /= sum;
    const glm::dvec3 along = line.direction(stations[k]);
    offsets[k] -= glm::dot(offsets[k], along) * along;
  }
  offsets.front() = offsets[1];
  offsets.back() = offsets[count - 2];
  std::vector<glm::dvec3> middles;
  for (std::size_t k = 0; k < count; ++k) middles.push_back(line.at(stations[k]) + offsets[k]);
  return middles;
}

// Catmull-Rom slopes by `at`; at the ends those of a curve that does not bend there.
std::vector<glm::dvec3> slopesOf(const std::vector<glm::dvec3>& points, const std::vector<double>& at) {
  const std::size_t count = points.size();
  const auto chord = [&](std::size_t k) { return (points[k + 1] - points[k]) / (at[k + 1] - at[k]); };
  std::vector<glm::dvec3> slopes(count);
  for (std::size_t k = 1; k + 1 < count; ++k) {
    const double before = at[k] - at[k - 1], after = at[k + 1] - at[k];
    slopes[k] = (chord(k - 1) * after + chord(k) * before) / (before + after);
  }
  slopes.front() = count > 2 ? 1.5 * chord(0) - 0.5 * slopes[1] : chord(0);
  slopes.back() = count > 2 ? 1.5 * chord(count - 2) - 0.5 * slopes[count - 2] : chord(0);
  return slopes;
}

// A rotation whose y column is the unit vector `along`.
glm::dmat3 frameAlong(const glm::dvec3& along) {
  glm::dvec3 x(0);
  const glm::dvec3 sizes = glm::abs(along);
  x[sizes.x <= sizes.y && sizes.x <= sizes.z ? 0 : sizes.z <= sizes.y ? 2 : 1] = 1;
  x = glm::normalize(x - glm::dot(x, along) * along);
  return {x, along, glm::cross(x, along)};
}

// The lengths of the arcs between knots, as sums from the first.
std::vector<double> lengthsAtKnots(const ArcChain& arcs, const std::vector<Knot>& knots, double height) {
  std::vector<double> lengths{0};
  double length = 0;
  std::size_t knot = 1;
  for (int i = 0; i < arcs.count; ++i) {
    length += 2 * static_cast<double>(arcs.arcs[i].half_length);
    const double y = static_cast<double>(arcs.joints[i + 1].y);
    if (i + 1 == arcs.count || (knot < knots.size() && y > (static_cast<double>(knots[knot].at) * height) -
                                                               1e-3 * height / kMaxArcs)) {
      lengths.push_back(length);
      ++knot;
    }
  }
  return lengths;
}

// Lays the knots along the points (skin space); false if the part folds.
bool layKnots(SkinSweep& sweep, const std::vector<glm::dvec3>& points, double voxels) {
  std::vector<double> lengths{0};
  for (std::size_t k = 1; k < points.size(); ++k)
    lengths.push_back(lengths.back() + voxels * glm::distance(points[k - 1], points[k]));
  for (int round = 0; round < 3; ++round) {
    if (!(lengths.back() < kMostLayers)) return false;
    sweep.size.y = static_cast<int>(std::ceil(lengths.back() - 1e-3));
    std::vector<double> at;
    for (const double length : lengths) at.push_back(length / lengths.back());
    const std::vector<glm::dvec3> slopes = slopesOf(points, at);
    const glm::dmat3 frame = frameAlong(glm::normalize(slopes.front()));
    const double to_heights = voxels / sweep.height();
    sweep.knots.clear();
    for (std::size_t k = 0; k < points.size(); ++k)
      sweep.knots.push_back({static_cast<float>(at[k]),
                             glm::vec3(to_heights * (glm::transpose(frame) * (points[k] - points[0]))),
                             glm::vec3(to_heights * (glm::transpose(frame) * slopes[k]))});
    sweep.knots.front().tangent.x = sweep.knots.front().tangent.z = 0;
    sweep.place = rigid(frame / voxels, points[0] - frame * sweep.corner() / voxels);
    if (!makeArcs(sweep.knots, sweep.size, 0, kArcTolerance, sweep.arcs)) return false;
    lengths = lengthsAtKnots(sweep.arcs, sweep.knots, sweep.height());
    if (lengths.size() != points.size()) return false;
  }
  return true;
}

}  // namespace

glm::dvec3 SkinSweep::toPart(const glm::dvec3& at) const {
  const glm::dmat3 linear = linearOf(place);
  return glm::transpose(linear) * (at - place[3]) / glm::dot(linear[0], linear[0]);
}

glm::vec3 SkinSweep::straightened(const glm::dvec3& at) const {
  const glm::vec3 point(at);
  if (const auto inside = unsweepPoint(arcs, size, point)) return *inside;
  glm::vec3 rest;
  float nearest = std::numeric_limits<float>::infinity();
  constexpr int kSections = 64;
  for (int i = 0; i <= kSections; ++i) {
    const float y = static_cast<float>(size.y) * static_cast<float>(i) / kSections;
    const glm::mat4x3 section = sectionAt(arcs, y);
    const glm::vec3 off = point - section[3];
    // Along the section's direction the part is not continued for free.
    const float along = glm::dot(off, section[1]), cost = glm::dot(off, off) + 8 * along * along;
    if (cost >= nearest) continue;
    nearest = cost;
    rest = {0.5f * static_cast<float>(size.x) + glm::dot(off, section[0]), y,
            0.5f * static_cast<float>(size.z) + glm::dot(off, section[2])};
  }
  return rest;
}

std::optional<SkinSweep> makeSweep(const SkinSamples& samples, const SourceSkin& skin, const SkinSpace& space,
                                   const std::vector<std::uint32_t>& members, const SkinChain& chain) {
  std::vector<glm::dvec3> points;
  for (const std::uint32_t joint : chain.joints) {
    const glm::dvec3 at(space.from_soup * glm::dvec4(skin.joints[joint].origin, 1));
    if (points.empty() || glm::distance(points.back(), at) >= kNearJoints) points.push_back(at);
  }
  if (points.size() < 2) return std::nullopt;
  const Polyline line(points);
  std::vector<double> lengths;
  double low = std::numeric_limits<double>::infinity(), high = -low;
  for (const std::uint32_t i : members) {
    lengths.push_back(line.lengthTo(samples.positions[i]));
    low = std::min(low, lengths.back());
    high = std::max(high, lengths.back());
  }
  const std::vector<double> stations = stationsOf(low - kEnds, high + kEnds, chain.knots);
  const std::vector<glm::dvec3> middles = middlesOf(samples, members, lengths, line, stations);
  SkinSweep sweep;
  sweep.size = {2, 1, 2};
  if (!layKnots(sweep, middles, space.voxels)) return std::nullopt;
  glm::vec2 most(0);
  for (const std::uint32_t i : members) {
    const glm::vec3 straight = sweep.straightened(sweep.toPart(samples.positions[i]));
    most = glm::max(most, glm::abs(glm::vec2(straight.x, straight.z) - 1.0f));
  }
  const double side = kSkinSide * space.voxels;
  const glm::dvec2 across = 2.0 * glm::dvec2(most) + 4.0;
  if (!(across.x * across.y * sweep.height() <= kMostOfBox * side * side * side)) return std::nullopt;
  sweep.size.x = 2 * static_cast<int>(std::ceil(static_cast<double>(most.x) + kBeside));
  sweep.size.z = 2 * static_cast<int>(std::ceil(static_cast<double>(most.y) + kBeside));
  if (!layKnots(sweep, middles, space.voxels)) return std::nullopt;
  return sweep;
}

PosedSweep::PosedSweep(const SkinSweep& sweep, const SkinPose& pose) : sweep_(sweep) {
  from_part_ = compose(pose.motion, sweep.place);
  ok_ = static_cast<bool>(makeArcs(pose.knots, sweep.size, 0, kArcTolerance, arcs_));
  if (!ok_) arcs_ = sweep.arcs;
}

glm::dvec3 PosedSweep::at(const glm::vec3& straight) const {
  return from_part_ * glm::dvec4(glm::dvec3(sweepPoint(arcs_, sweep_.size, straight)), 1);
}

glm::dmat4x3 PosedSweep::sectionMotion(double y) const {
  const auto height = static_cast<float>(y);
  const glm::dmat4x3 posed(sectionAt(arcs_, height)), rest(sectionAt(sweep_.arcs, height));
  // Of part space; then of skin space, in which it is the same turn.
  const glm::dmat4x3 step = compose(posed, inverseRigid(rest));
  const glm::dmat3 turn = linearOf(from_part_) * linearOf(step) * glm::inverse(linearOf(sweep_.place));
  const glm::dvec3 origin = glm::dvec3(rest[3]);
  const glm::dvec3 from = sweep_.toSkin(origin),
                   to = from_part_ * glm::dvec4(step * glm::dvec4(origin, 1), 1);
  return rigid(turn, to - turn * from);
}

}  // namespace kelp::bake
