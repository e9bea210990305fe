// SPDX-License-Identifier: MIT
#include "solids.h"

#include <algorithm>

#include "terrain.h"

namespace underwater {

namespace {

// How much more the way out from the stem counts than the way out from the nearest leaf. With leaves on both
// sides of a fish, the leaves alone would push it to and fro.
constexpr float kIn = 4;

// The middle line of a plant, at the height of a point; the point itself above and below the plant.
glm::vec3 stemBeside(const kelp::runtime::Instance& plant, int part, const glm::vec3& point) {
  const auto rest = toRest(plant, part, point);
  if (!rest) return point;
  const kelp::Part& of = plant.asset->pack().parts()[static_cast<std::size_t>(part)];
  const glm::vec3 middle = of.to_object * glm::vec4(0.5f * glm::vec3(of.size), 1);
  return toWorld(plant, part, {middle.x, rest->y, middle.z}).value();
}

}  // namespace

Solids::Solids(std::span<const kelp::runtime::Instance> plants) : plants_(plants), boxes_(plants.size()) {
  near_.reserve(plants.size());
  near_instances_.reserve(plants.size());
  near_boxes_.reserve(plants.size());
}

void Solids::look() {
  for (std::size_t i = 0; i < plants_.size(); ++i) boxes_[i] = bounds(plants_[i]);
  asked_ = 0;
}

void Solids::lookAt(int plant) {
  const auto i = static_cast<std::size_t>(plant);
  boxes_[i] = bounds(plants_[i]);
  const auto near = std::ranges::find(near_, plant);
  if (near != near_.end()) near_boxes_[static_cast<std::size_t>(near - near_.begin())] = boxes_[i];
}

void Solids::stayWithin(const kelp::Box& box) {
  near_.clear();
  near_instances_.clear();
  near_boxes_.clear();
  for (std::size_t i = 0; i < plants_.size(); ++i) {
    if (glm::any(glm::lessThan(boxes_[i].max, box.min)) || glm::any(glm::lessThan(box.max, boxes_[i].min)))
      continue;
    near_.push_back(static_cast<int>(i));
    near_instances_.push_back(plants_[i]);
    near_boxes_.push_back(boxes_[i]);
  }
}

Solids::Clearance Solids::clearance(const glm::vec3& at) const {
  const glm::vec2 ground(at.x, at.z);
  const glm::vec3 normal = sandNormal(ground);
  const Clearance sand{(at.y - sandHeight(ground)) * normal.y, normal, normal};
  if (near_.empty()) return sand;
  ++asked_;
  const auto nearest = distance(near_instances_, at, near_boxes_);
  if (!nearest || nearest->bound >= sand.free) return sand;
  Clearance clearance{nearest->bound, nearest->away, nearest->away};
  const auto& plant = near_instances_[static_cast<std::size_t>(nearest->instance)];
  const glm::vec3 out = at - stemBeside(plant, *nearest->part, at);
  if (glm::length(out) > 0) clearance.out = glm::normalize(out);
  return clearance;
}

std::optional<Solids::Touch> Solids::touch(const kelp::runtime::Sphere& ball) const {
  if (near_.empty()) return std::nullopt;
  ++asked_;
  const auto nearest = closestPoint(near_instances_, ball.center, ball.radius, near_boxes_);
  // It may find what is up to a voxel farther than it was asked for.
  if (!nearest || nearest->distance >= ball.radius) return std::nullopt;
  const auto which = static_cast<std::size_t>(nearest->instance);
  Touch touch{near_[which], nearest->point};
  if (nearest->distance > 0) {
    touch.aside = (nearest->point - ball.center) / nearest->distance;
    touch.deep = ball.radius - nearest->distance;
  } else if (const auto inside = distance(near_instances_[which], ball.center)) {
    touch.aside = -inside->away;
    touch.deep = ball.radius - inside->bound;
  }
  const glm::vec3 in = stemBeside(near_instances_[which], *nearest->part, ball.center) - ball.center;
  if (glm::length(in) > 0) touch.aside = glm::normalize(touch.aside + kIn * glm::normalize(in));
  return touch;
}

}  // namespace underwater
