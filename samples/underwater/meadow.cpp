// SPDX-License-Identifier: MIT
#include "meadow.h"

#include <glm/gtc/matrix_transform.hpp>

#include "terrain.h"

namespace underwater {

using kelp::runtime::Asset;
using kelp::runtime::Pose;
using kelp::runtime::Sphere;
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
    const glm::vec3 middle = part.to_object * glm::vec4(0.5f * glm::vec3(part.size), 1);
    plant.stem = {middle.x, middle.z};
    plant.height = glm::length(axes[1]) * static_cast<float>(part.size.y);
    plant.stiffness = glm::pow(6.2831853f * frequency, 2.0f);
    const auto sway = findClip(asset, "sway");
    plant.clip = sway ? *sway : -1;
  }
  return meadow;
}

// The clip alone, less of it where the current draws the plant taut.
void Meadow::sway(Rooted& plant) const {
  plant.pose.reset();
  const float slack = 0.55f * (1 - 1.8f * glm::length(currentAt(plant.site.at, seconds_)));
  if (plant.clip >= 0)
    (void)addClip(*plant.asset, plant.clip, seconds_ / glm::sqrt(plant.site.scale) + plant.site.phase, slack,
                  plant.pose);
}

void Meadow::update(double seconds, float passed, const Sphere& player) {
  seconds_ = seconds;
  for (Rooted& plant : plants_) {
    sway(plant);
    // The spring on top: leant by the current as far as it says, out of the player's way.
    const glm::vec2 current = currentAt(plant.site.at, seconds);
    const glm::vec3 lean = plant.height * glm::vec3(current.x, 0, current.y);
    (void)plant.spring.setWindInWorld({plant.asset, nullptr, plant.to_world}, 0, plant.stiffness * lean);
    (void)plant.spring.step(passed);
    const glm::vec3 off = player.center - plant.foot;
    const float near = player.radius + 0.7f * plant.height;  // most are far away
    if (off.x * off.x + off.z * off.z < near * near && off.y < plant.height + player.radius)
      (void)plant.spring.pushAway(plant.instance(), player.center, player.radius);
    (void)plant.spring.addTo(plant.pose);  // and keeps it monotone
  }
}

void Meadow::giveWay(const Solids::Touch& touch, float radius) {
  Rooted& plant = plants_[static_cast<std::size_t>(touch.plant)];
  // A spring moves the middle line of a plant. So the ball that pushes is not the fish's, which may touch a
  // leaf far from there: it stands behind the middle line, and reaches as far over it as the leaf has to go.
  const auto rest = toRest(plant.instance(), 0, touch.point);
  const float level = glm::length(glm::vec2(touch.aside.x, touch.aside.z));
  if (!rest || level < 0.2f) return;  // above or below: to bend would not help
  const glm::vec3 stem = toWorld(plant.instance(), 0, {plant.stem.x, rest->y, plant.stem.y}).value(),
                  aside = glm::vec3(touch.aside.x, 0, touch.aside.z) / level;
  sway(plant);
  (void)plant.spring.pushAway(plant.instance(), stem - radius * aside, radius + touch.deep);
  (void)plant.spring.addTo(plant.pose);
}

void Meadow::place(std::span<kelp::runtime::Instance> instances) const {
  for (std::size_t i = 0; i < plants_.size(); ++i) instances[i] = plants_[i].instance();
}

}  // namespace underwater
