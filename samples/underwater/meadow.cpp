// SPDX-License-Identifier: MIT
#include "meadow.h"

#include <glm/gtc/matrix_transform.hpp>

#include "terrain.h"

namespace underwater {

using kelp::runtime::Asset;
using kelp::runtime::Pose;

kelp::Result<std::unique_ptr<Meadow>> Meadow::plant(const Library& library, int count) {
  std::unique_ptr<Meadow> meadow(new Meadow);
  for (const Site& site : scatter(count, 7)) {
    const Asset& asset = library.asset(static_cast<Species>(site.plant));
    auto pose = Pose::create(asset);
    if (!pose) return pose.error();
    Rooted& plant = meadow->plants_.emplace_back(Rooted{&asset, *std::move(pose), site});
    const kelp::Part& part = asset.pack().parts()[0];
    plant.foot = {site.at.x, sandHeight(site.at) - 0.02f * site.scale, site.at.y};
    plant.to_world = glm::translate(glm::mat4(1), plant.foot) * glm::rotate(glm::mat4(1), site.yaw, {0, 1, 0}) *
                     glm::scale(glm::mat4(1), glm::vec3(site.scale));
    const glm::mat3 axes(plant.to_world * glm::mat4(part.to_object));
    plant.to_part = glm::transpose(glm::mat3(glm::normalize(axes[0]), glm::normalize(axes[1]), glm::normalize(axes[2])));
    plant.height = glm::length(axes[1]) * static_cast<float>(part.size.y);
    plant.clip = findClip(asset, "sway");
  }
  return meadow;
}

void Meadow::update(double seconds, float passed, std::span<const Visitor> visitors) {
  for (Rooted& plant : plants_) {
    glm::vec2 wanted = currentAt(plant.site.at, seconds);
    for (const Visitor& visitor : visitors) wanted += pushOf(visitor, plant.foot, plant.height);
    plant.sway.follow(limitLean(wanted), passed);
    const glm::vec2 lean = limitLean(plant.sway.lean);
    const glm::vec3 in_part = plant.to_part * glm::vec3(lean.x, 0, lean.y);
    plant.pose.reset();
    leanStalk({in_part.x, in_part.z}, static_cast<float>(plant.asset->pack().parts()[0].size.y), plant.pose.knots(0));
    // What is small sways faster; what leans far is drawn taut.
    const float slack = 0.55f * (1 - 0.8f * glm::length(lean) / kMostLean);
    if (plant.clip >= 0)
      (void)addClip(*plant.asset, plant.clip, seconds / glm::sqrt(plant.site.scale) + plant.site.phase, slack, plant.pose);
    plant.pose.clampMonotone();
  }
}

void Meadow::place(std::span<kelp::runtime::Instance> instances) const {
  for (std::size_t i = 0; i < plants_.size(); ++i) {
    const Rooted& plant = plants_[i];
    instances[i] = {plant.asset, &plant.pose, plant.to_world, glm::vec4(plant.site.tint, 1)};
  }
}

}  // namespace underwater
