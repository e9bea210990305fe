// SPDX-License-Identifier: MIT
#include "path.h"

#include <algorithm>
#include <cassert>
#include <cmath>

#include "dodge.h"

namespace underwater {
namespace {

constexpr int kPieces = 64;       // of a segment, for its length
constexpr float kNearby = 0.02f;  // meters, for differences

// Length from t0 to t1: Gauss and Legendre's rule of three points.
float lengthBetween(const kelp::Segment& segment, float t0, float t1) {
  const float middle = 0.5f * (t0 + t1), half = 0.5f * (t1 - t0), aside = 0.7745967f * half;
  return half / 9 *
         (5 * glm::length(derivative(segment, middle - aside)) +
          8 * glm::length(derivative(segment, middle)) +
          5 * glm::length(derivative(segment, middle + aside)));
}

}  // namespace

ClosedPath::ClosedPath(std::span<const glm::vec3> points) {
  const std::size_t n = points.size();
  assert(n >= 3);
  for (std::size_t i = 0; i < n; ++i) {
    const glm::vec3 &before = points[(i + n - 1) % n], &from = points[i], &to = points[(i + 1) % n],
                    &after = points[(i + 2) % n];
    segments_.push_back({from, 0.5f * (to - before), to, 0.5f * (after - from)});
  }
  std::vector<float> along{0.0f};  // length up to each piece's end
  for (const kelp::Segment& segment : segments_) {
    for (int i = 0; i < kPieces; ++i) {
      along.push_back(along.back() + lengthBetween(segment, static_cast<float>(i) / kPieces,
                                                   static_cast<float>(i + 1) / kPieces));
    }
  }
  length_ = along.back();
  parameter_.resize(along.size());
  std::size_t piece = 0;
  for (std::size_t i = 0; i < parameter_.size(); ++i) {
    const float s = length_ * static_cast<float>(i) / static_cast<float>(parameter_.size() - 1);
    while (piece + 2 < along.size() && along[piece + 1] < s) ++piece;
    const float part = (s - along[piece]) / (along[piece + 1] - along[piece]);
    parameter_[i] = (static_cast<float>(piece) + std::clamp(part, 0.0f, 1.0f)) / kPieces;
  }
}

ClosedPath::Place ClosedPath::place(float s) const {
  const float turns = s / length_;
  const float x = (turns - std::floor(turns)) * static_cast<float>(parameter_.size() - 1);
  const std::size_t i = std::min(static_cast<std::size_t>(x), parameter_.size() - 2);
  const float u = glm::mix(parameter_[i], parameter_[i + 1], x - static_cast<float>(i));
  const std::size_t segment = std::min(static_cast<std::size_t>(u), segments_.size() - 1);
  return {segment, u - static_cast<float>(segment)};
}

glm::vec3 ClosedPath::at(float s) const {
  const Place p = place(s);
  return evaluate(segments_[p.segment], p.t);
}

glm::vec3 ClosedPath::direction(float s) const {
  const Place p = place(s);
  return glm::normalize(derivative(segments_[p.segment], p.t));
}

float ClosedPath::turn(float s) const {
  const glm::vec3 before = direction(s - kNearby), after = direction(s + kNearby);
  return (before.x * after.z - before.z * after.x) / (2 * kNearby);
}

glm::vec3 Lane::at(float s) const {
  const glm::vec3 ahead = path->direction(s), side = glm::normalize(glm::cross(ahead, glm::vec3(0, 1, 0)));
  const glm::vec3 at = path->at(s) + right * side + up * glm::cross(side, ahead);
  return dodge ? at + dodge->at(s - head) : at;
}

glm::vec3 Lane::direction(float s) const { return glm::normalize(at(s + kNearby) - at(s - kNearby)); }

}  // namespace underwater
