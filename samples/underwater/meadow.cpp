// SPDX-License-Identifier: MIT
#include "meadow.h"

#include <glm/gtc/matrix_transform.hpp>

#include "current.h"
#include "terrain.h"

namespace underwater {

using kelp::runtime::Asset;
using kelp::runtime::Pose;
using kelp::runtime::Spring;

namespace {

// swings a second of a plant of scale 1; what is large swings more slowly
constexpr float kFrequency = 0.65f;
constexpr float kReach = 0.45f;  // heights: what bends a plant farther pulls in vain

}  // namespace

kelp::Result<std::unique_ptr<Meadow>> Meadow::plant(const Library& library, int count) {
  std::unique_ptr<Meadow> meadow(new Meadow);
  for (const Site& site : scatter(count, 7)) {
    const Asset& asset = library.asset(static_cast<Species>(site.plant));
    auto pose = Pose::create(asset);
    if (!pose) return pose.error();
    const float frequency = kFrequency / glm::sqrt(site.scale);
    auto spring = Spring::create(asset, {.frequency = frequency, .damping = 0.35f, .reach = kReach});
    if (!spring) return spring.error();
    Rooted& plant = meadow->plants_.emplace_back(Rooted{&asset, *std::move(pose), *std::move(spring), site});
    const kelp::Part& part = asset.pack().parts()[0];
    plant.foot = {site.at.x, sandHeight(site.at) - 0.02f * site.scale, site.at.y};
    plant.to_world = glm::translate(glm::mat4(1), plant.foot) *
                     glm::rotate(glm::mat4(1), site.yaw, {0, 1, 0}) *
                     glm::scale(glm::mat4(1), glm::vec3(site.scale));
    const glm::mat3 axes(plant.to_world * glm::mat4(part.to_object));
    plant.height = glm::length(axes[1]) * static_cast<float>(part.size.y);
    plant.stiffness = glm::pow(6.2831853f * frequency, 2.0f);
    const auto sway = findClip(asset, "sway");
    plant.clip = sway ? *sway : -1;
  }
  return meadow;
}

void Meadow::update(double seconds, float passed, std::span<const Visitor> visitors) {
  for (Rooted& plant : plants_) {
    // The clip, less of it where the current draws the plant taut.
    const glm::vec2 current = currentAt(plant.site.at, seconds);
    plant.pose.reset();
    const float slack = 0.55f * (1 - 1.8f * glm::length(current));
    if (plant.clip >= 0)
      (void)addClip(*plant.asset, plant.clip, seconds / glm::sqrt(plant.site.scale) + plant.site.phase, slack,
                    plant.pose);
    // The spring on top: leant by the current as far as it says, out of everyone's way.
    const glm::vec3 lean = plant.height * glm::vec3(current.x, 0, current.y);
    (void)plant.spring.setWindInWorld({plant.asset, nullptr, plant.to_world}, 0, plant.stiffness * lean);
    (void)plant.spring.step(passed);
    for (const Visitor& visitor : visitors) {
      const glm::vec3 off = visitor.at - plant.foot;
      const float near = visitor.radius + 0.7f * plant.height;  // most are far away
      if (off.x * off.x + off.z * off.z > near * near || off.y > plant.height + visitor.radius) continue;
      (void)plant.spring.pushAway({plant.asset, &plant.pose, plant.to_world}, visitor.at, visitor.radius);
    }
    (void)plant.spring.addTo(plant.pose);  // and keeps it monotone
  }
}

void Meadow::place(std::span<kelp::runtime::Instance> instances) const {
  for (std::size_t i = 0; i < plants_.size(); ++i) {
    const Rooted& plant = plants_[i];
    instances[i] = {plant.asset, &plant.pose, plant.to_world, glm::vec4(plant.site.tint, 1)};
  }
}

}  // namespace underwater
