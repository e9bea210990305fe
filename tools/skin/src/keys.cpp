// SPDX-License-Identifier: MIT
#include "keys.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include "collapse.h"
#include "kelp/import/core/source_model.h"
#include "key_choice.h"
#include "rigid.h"
#include "sweep.h"
#include "sweep_fit.h"

namespace kelp::bake {
namespace {

using Track = RigDescription::Track;

constexpr double kKnotRounding = 1.0 / 64;  // voxels

// The values of a linear track at a time: the keys around it.
struct Between {
  glm::vec4 a{0}, b{0};
  double share = 0;
};

Between valuesAt(const RigDescription::Track& track, double time) {
  const auto after = std::upper_bound(
      track.keys.begin(), track.keys.end(), time,
      [](double t, const RigDescription::Key& key) { return t < static_cast<double>(key.time); });
  if (after == track.keys.begin()) return {track.keys.front().value, track.keys.front().value, 0};
  if (after == track.keys.end()) return {track.keys.back().value, track.keys.back().value, 0};
  const RigDescription::Key& before = *(after - 1);
  return {before.value, after->value,
          (time - static_cast<double>(before.time)) /
              (static_cast<double>(after->time) - static_cast<double>(before.time))};
}

// False for a track that moves the part.
bool movesKnots(const RigDescription::Track& track) {
  return track.target == Target::kKnotOffset || track.target == Target::kKnotTangent;
}

// Adds tracks that keep each knot, and the section there, within `tolerance` voxels of the poses at the
// times.
void addKnotTracks(const SkinSweep& sweep, const std::vector<SkinPose>& poses,
                   const std::vector<float>& times, double tolerance, RigDescription::Clip& clip) {
  const double radius = 0.5 * std::max(sweep.size.x, sweep.size.z);
  for (std::size_t k = 0; k < sweep.knots.size(); ++k)
    for (const Target target : {Target::kKnotOffset, Target::kKnotTangent}) {
      // The most that a unit of the value moves: the knot, or the sides of its section.
      const double reach = target == Target::kKnotOffset ? sweep.height() : radius;
      std::vector<glm::dvec3> values;
      double most = 0;
      for (const SkinPose& pose : poses) {
        const glm::dvec3 exact(target == Target::kKnotOffset
                                   ? pose.knots[k].position - sweep.knots[k].position
                                   : pose.knots[k].tangent - sweep.knots[k].tangent);
        glm::dvec3& value = values.emplace_back();
        for (int axis = 0; axis < 3; ++axis) value[axis] = roundedKey(exact[axis], kKnotRounding / reach);
        most = std::max(most, reach * glm::length(values.back()));
      }
      if (most == 0) continue;
      RigDescription::Track track;
      track.knot = static_cast<int>(k);
      track.target = target;
      const auto error = [&](std::size_t i, std::size_t a, std::size_t b) {
        return reach * glm::distance(glm::mix(values[a], values[b], shareOf(times, i, a, b)), values[i]);
      };
      const std::vector<std::size_t> keys = chooseKeys(times.size(), tolerance, error);
      for (const std::size_t i : keys)
        track.keys.push_back(
            {keys.size() == 1 ? 0.0f : times[i], glm::vec4(glm::vec3(values[i]), 0), {}, {}});
      clip.tracks.push_back(std::move(track));
    }
}

// The knots at a time of the clip.
std::vector<Knot> knotsAt(const SkinSweep& sweep, const RigDescription::Clip& clip, double time) {
  std::vector<Knot> knots = sweep.knots;
  for (const RigDescription::Track& track : clip.tracks) {
    if (!movesKnots(track)) continue;
    const Between at = valuesAt(track, time);
    const glm::vec3 value(glm::mix(at.a, at.b, static_cast<float>(at.share)));
    Knot& knot = knots[static_cast<std::size_t>(track.knot)];
    (track.target == Target::kKnotOffset ? knot.position : knot.tangent) += value;
  }
  return knots;
}

// The samples of a part that are farthest out, in many directions, seen from its pivot. A rigid motion moves
// none much farther than these.
std::vector<glm::dvec3> outermost(const SkinSamples& samples, const std::vector<std::uint32_t>& members,
                                  const glm::dvec3& pivot) {
  std::vector<std::uint32_t> found;
  constexpr int kDirections = 40;
  for (int k = 0; k < kDirections; ++k) {
    // A spiral over the sphere.
    const double y = 1 - (k + 0.5) * 2 / kDirections, round = std::sqrt(1 - y * y),
                 turn = 2.399963229728653 * k;
    const glm::dvec3 direction(round * std::cos(turn), y, round * std::sin(turn));
    std::uint32_t best = members.front();
    for (const std::uint32_t i : members)
      if (glm::dot(direction, samples.positions[i]) > glm::dot(direction, samples.positions[best])) best = i;
    found.push_back(best);
  }
  std::sort(found.begin(), found.end());
  found.erase(std::unique(found.begin(), found.end()), found.end());
  std::vector<glm::dvec3> points;
  for (const std::uint32_t i : found) points.push_back(samples.positions[i] - pivot);
  return points;
}

constexpr double kKeyRounding = 1.0 / 64;  // units

// From the space of the samples, whose axes may be turned, to the soup's.
struct KeySpace {
  glm::dmat3 turn;  // soup <- units, a rotation
  double unit;      // in lengths of the soup
  double voxels;    // a unit's
  explicit KeySpace(const SkinSpace& space)
      : turn(space.to_soup),
        unit(std::cbrt(std::abs(glm::determinant(glm::dmat3(space.to_soup))))),
        voxels(space.voxels) {
    turn /= unit;
  }
  // Rounded: turns to half of 1/128 at the far end of the box, shifts to half of 1/128 of a unit.
  glm::vec4 keyOf(const glm::dquat& q) const {
    const glm::dvec3 axis = turn * glm::dvec3(q.x, q.y, q.z);
    const auto round = [](double v) { return roundedKey(v, kKeyRounding / kSkinSide); };
    return {round(axis.x), round(axis.y), round(axis.z), round(q.w)};
  }
  glm::vec4 keyOf(const glm::dvec3& shift) const {
    const glm::dvec3 at = unit * (turn * shift);
    const auto round = [&](double v) { return roundedKey(v, kKeyRounding * unit); };
    return {round(at.x), round(at.y), round(at.z), 0};
  }
  // A factor, less one, as rigs have it.
  glm::vec4 keyOf(double scale) const {
    const float key = roundedKey(scale - 1, kKeyRounding / kSkinSide);
    return {key, key, key, 0};
  }
  glm::dquat turnOf(const glm::vec4& key) const {
    const glm::dvec3 axis = glm::transpose(turn) * glm::dvec3(glm::vec3(key));
    return {static_cast<double>(key.w), axis.x, axis.y, axis.z};
  }
  glm::dvec3 shiftOf(const glm::vec4& key) const {
    return glm::transpose(turn) * glm::dvec3(glm::vec3(key)) / unit;
  }
};

// A track that changes nothing is left out.
template <class Values>
void addTrack(RigDescription::Clip& clip, Target target, const std::vector<std::size_t>& keys,
              const std::vector<float>& times, const Values& values, const KeySpace& space, bool still) {
  if (still) return;
  Track track;
  track.target = target;
  for (const std::size_t i : keys)
    track.keys.push_back({keys.size() == 1 ? 0.0f : times[i], space.keyOf(values[i]), {}, {}});
  clip.tracks.push_back(std::move(track));
}

glm::dmat4x3 localAt(const RigDescription::Clip& clip, const glm::dvec3& pivot, const KeySpace& space,
                     double time) {
  glm::dquat turn(1, 0, 0, 0);
  glm::dvec3 shift(0);
  double scale = 1;
  for (const Track& track : clip.tracks) {
    const Between at = valuesAt(track, time);
    if (movesKnots(track)) continue;
    if (track.target == Target::kPartRotation)
      turn = slerpShort(space.turnOf(at.a), space.turnOf(at.b), at.share);
    else if (track.target == Target::kPartScale)
      scale = 1 + glm::mix(static_cast<double>(at.a.x), static_cast<double>(at.b.x), at.share);
    else
      shift = glm::mix(space.shiftOf(at.a), space.shiftOf(at.b), at.share);
  }
  const glm::dmat3 rotation = scale * rotationOf(turn);
  return rigid(rotation, pivot + shift - rotation * pivot);
}

// The poses of a part that follow its samples best, at all times.
std::vector<SkinPose> fitPart(const SkinSamples& samples, const SkinMoments& moments,
                              const std::vector<std::uint32_t>& members, std::uint32_t joint,
                              const std::optional<SkinSweep>& sweep) {
  if (!sweep) {
    std::vector<SkinPose> poses(moments.size());
    const std::vector<glm::dmat4x3> motions = fitMotions(samples, moments, members, joint);
    for (std::size_t t = 0; t < motions.size(); ++t) poses[t].motion = motions[t];
    return poses;
  }
  // If they fold, so does the clip, and the part will be rigid.
  return SweepFit(samples, *sweep, members).poses(moments, 1).of_moments;
}

// How far two poses of a part are apart: of rigid parts at the farthest of their samples, of swept ones at
// the farthest knot.
double apart(const SkinPose& a, const SkinPose& b, const SkinSamples& samples,
             const std::vector<std::uint32_t>& members, const std::optional<SkinSweep>& sweep) {
  double most = 0;
  if (!sweep) {
    const glm::dmat4x3 off = a.motion - b.motion;
    for (const std::uint32_t i : members)
      most = std::max(most, glm::length(off * glm::dvec4(samples.positions[i], 1)));
    return most;
  }
  const auto placeOf = [&](const SkinPose& pose, std::size_t k) {
    const glm::dvec3 at = sweep->corner() + sweep->height() * glm::dvec3(pose.knots[k].position);
    return pose.motion * glm::dvec4(sweep->toSkin(at), 1);
  };
  for (std::size_t k = 0; k < a.knots.size(); ++k)
    most = std::max(most, glm::distance(placeOf(a, k), placeOf(b, k)));
  return most;
}

// The clip of one part.
class PartKeys {
 public:
  PartKeys(const SkinSamples& samples, const SourceSkin::Clip& clip, const SkinSpace& space,
           const std::vector<std::uint32_t>& members, const PartTree& tree, std::size_t part)
      : samples_(samples),
        clip_(clip),
        space_(space),
        members_(members),
        pivot_(tree.pivots[part]),
        sweep_(tree.sweeps[part]),
        points_(outermost(samples, members, pivot_)) {}

