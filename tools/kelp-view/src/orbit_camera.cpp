// SPDX-License-Identifier: MIT
#include "orbit_camera.h"

#include <cmath>

#include <glm/gtc/matrix_transform.hpp>

namespace kelp::view {
namespace {

constexpr float kFieldOfView = 0.7f;  // radians, vertical

}  // namespace

void OrbitCamera::frame(const Box& box) {
  if (box.empty()) return;
  target_ = 0.5f * (box.min + box.max);
  reach_ = std::max(0.5f * glm::length(box.max - box.min), 1e-6f);
  const float narrow = std::min(1.0f, viewport_.x / viewport_.y);
  distance_ = 1.05f * reach_ / (std::sin(0.5f * kFieldOfView) * narrow);
}

void OrbitCamera::orbit(const glm::vec2& pixels) {
  yaw_ -= 0.008f * pixels.x;
  pitch_ = glm::clamp(pitch_ + 0.008f * pixels.y, -1.5f, 1.5f);
}

void OrbitCamera::pan(const glm::vec2& pixels) {
  // of a pixel at the target's depth
  const float world = 2 * std::tan(0.5f * kFieldOfView) * distance_ / viewport_.y;
  // its columns: the world directions of the picture's right, up and back
  const glm::mat4 turn = glm::transpose(worldToEye());
  target_ -= world * (pixels.x * glm::vec3(turn[0]) - pixels.y * glm::vec3(turn[1]));
}

void OrbitCamera::zoom(float clicks) {
  distance_ = glm::clamp(distance_ * std::pow(0.88f, clicks), 0.02f * reach_, 50 * reach_);
}

glm::vec3 OrbitCamera::eye() const {
  return target_ + distance_ * glm::vec3(std::sin(yaw_) * std::cos(pitch_), std::sin(pitch_),
                                         std::cos(yaw_) * std::cos(pitch_));
}

glm::mat4 OrbitCamera::worldToEye() const { return glm::lookAt(eye(), target_, glm::vec3(0, 1, 0)); }

glm::mat4 OrbitCamera::eyeToClip() const {
  return glm::perspective(kFieldOfView, viewport_.x / viewport_.y, 0.01f * distance_,
                          distance_ + 100 * reach_);
}

std::optional<glm::vec2> OrbitCamera::project(const glm::vec3& world) const {
  const glm::vec4 clip = eyeToClip() * worldToEye() * glm::vec4(world, 1);
  if (clip.w <= 1e-6f) return std::nullopt;
  return viewport_ * (0.5f + 0.5f * glm::vec2(clip.x, -clip.y) / clip.w);
}

runtime::Ray OrbitCamera::ray(const glm::vec2& pixel) const {
  const glm::vec2 ndc = glm::vec2(2, -2) * pixel / viewport_ + glm::vec2(-1, 1);
  const glm::mat4 view = worldToEye();
  const float up = std::tan(0.5f * kFieldOfView);
  const glm::vec3 direction = distance_ * glm::vec3(ndc.x * up * viewport_.x / viewport_.y, ndc.y * up, -1);
  return {eye(), glm::transpose(glm::mat3(view)) * direction};
}

glm::vec3 OrbitCamera::dragTo(const glm::vec3& through, const glm::vec2& pixel) const {
  const runtime::Ray r = ray(pixel);
  const glm::vec3 forward = target_ - eye();
  return r.origin + r.direction * glm::dot(through - r.origin, forward) / glm::dot(r.direction, forward);
}

}  // namespace kelp::view
