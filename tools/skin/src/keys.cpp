// SPDX-License-Identifier: MIT
#include "keys.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <numeric>
#include <utility>

#include "collapse.h"
#include "rigid.h"

namespace kelp::bake {
namespace {

using Track = RigDescription::Track;

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

// What a part does within its pivot at all times.
struct Motion {
  std::vector<glm::dquat> turns;  // neighbours have one sign
  std::vector<glm::dvec3> shifts;
};

Motion motionAbout(const std::vector<glm::dmat4x3>& local, const glm::dvec3& pivot) {
  Motion motion;
  for (const glm::dmat4x3& m : local) {
    glm::dquat q = quaternionOf(linearOf(m));
    if (motion.turns.empty() ? q.w < 0 : glm::dot(q, motion.turns.back()) < 0)
      q = glm::dquat(-q.w, -q.x, -q.y, -q.z);
    motion.turns.push_back(q);
    motion.shifts.push_back(m * glm::dvec4(pivot, 1) - pivot);
  }
  return motion;
}

// Which of the times get a key: keys are inserted where the error is worst until it is small everywhere, then
// those that are not needed are taken out. error(i, a, b) is that at time i between keys at a and b; if a
// equals b, the value is the same all the time.
std::vector<std::size_t> chooseKeys(
    std::size_t count, double tolerance,
    const std::function<double(std::size_t, std::size_t, std::size_t)>& error) {
  const auto fits = [&](std::size_t from, std::size_t to, std::size_t a, std::size_t b) {
    for (std::size_t i = from; i <= to; ++i)
      if (error(i, a, b) > tolerance) return false;
    return true;
  };
  const std::size_t last = count - 1;
  if (fits(0, last, last / 2, last / 2)) return {last / 2};
  struct Span {
    std::size_t a, b, worst;
    double error;
  };
  const auto spanOf = [&](std::size_t a, std::size_t b) {
    Span span{a, b, a, 0};
    for (std::size_t i = a + 1; i < b; ++i)
      if (const double its = error(i, a, b); its > span.error) {
        span.error = its;
        span.worst = i;
      }
    return span;
  };
  std::vector<std::size_t> keys{0, last};
  std::vector<Span> open{spanOf(0, last)};
  while (!open.empty()) {
    const Span span = open.back();
    open.pop_back();
    if (span.error <= tolerance) continue;
    keys.push_back(span.worst);
    open.push_back(spanOf(span.a, span.worst));
    open.push_back(spanOf(span.worst, span.b));
  }
  std::sort(keys.begin(), keys.end());
  for (std::size_t k = 1; k + 1 < keys.size();) {
    if (fits(keys[k - 1] + 1, keys[k + 1] - 1, keys[k - 1], keys[k + 1]))
      keys.erase(keys.begin() + static_cast<std::ptrdiff_t>(k));
    else
      ++k;
  }
  return keys;
}

double shareOf(const std::vector<float>& times, std::size_t i, std::size_t a, std::size_t b) {
  if (a == b) return 0;
  return (static_cast<double>(times[i]) - static_cast<double>(times[a])) /
         (static_cast<double>(times[b]) - static_cast<double>(times[a]));
}

// The keys of a part; `tolerance` for both tracks together, `of_turns` of it for the rotations alone.
struct KeyChoice {
  std::vector<std::size_t> turns, shifts;
  std::size_t size() const { return turns.size() + shifts.size(); }
};

KeyChoice chooseTracks(const Motion& motion, const std::vector<float>& times,
                       const std::vector<glm::dvec3>& points, double tolerance, double of_turns) {
  std::vector<glm::dmat3> matrices;
  for (const glm::dquat& turn : motion.turns) matrices.push_back(rotationOf(turn));
  const auto turnAt = [&](std::size_t i, std::size_t a, std::size_t b) {
    return rotationOf(slerpShort(motion.turns[a], motion.turns[b], shareOf(times, i, a, b)));
  };
  KeyChoice choice;
  choice.turns = chooseKeys(times.size(), of_turns, [&](std::size_t i, std::size_t a, std::size_t b) {
    const glm::dmat3 off = turnAt(i, a, b) - matrices[i];
    double worst = 0;
    for (const glm::dvec3& point : points) {
      const glm::dvec3 moved = off * point;
      worst = std::max(worst, glm::dot(moved, moved));
    }
    return std::sqrt(worst);
  });
  std::vector<glm::dmat3> offs;  // what the rotation's keys leave
  std::size_t k = 0;
  for (std::size_t i = 0; i < times.size(); ++i) {
    while (k + 1 < choice.turns.size() && choice.turns[k + 1] <= i) ++k;
    const std::size_t a = choice.turns[k], b = choice.turns[std::min(k + 1, choice.turns.size() - 1)];
    offs.push_back(turnAt(i, a, b) - matrices[i]);
  }
  choice.shifts = chooseKeys(times.size(), tolerance, [&](std::size_t i, std::size_t a, std::size_t b) {
    const glm::dvec3 off =
        motion.shifts[a] + shareOf(times, i, a, b) * (motion.shifts[b] - motion.shifts[a]) - motion.shifts[i];
    double worst = 0;
    for (const glm::dvec3& point : points) {
      const glm::dvec3 moved = offs[i] * point + off;
      worst = std::max(worst, glm::dot(moved, moved));
    }
    return std::sqrt(worst);
  });
  return choice;
}

// From the space of the samples, whose axes may be turned, to the soup's.
struct KeySpace {
  glm::dmat3 turn;  // soup <- units, a rotation
  double unit;      // in lengths of the soup
  explicit KeySpace(const SkinSpace& space)
      : turn(space.to_soup), unit(std::cbrt(std::abs(glm::determinant(glm::dmat3(space.to_soup))))) {
    turn /= unit;
  }
  glm::vec4 keyOf(const glm::dquat& q) const {
    const glm::dvec3 axis = turn * glm::dvec3(q.x, q.y, q.z);
    return glm::vec4(static_cast<float>(axis.x), static_cast<float>(axis.y), static_cast<float>(axis.z),
                     static_cast<float>(q.w));
  }
  glm::vec4 keyOf(const glm::dvec3& shift) const { return glm::vec4(glm::vec3(unit * (turn * shift)), 0); }
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

// The values of a linear track at a time: the keys around it.
struct Between {
  glm::vec4 a{0}, b{0};
  double share = 0;
};
Between valuesAt(const Track& track, double time) {
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

glm::dmat4x3 localAt(const RigDescription::Clip& clip, const glm::dvec3& pivot, const KeySpace& space,
                     double time) {
  glm::dquat turn(1, 0, 0, 0);
  glm::dvec3 shift(0);
  for (const Track& track : clip.tracks) {
    const Between at = valuesAt(track, time);
    if (track.target == Target::kPartRotation)
      turn = slerpShort(space.turnOf(at.a), space.turnOf(at.b), at.share);
    else
      shift = glm::mix(space.shiftOf(at.a), space.shiftOf(at.b), at.share);
  }
  const glm::dmat3 rotation = rotationOf(turn);
  return rigid(rotation, pivot + shift - rotation * pivot);
}

// The fitted motions of all parts: [part][time].
std::vector<std::vector<glm::dmat4x3>> fitParts(const SkinSamples& samples, const SkinMoments& moments,
                                                const SkinLabels& labels,
                                                const std::vector<std::vector<std::uint32_t>>& members) {
  std::vector<std::vector<glm::dmat4x3>> motions;
  for (std::size_t p = 0; p < members.size(); ++p)
    motions.push_back(fitRigid(samples, moments, members[p], labels.joints[p]));
  return motions;
}

}  // namespace

std::vector<RigDescription::Clip> makeSkinKeys(const SkinSamples& samples, const SourceSkin& skin,
                                               std::uint32_t clip, const SkinSpace& space,
                                               const SkinLabels& labels, const PartTree& tree,
                                               double tolerance) {
  const std::vector<float>& times = skin.clips[clip].times;
  const SkinMoments moments =
      momentsAt(skin, clip, std::vector<double>(times.begin(), times.end()), space, 1);
  const std::vector<std::vector<std::uint32_t>> members = labels.members();
  const std::vector<std::vector<glm::dmat4x3>> fitted = fitParts(samples, moments, labels, members);
  const KeySpace key_space(space);
  std::vector<std::vector<glm::dmat4x3>> reduced(members.size());  // as the keys move the parts
  std::vector<RigDescription::Clip> clips;
  for (std::size_t p = 0; p < members.size(); ++p) {
    std::vector<glm::dmat4x3> local = fitted[p];
    const auto* parent = tree.parents[p] < 0 ? nullptr : &reduced[static_cast<std::size_t>(tree.parents[p])];
    if (parent)
      for (std::size_t t = 0; t < local.size(); ++t) local[t] = compose(inverseRigid((*parent)[t]), local[t]);
    const Motion motion = motionAbout(local, tree.pivots[p]);
    const std::vector<glm::dvec3> points = outermost(samples, members[p], tree.pivots[p]);
    RigDescription::Clip best;
    // The outermost points stand for all; where they do not quite, the tolerance is less.
    for (double most = 0.98 * tolerance;; most *= 0.8) {
      KeyChoice choice;
      for (const double share : {0.8, 0.5, 0.25}) {
        KeyChoice other = chooseTracks(motion, times, points, most, share * most);
        if (choice.size() == 0 || other.size() < choice.size()) choice = std::move(other);
      }
      best = {skin.clips[clip].name, skin.clips[clip].duration, {}, {}};
      const bool turns = choice.turns.size() > 1 || std::abs(motion.turns[choice.turns[0]].w) < 1 - 1e-14;
      const bool shifts = choice.shifts.size() > 1 || glm::length(motion.shifts[choice.shifts[0]]) > 1e-6;
      addTrack(best, Target::kPartTranslation, choice.shifts, times, motion.shifts, key_space, !shifts);
      addTrack(best, Target::kPartRotation, choice.turns, times, motion.turns, key_space, !turns);
      reduced[p].clear();
      double worst = 0;
      for (std::size_t t = 0; t < times.size(); ++t) {
        glm::dmat4x3 pose = localAt(best, tree.pivots[p], key_space, static_cast<double>(times[t]));
        if (parent) pose = compose((*parent)[t], pose);
        const glm::dmat4x3 off = pose - fitted[p][t];
        for (const std::uint32_t i : members[p])
          worst = std::max(worst, glm::length(off * glm::dvec4(samples.positions[i], 1)));
        reduced[p].push_back(pose);
      }
      if (worst <= tolerance || most < 0.1 * tolerance) break;
    }
    clips.push_back(std::move(best));
  }
  return clips;
}

std::vector<glm::dmat4x3> posesOfKeys(const std::vector<RigDescription::Clip>& clips, const PartTree& tree,
                                      const SkinSpace& space, double time) {
  const KeySpace key_space(space);
  std::vector<glm::dmat4x3> poses;
  for (std::size_t p = 0; p < clips.size(); ++p) {
    glm::dmat4x3 pose = localAt(clips[p], tree.pivots[p], key_space, time);
    if (tree.parents[p] >= 0) pose = compose(poses[static_cast<std::size_t>(tree.parents[p])], pose);
    poses.push_back(pose);
  }
  return poses;
}

}  // namespace kelp::bake