  // Keys that keep the part within `tolerance` of the wanted poses; `parents`: what it follows, rigid.
  // `reduced` becomes its poses by these keys.
  RigDescription::Clip make(const std::vector<SkinPose>& wanted, const std::vector<glm::dmat4x3>& parents,
                            double tolerance, std::vector<SkinPose>& reduced) const {
    std::vector<glm::dmat4x3> local;
    for (std::size_t t = 0; t < wanted.size(); ++t)
      local.push_back(compose(inverseRigid(parents[t]), wanted[t].motion));
    const RigidMotion motion = motionAbout(local, pivot_);
    // The outermost points stand for all, and the first section for a chain; where they do not quite, the
    // tolerance is less.
    for (double most = 0.98 * tolerance;; most *= 0.8) {
      RigDescription::Clip clip = keysOf(motion, (sweep_ ? 0.5 : 1) * most);
      if (sweep_) addKnotTracks(*sweep_, wanted, clip_.times, 0.8 * most * space_.voxels, clip);
      reduced.clear();
      double worst = 0;
      for (std::size_t t = 0; t < wanted.size(); ++t) {
        const double time = static_cast<double>(clip_.times[t]);
        SkinPose& pose = reduced.emplace_back();
        pose.motion = compose(parents[t], localAt(clip, pivot_, space_, time));
        if (sweep_) pose.knots = knotsAt(*sweep_, clip, time);
        worst = std::max(worst, apart(pose, wanted[t], samples_, members_, sweep_));
      }
      if (worst <= tolerance || most < 0.1 * tolerance) return clip;
    }
  }

