// SPDX-License-Identifier: MIT
#include "camera.h"

#include <cmath>

#include <glm/gtc/matrix_transform.hpp>

#include "terrain.h"

namespace underwater {
namespace {

constexpr double kRound = 150;  // seconds for a circle
constexpr float kFar = 60, kNear = 0.05f;

}  // namespace

void Camera::circle(double seconds) {
  circling_ = true;
  const auto angle = static_cast<float>(std::fmod(seconds, kRound) / kRound * 6.283185307);
  const float distance = kCameraRing + 0.4f * glm::sin(3 * angle);
  at_ = {distance * glm::sin(angle), 1.15f + 0.25f * glm::sin(2 * angle + 0.6f), distance * glm::cos(angle)};
  at_.y += sandHeight({at_.x, at_.z});
  velocity_ = glm::vec3(0);
  yaw_ = angle + 0.22f * glm::sin(2 * angle);
  pitch_ = 0.07f + 0.06f * glm::sin(3 * angle + 1);
}

void Camera::look(const glm::vec2& turn) {
  circling_ = false;
  yaw_ -= turn.x;
  pitch_ = glm::clamp(pitch_ - turn.y, -1.5f, 1.5f);
}

void Camera::swim(const glm::vec3& wish, float seconds) {
  circling_ = false;
  const glm::vec3 right(glm::cos(yaw_), 0, -glm::sin(yaw_));
  const glm::vec3 aim = wish.x * right + glm::vec3(0, wish.y, 0) + wish.z * forward();
  velocity_ = glm::mix(aim, velocity_, std::exp(-5.0f * seconds));  // water resists
  at_ += seconds * velocity_;
  const glm::vec2 ground(at_.x, at_.z);
  const float distance = glm::length(ground), most = 1.3f * kReefRadius;
  if (distance > most) at_ = {at_.x * most / distance, at_.y, at_.z * most / distance};
  at_.y = glm::clamp(at_.y, sandHeight({at_.x, at_.z}) + 0.25f, kSurface - 0.4f);
}

glm::vec3 Camera::forward() const {
  return {-glm::sin(yaw_) * glm::cos(pitch_), glm::sin(pitch_), -glm::cos(yaw_) * glm::cos(pitch_)};
}

glm::mat4 Camera::worldToEye() const { return glm::lookAt(at_, at_ + forward(), glm::vec3(0, 1, 0)); }

glm::mat4 Camera::eyeToClip(const glm::ivec2& viewport) {
  const glm::vec2 pixels = glm::max(viewport, 1);
  return glm::perspective(0.95f, pixels.x / pixels.y, kNear, kFar);
}

}  // namespace underwater
