// SPDX-License-Identifier: MIT
#include "key_choice.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "rigid.h"

namespace kelp::bake {

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

float roundedKey(double value, double step) {
  const double power = std::exp2(std::floor(std::log2(step)));
  return static_cast<float>(std::round(value / power) * power);
}

double shareOf(const std::vector<float>& times, std::size_t i, std::size_t a, std::size_t b) {
  if (a == b) return 0;
  return (static_cast<double>(times[i]) - static_cast<double>(times[a])) /
         (static_cast<double>(times[b]) - static_cast<double>(times[a]));
}

RigidMotion motionAbout(const std::vector<glm::dmat4x3>& local, const glm::dvec3& pivot) {
  constexpr double kNothing = 1e-6;  // of a scale: a point has no rotation
  RigidMotion motion;
  for (const glm::dmat4x3& m : local) {
    const double scale = keepsSize(m) ? 1 : scaleOf(m);
    motion.scales.push_back(scale > kNothing ? scale : 0);
    glm::dquat q = scale > kNothing       ? quaternionOf(linearOf(m))
                   : motion.turns.empty() ? glm::dquat(1, 0, 0, 0)
                                          : motion.turns.back();
    if (motion.turns.empty() ? q.w < 0 : glm::dot(q, motion.turns.back()) < 0)
      q = glm::dquat(-q.w, -q.x, -q.y, -q.z);
    motion.turns.push_back(q);
    motion.shifts.push_back(m * glm::dvec4(pivot, 1) - pivot);
  }
  return motion;
}

KeyChoice chooseTracks(const RigidMotion& motion, const std::vector<float>& times,
                       const std::vector<glm::dvec3>& points, double tolerance, double of_turns) {
  std::vector<glm::dmat3> matrices;
  for (std::size_t i = 0; i < motion.turns.size(); ++i)
    matrices.push_back(motion.scales[i] * rotationOf(motion.turns[i]));
  const auto turnAt = [&](std::size_t i, std::size_t a, std::size_t b) {
    return rotationOf(slerpShort(motion.turns[a], motion.turns[b], shareOf(times, i, a, b)));
  };
  const auto scaleAt = [&](std::size_t i, std::size_t a, std::size_t b) {
    return motion.scales[a] + shareOf(times, i, a, b) * (motion.scales[b] - motion.scales[a]);
  };
  double reach = 0;
  for (const glm::dvec3& point : points) reach = std::max(reach, glm::length(point));
  KeyChoice choice;
  choice.turns = chooseKeys(times.size(), of_turns, [&](std::size_t i, std::size_t a, std::size_t b) {
    const glm::dmat3 off = motion.scales[i] * turnAt(i, a, b) - matrices[i];
    double worst = 0;
    for (const glm::dvec3& point : points) {
      const glm::dvec3 moved = off * point;
      worst = std::max(worst, glm::dot(moved, moved));
    }
    return std::sqrt(worst);
  });
  choice.scales = chooseKeys(times.size(), 0.5 * of_turns, [&](std::size_t i, std::size_t a, std::size_t b) {
    return reach * std::abs(scaleAt(i, a, b) - motion.scales[i]);
  });
  // The keys around a time.
  const auto around = [](const std::vector<std::size_t>& keys, std::size_t i, std::size_t& k) {
    while (k + 1 < keys.size() && keys[k + 1] <= i) ++k;
    return std::pair(keys[k], keys[std::min(k + 1, keys.size() - 1)]);
  };
  std::vector<glm::dmat3> offs;  // what the keys of rotation and scale leave
  std::size_t turn = 0, scale = 0;
  for (std::size_t i = 0; i < times.size(); ++i) {
    const auto [a, b] = around(choice.turns, i, turn);
    const auto [c, d] = around(choice.scales, i, scale);
    offs.push_back(scaleAt(i, c, d) * turnAt(i, a, b) - matrices[i]);
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

}  // namespace kelp::bake