 private:
  RigDescription::Clip keysOf(const RigidMotion& motion, double most) const {
    KeyChoice choice;
    for (const double share : {0.8, 0.5, 0.25}) {
      KeyChoice other = chooseTracks(motion, clip_.times, points_, most, share * most);
      if (choice.size() == 0 || other.size() < choice.size()) choice = std::move(other);
    }
    RigDescription::Clip clip{clip_.name, clip_.duration, {}, {}};
    const bool turns = choice.turns.size() > 1 || std::abs(motion.turns[choice.turns[0]].w) < 1 - 1e-14;
    const bool shifts = choice.shifts.size() > 1 || glm::length(motion.shifts[choice.shifts[0]]) > 1e-6;
    addTrack(clip, Target::kPartTranslation, choice.shifts, clip_.times, motion.shifts, space_, !shifts);
    addTrack(clip, Target::kPartRotation, choice.turns, clip_.times, motion.turns, space_, !turns);
    const bool scales = choice.scales.size() > 1 || motion.scales[choice.scales[0]] != 1;
    addTrack(clip, Target::kPartScale, choice.scales, clip_.times, motion.scales, space_, !scales);
    return clip;
  }

  const SkinSamples& samples_;
  const SourceSkin::Clip& clip_;
  const KeySpace space_;
  const std::vector<std::uint32_t>& members_;
  const glm::dvec3 pivot_;
  const std::optional<SkinSweep>& sweep_;
  const std::vector<glm::dvec3> points_;
};

}  // namespace

std::vector<RigDescription::Clip> makeSkinKeys(const SkinSamples& samples, const SourceSkin& skin,
                                               std::uint32_t clip, const SkinSpace& space,
                                               const SkinLabels& labels, const PartTree& tree,
                                               double tolerance) {
  const std::vector<float>& times = skin.clips[clip].times;
  const SkinMoments moments =
      momentsAt(skin, clip, std::vector<double>(times.begin(), times.end()), space, 1);
  const std::vector<std::vector<std::uint32_t>> members = labels.members();
  std::vector<std::vector<SkinPose>> reduced(members.size());  // as the keys move the parts
  std::vector<RigDescription::Clip> clips;
  for (std::size_t p = 0; p < members.size(); ++p) {
    const std::vector<SkinPose> wanted =
        fitPart(samples, moments, members[p], labels.joints[p], tree.sweeps[p]);
    std::vector<glm::dmat4x3> parents(times.size(), glm::dmat4x3(1));
    if (tree.parents[p] >= 0)
      for (std::size_t t = 0; t < times.size(); ++t)
        parents[t] = motionFromParent(tree, p, reduced[static_cast<std::size_t>(tree.parents[p])][t]);
    const PartKeys keys(samples, skin.clips[clip], space, members[p], tree, p);
    clips.push_back(keys.make(wanted, parents, tolerance, reduced[p]));
  }
  return clips;
}

std::vector<SkinPose> posesOfKeys(const std::vector<RigDescription::Clip>& clips, const PartTree& tree,
                                  const SkinSpace& space, double time) {
  const KeySpace key_space(space);
  std::vector<SkinPose> poses;
  for (std::size_t p = 0; p < clips.size(); ++p) {
    SkinPose pose{localAt(clips[p], tree.pivots[p], key_space, time), {}};
    if (tree.parents[p] >= 0)
      pose.motion =
          compose(motionFromParent(tree, p, poses[static_cast<std::size_t>(tree.parents[p])]), pose.motion);
    if (tree.sweeps[p]) pose.knots = knotsAt(*tree.sweeps[p], clips[p], time);
    poses.push_back(std::move(pose));
  }
  return poses;
}

}  // namespace kelp::bake
