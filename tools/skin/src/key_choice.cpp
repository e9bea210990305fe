// SPDX-License-Identifier: MIT
#include "key_choice.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace kelp::bake {
namespace {

using Track = RigDescription::Track;
using Indices = std::vector<std::size_t>;

// Keys are inserted where the error is worst until it is small everywhere, then those that are not needed are
// taken out. error(i, a, b) is that at time i between keys at a and b; if a equals b, the value is the same
// all the time.
template <class Error>
Indices chooseKeys(std::size_t count, double tolerance, const Error& error) {
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
  Indices keys{0, last};
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

// The greatest power of two that is not above `step`.
double powerBelow(double step) { return std::exp2(std::floor(std::log2(step))); }

double rounded(double value, double power) { return std::round(value / power) * power; }

glm::vec4 keyOf(const glm::dvec3& value, double power) {
  return {rounded(value.x, power), rounded(value.y, power), rounded(value.z, power), 0};
}

// A quaternion need not be quite unit: the fourth component is rounded more, and the others go with it.
glm::vec4 keyOf(const glm::dquat& q, double power) {
  constexpr double kNearUnit = 6e-4;
  double w = rounded(q.w, power), size = 1;
  for (double coarse = 0x1p-8; coarse > power; coarse *= 0.5) {
    const double near = rounded(q.w, coarse);
    if (std::abs(near - q.w) > kNearUnit * std::abs(q.w)) continue;
    w = near;
    size = near / q.w;
    break;
  }
  return {rounded(size * q.x, power), rounded(size * q.y, power), rounded(size * q.z, power), w};
}

glm::dquat quaternionOfKey(const glm::vec4& key) {
  return {static_cast<double>(key.w), static_cast<double>(key.x), static_cast<double>(key.y),
          static_cast<double>(key.z)};
}

// How far time i is on the way from time a to time b; 0 if these are one.
double shareOf(const std::vector<float>& times, std::size_t i, std::size_t a, std::size_t b) {
  if (a == b) return 0;
  return (static_cast<double>(times[i]) - static_cast<double>(times[a])) /
         (static_cast<double>(times[b]) - static_cast<double>(times[a]));
}

double sizeOf(const glm::dmat3& m) {
  return std::max({glm::length(m[0]), glm::length(m[1]), glm::length(m[2])});
}

class TrackChoice {
 public:
  TrackChoice(const KeyedMotion& motion, const std::vector<float>& times, double tolerance)
      : motion_(motion), times_(times), tolerance_(tolerance), offs_(motion.places.size(), glm::dvec3(0)) {
    for (std::size_t t = 0; t < times.size(); ++t) {
      const glm::dmat3 turn = rotationOf(motion.poses[t].rotation);
      glm::dvec3 scale = motion.poses[t].scale;
      spread_.push_back(motion.spread[t]);
      for (const std::size_t beside : {t > 0 ? t - 1 : t, std::min(t + 1, times.size() - 1)}) {
        // Between a time at which all is nothing and one beside it, it is half as large as there.
        const glm::dvec3 half = 0.5 * motion.poses[beside].scale;
        for (int axis = 0; axis < 3; ++axis)
          if (std::abs(half[axis]) > std::abs(scale[axis])) scale[axis] = half[axis];
        if (0.5 * sizeOf(motion.spread[beside]) > sizeOf(spread_[t]))
          spread_[t] = 0.5 * motion.spread[beside];
      }
      for (std::size_t i = 0; i < motion.points; ++i)
        turned_.push_back(turn * (scale * motion.places[t * motion.points + i]));
    }
  }

  std::vector<Track> make() {
    const double reach = std::max(motion_.reach(), 1e-6 * tolerance_), size = motion_.size();
    std::vector<Track> tracks;
    if (!(size > 0)) return tracks;
    const double turn_power = powerBelow(kOfTurns * kOfRounding * tolerance_ / (1.8 * reach));
    addTurns(std::min(turn_power, 0x1p-6), tracks);
    addScales(powerBelow(kOfScales * kOfRounding * tolerance_ / reach), tracks);
    addShifts(powerBelow(kOfShifts * tolerance_ / size), tracks);
    return tracks;
  }

 private:
  // The shares of the tolerance.
  static constexpr double kOfTurns = 0.95, kOfScales = 0.2, kOfShifts = 0.2, kOfRounding = 0.8;

  // How far the points are off at a time if each is off by off(i) in pivot space.
  template <class Off>
  double farthest(std::size_t t, const Off& off) const {
    double most = 0;
    for (std::size_t i = 0; i < motion_.points; ++i) {
      const glm::dvec3 moved = spread_[t] * off(i);
      most = std::max(most, glm::dot(moved, moved));
    }
    return std::sqrt(most);
  }

  void addTurns(double power, std::vector<Track>& tracks) {
    std::vector<glm::dquat> keys;
    for (const Trs& pose : motion_.poses) keys.push_back(quaternionOfKey(keyOf(pose.rotation, power)));
    // The rest of the turn; v is its axis, as long as the sine of half its angle.
    const auto off = [&](std::size_t t, const glm::dquat& turned, std::size_t i) {
      const glm::dquat rest = turned * glm::conjugate(motion_.poses[t].rotation);
      const glm::dvec3 v(rest.x, rest.y, rest.z),
          across = 2.0 * glm::cross(v, turned_[t * motion_.points + i]);
      return rest.w * across + glm::cross(v, across);
    };
    const auto turnAt = [&](std::size_t t, std::size_t a, std::size_t b) {
      return slerpShort(keys[a], keys[b], shareOf(times_, t, a, b));
    };
    const Indices chosen = choose(
        Target::kPartRotation, kOfTurns * tolerance_,
        [&](std::size_t t, std::size_t a, std::size_t b) {
          const glm::dquat turned = turnAt(t, a, b);
          return farthest(t, [&](std::size_t i) { return off(t, turned, i); });
        },
        [&](std::size_t t) {
          return farthest(t, [&](std::size_t i) { return off(t, glm::dquat(1, 0, 0, 0), i); });
        });
    keep(chosen, Target::kPartRotation, tracks,
         [&](std::size_t t) { return keyOf(motion_.poses[t].rotation, power); });
    eachTime(chosen, [&](std::size_t t, std::size_t a, std::size_t b, bool none) {
      const glm::dquat turned = none ? glm::dquat(1, 0, 0, 0) : turnAt(t, a, b);
      for (std::size_t i = 0; i < motion_.points; ++i) offs_[t * motion_.points + i] += off(t, turned, i);
    });
  }

  void addScales(double power, std::vector<Track>& tracks) {
    std::vector<glm::dvec3> keys;
    for (const Trs& pose : motion_.poses) keys.emplace_back(keyOf(pose.scale - 1.0, power));
    std::vector<glm::dmat3> turns;
    for (const Trs& pose : motion_.poses) turns.push_back(rotationOf(pose.rotation));
    const auto off = [&](std::size_t t, const glm::dvec3& scale, std::size_t i) {
      return turns[t] * ((scale + 1.0 - motion_.poses[t].scale) * motion_.places[t * motion_.points + i]);
    };
    const Indices chosen = choose(
        Target::kPartScale, kOfScales * tolerance_,
        [&](std::size_t t, std::size_t a, std::size_t b) {
          const glm::dvec3 scale = glm::mix(keys[a], keys[b], shareOf(times_, t, a, b));
          return farthest(t, [&](std::size_t i) { return off(t, scale, i); });
        },
        [&](std::size_t t) { return farthest(t, [&](std::size_t i) { return off(t, glm::dvec3(0), i); }); });
    keep(chosen, Target::kPartScale, tracks,
         [&](std::size_t t) { return keyOf(motion_.poses[t].scale - 1.0, power); });
    eachTime(chosen, [&](std::size_t t, std::size_t a, std::size_t b, bool none) {
      const glm::dvec3 scale = none ? glm::dvec3(0) : glm::mix(keys[a], keys[b], shareOf(times_, t, a, b));
      for (std::size_t i = 0; i < motion_.points; ++i) offs_[t * motion_.points + i] += off(t, scale, i);
    });
  }

  // They come last: what the others leave is looked at with them.
  void addShifts(double power, std::vector<Track>& tracks) {
    std::vector<glm::dvec3> keys;
    for (const Trs& pose : motion_.poses) keys.emplace_back(keyOf(pose.translation, power));
    const auto error = [&](std::size_t t, const glm::dvec3& shift) {
      return farthest(t, [&](std::size_t i) {
        return offs_[t * motion_.points + i] + (shift - motion_.poses[t].translation);
      });
    };
    const Indices chosen = choose(
        Target::kPartTranslation, tolerance_,
        [&](std::size_t t, std::size_t a, std::size_t b) {
          return error(t, glm::mix(keys[a], keys[b], shareOf(times_, t, a, b)));
        },
        [&](std::size_t t) { return error(t, glm::dvec3(0)); });
    keep(chosen, Target::kPartTranslation, tracks,
         [&](std::size_t t) { return keyOf(motion_.poses[t].translation, power); });
  }

  // The keys of a track; none if nothing has to be changed. still(t): the error without the track.
  template <class Error, class Still>
  Indices choose(Target, double tolerance, const Error& error, const Still& still) const {
    bool none = true;
    for (std::size_t t = 0; t < times_.size() && none; ++t) none = still(t) <= tolerance;
    if (none) return {};
    return chooseKeys(times_.size(), tolerance, error);
  }

  template <class Key>
  void keep(const Indices& chosen, Target target, std::vector<Track>& tracks, const Key& key) const {
    if (chosen.empty()) return;
    Track track;
    track.target = target;
    for (const std::size_t t : chosen)
      track.keys.push_back({chosen.size() == 1 ? 0.0f : times_[t], key(t), {}, {}});
    tracks.push_back(std::move(track));
  }

  // visit(t, a, b, none): time t lies between the keys a and b.
  template <class Visit>
  void eachTime(const Indices& chosen, const Visit& visit) const {
    std::size_t k = 0;
    for (std::size_t t = 0; t < times_.size(); ++t) {
      if (chosen.empty()) {
        visit(t, 0, 0, true);
        continue;
      }
      while (k + 1 < chosen.size() && chosen[k + 1] <= t) ++k;
      visit(t, chosen[k], chosen[std::min(k + 1, chosen.size() - 1)], false);
    }
  }

  const KeyedMotion& motion_;
  const std::vector<float>& times_;
  const double tolerance_;
  std::vector<glm::dmat3> spread_;  // as motion_.spread
  std::vector<glm::dvec3> turned_;  // the places, as the joint turns and scales them
  std::vector<glm::dvec3> offs_;    // of them: what the tracks so far leave
};

}  // namespace

double KeyedMotion::reach() const {
  double most = 0;
  for (std::size_t t = 0; t < poses.size(); ++t)
    for (std::size_t i = 0; i < points; ++i)
      most = std::max(most, glm::length(spread[t] * (poses[t].scale * places[t * points + i])));
  return most;
}

double KeyedMotion::size() const {
  double most = 0;
  for (const glm::dmat3& m : spread) most = std::max(most, sizeOf(m));
  return most;
}

std::vector<Track> chooseTracks(const KeyedMotion& motion, const std::vector<float>& times,
                                double tolerance) {
  return TrackChoice(motion, times, tolerance).make();
}

std::vector<Track> chooseWeightTrack(const std::vector<float>& weights, const std::vector<float>& times,
                                     double tolerance) {
  const double power = powerBelow(0.2 * tolerance);
  const auto keyed = [&](std::size_t t) { return rounded(static_cast<double>(weights[t]), power); };
  if (std::all_of(weights.begin(), weights.end(),
                  [&](float weight) { return std::abs(static_cast<double>(weight)) <= tolerance; }))
    return {};
  Track track;
  track.target = Target::kPartTranslation;
  const Indices chosen =
      chooseKeys(times.size(), tolerance, [&](std::size_t t, std::size_t a, std::size_t b) {
        return std::abs(glm::mix(keyed(a), keyed(b), shareOf(times, t, a, b)) -
                        static_cast<double>(weights[t]));
      });
  for (const std::size_t t : chosen)
    track.keys.push_back({chosen.size() == 1 ? 0.0f : times[t], glm::vec4(keyed(t), 0, 0, 0), {}, {}});
  return {std::move(track)};
}

Trs motionOfTracks(const std::vector<Track>& tracks, double time) {
  Trs out;
  for (const Track& track : tracks) {
    const auto after = std::upper_bound(
        track.keys.begin(), track.keys.end(), time,
        [](double t, const RigDescription::Key& key) { return t < static_cast<double>(key.time); });
    const RigDescription::Key& a = after == track.keys.begin() ? *after : *(after - 1);
    const RigDescription::Key& b = after == track.keys.end() ? a : *after;
    const double span = static_cast<double>(b.time) - static_cast<double>(a.time),
                 share = span > 0 ? (time - static_cast<double>(a.time)) / span : 0;
    const glm::dvec3 value = glm::mix(glm::dvec3(a.value), glm::dvec3(b.value), share);
    if (track.target == Target::kPartRotation)
      out.rotation = slerpShort(quaternionOfKey(a.value), quaternionOfKey(b.value), share);
    else if (track.target == Target::kPartScale)
      out.scale = 1.0 + value;
    else
      out.translation = value;
  }
  return out;
}

}  // namespace kelp::bake
