// SPDX-License-Identifier: MIT
#include "shoal.h"

#include <cmath>

#include "terrain.h"

namespace underwater {
namespace {

using kelp::runtime::Asset;
using kelp::runtime::Pose;

// A school swims close together: `across` and `high` meters wide and tall, spread over `along` meters.
struct School {
  Species species;
  int count;
  float along, across, high;
  float speed;         // meters a second
  float small, large;  // scale
};
constexpr School kSchools[] = {
    {Species::kFish, 6, 3.6f, 0.55f, 0.40f, 0.42f, 1.25f, 1.75f},
    {Species::kFusilier, 30, 4.2f, 0.80f, 0.60f, 0.85f, 1.1f, 1.5f},
    {Species::kFish, 5, 6.0f, 0.60f, 0.35f, 0.36f, 1.1f, 1.5f},
    {Species::kFusilier, 18, 3.2f, 0.55f, 0.40f, 0.70f, 0.9f, 1.2f},
};
constexpr float kStroke = 1.25f;  // of the clip's speed, for a fish of scale 1

}  // namespace

std::vector<ClosedPath> swimPaths() {
  // Heights are above the sand.
  const std::vector<glm::vec3> kWays[] = {
      {{2.4f, 0.95f, 1.3f},
       {0.4f, 1.15f, 0.7f},
       {-1.7f, 1.0f, 1.1f},
       {-3.7f, 1.2f, 1.9f},
       {-4.4f, 1.4f, 3.4f},
       {-3.0f, 1.6f, 4.8f},
       {0.6f, 1.3f, 4.6f},
       {3.4f, 1.2f, 4.3f},
       {4.4f, 1.1f, 3.0f},
       {3.8f, 1.0f, 1.7f}},  // through the glade
      {{0.0f, 1.9f, -1.6f},
       {3.6f, 2.3f, -2.4f},
       {6.4f, 2.7f, 0.6f},
       {4.6f, 2.4f, 4.2f},
       {2.6f, 2.2f, 4.8f},
       {-0.6f, 1.8f, 3.2f},
       {-3.6f, 2.1f, 4.4f},
       {-5.6f, 2.4f, 3.4f},
       {-6.6f, 2.8f, 0.2f},
       {-3.6f, 2.4f, -3.0f}},  // over the groves
      {{-1.2f, 0.9f, -2.6f},
       {-3.9f, 0.95f, -3.9f},
       {-4.2f, 1.1f, -5.6f},
       {-2.0f, 1.4f, -7.2f},
       {2.4f, 1.2f, -6.4f},
       {3.4f, 0.95f, -3.6f},
       {2.6f, 0.85f, -1.7f},
       {1.0f, 0.85f, -1.4f}},  // among the plants
      {{2.9f, 0.85f, -1.2f},
       {2.6f, 0.95f, 2.2f},
       {-0.8f, 0.85f, 3.3f},
       {-3.2f, 1.05f, 1.2f},
       {-2.4f, 0.9f, -2.2f},
       {0.4f, 0.8f, -3.1f}},  // round the glade
  };
  std::vector<ClosedPath> paths;
  for (std::vector<glm::vec3> way : kWays) {
    for (glm::vec3& point : way) point.y += sandHeight({point.x, point.z});
    paths.emplace_back(way);
  }
  return paths;
}

kelp::Result<std::unique_ptr<Shoal>> Shoal::gather(const Library& library) {
  std::unique_ptr<Shoal> shoal(new Shoal);
  shoal->paths_ = swimPaths();
  shoal->anatomies_[0] = Anatomy::of(library.asset(Species::kFish).pack().parts()[0]);
  shoal->anatomies_[1] = Anatomy::of(library.asset(Species::kFusilier).pack().parts()[0]);
  Random random(11);
  for (std::size_t i = 0; i < std::size(kSchools); ++i) {
    const School& school = kSchools[i];
    for (int k = 0; k < school.count; ++k) {
      const Asset& asset = library.asset(school.species);
      auto pose = Pose::create(asset);
      if (!pose) return pose.error();
      Fish& fish = shoal->fish_.emplace_back(Fish{
          &asset, *std::move(pose), &shoal->anatomies_[school.species == Species::kFusilier ? 1 : 0], {}});
      const glm::vec2 beside = random.inDisc(1);
      fish.lane = {&shoal->paths_[i], school.across * beside.x, school.high * beside.y};
      fish.start = school.along * (static_cast<float>(k) + random.between(-0.35f, 0.35f)) /
                   static_cast<float>(school.count);
      fish.speed = school.speed;
      fish.scale = random.between(school.small, school.large);
      fish.phase = random.between(0, 6.2831853f);
      const float light = random.between(0.85f, 1.08f);
      fish.tint = light * glm::vec3(1, random.between(0.94f, 1.04f), random.between(0.92f, 1.06f));
      const auto swim = findClip(asset, "swim");
      fish.clip = swim ? *swim : -1;
    }
  }
  shoal->balls_.reserve(kBalls * shoal->fish_.size());
  return shoal;
}

void Shoal::update(double seconds, float passed, Solids& solids) {
  balls_.clear();
  for (Fish& fish : fish_) {
    // Everyone drifts about the place in the school: forward and back more slowly than it swims, and from
    // lane to lane.
    const double slow = 0.31 * seconds + fish.phase;
    Lane lane = fish.lane;
    lane.right += 0.10f * static_cast<float>(std::sin(1.3 * slow));
    lane.up += 0.07f * static_cast<float>(std::sin(1.7 * slow + 1));
    // in double: the scene runs for days
    const double swum = seconds * fish.speed + fish.start + 0.3 * std::sin(slow);
    const auto head = static_cast<float>(std::fmod(swum, static_cast<double>(lane.path->length())));
    const float length = fish.scale * fish.anatomy->length, middle = head - 0.5f * length;
    const float thick = fish.scale * fish.anatomy->radius;
    fish.dodge.update(solids, lane, swum, length, thick, passed);
    lane.dodge = &fish.dodge;
    lane.head = head;
    const float bank = glm::clamp(0.35f * lane.path->turn(middle), -0.3f, 0.3f);

    fish.to_world = swimFrame(*fish.anatomy, lane, head, fish.scale, bank);
    fish.pose.reset();
    const std::span<const kelp::Knot> rest = fish.pose.knots(0);
    kelp::Knot on_lane[kelp::kMaxKnots];
    const std::span<kelp::Knot> knots(on_lane, rest.size());
    std::copy(rest.begin(), rest.end(), knots.begin());
    layOnLane(*fish.anatomy, fish.to_world, lane, head, fish.scale, knots);
    (void)fish.pose.setKnots(0, knots);
    const double strokes = kStroke / fish.scale * seconds + fish.phase;
    if (fish.clip >= 0) (void)addClip(*fish.asset, fish.clip, strokes, 0.8f, fish.pose);
    fish.pose.clamp();
    for (int k = 0; k < kBalls && fish.dodge.tight(); ++k) {
      const float behind = (static_cast<float>(k) + 0.5f) / kBalls * length;
      balls_.push_back({lane.at(head - behind), thick});
    }
  }
}

void Shoal::place(std::span<kelp::runtime::Instance> instances) const {
  for (std::size_t i = 0; i < fish_.size(); ++i) {
    const Fish& fish = fish_[i];
    instances[i] = {fish.asset, &fish.pose, fish.to_world, glm::vec4(fish.tint, 1)};
  }
}

}  // namespace underwater
