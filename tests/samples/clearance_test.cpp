// SPDX-License-Identifier: MIT
// Fish among plants of the underwater scene: whether their voxels meet, in double precision and without
// kelp's distances, and how plants give way.
#include <gtest/gtest.h>

#include <cmath>
#include <functional>

#include "reef.h"
#include "reference/deformed_field.h"
#include "support/distance_pack.h"
#include "support/scratch.h"
#include "support/voxel_points.h"

namespace underwater {
namespace {

using kelp::runtime::Instance;
using kelp::runtime::Sphere;

constexpr glm::ivec3 kPlantSize(24, 48, 24), kFishSize(12, 32, 8);

kelp::fields::Occupancy fill(const glm::ivec3& size, const std::function<bool(const glm::vec3&)>& solid) {
  const auto count = static_cast<std::size_t>(size.x) * static_cast<std::size_t>(size.y * size.z);
  kelp::fields::Occupancy volume{size, std::vector<std::uint8_t>(count)};
  for (int z = 0; z < size.z; ++z)
    for (int y = 0; y < size.y; ++y)
      for (int x = 0; x < size.x; ++x)
        volume.solid[volume.index({x, y, z})] = solid(glm::vec3(x, y, z) + 0.5f) ? 1 : 0;
  return volume;
}

// A stem with leaves on four sides, one above the other.
kelp::fields::Occupancy plantVolume() {
  return fill(kPlantSize, [](const glm::vec3& p) {
    const glm::vec2 off(p.x - 12, p.z - 12);
    if (glm::length(off) < 1.5f) return true;
    const int leaf = static_cast<int>(p.y) / 6;
    const float along = leaf % 2 == 0 ? off.x : off.y, beside = leaf % 2 == 0 ? off.y : off.x;
    return p.y > 6 && (leaf % 4 < 2) == (along > 0) && std::abs(along) < 9 && std::abs(beside) < 2.5f &&
           std::fmod(p.y, 6.0f) < 2;
  });
}
kelp::fields::Occupancy fishVolume() {
  return fill(kFishSize, [](const glm::vec3& p) {
    return glm::length((p - 0.5f * glm::vec3(kFishSize)) / (0.5f * glm::vec3(kFishSize))) < 1;
  });
}

std::vector<kelp::Knot> straightKnots() {
  std::vector<kelp::Knot> all;
  for (const float at : {0.0f, 0.3f, 0.65f, 1.0f}) all.push_back({at, {0, at, 0}, {0, 1, 0}});
  return all;
}

// Packs, with which fish can see plants or cannot.
class Waters {
 public:
  explicit Waters(bool distances) {
    kelp::RawPack plant = distances ? kelp::test::distancePackOf(plantVolume(), straightKnots())
                                    : kelp::test::packOf(plantVolume(), straightKnots());
    plant.clips.push_back({"sway", 2, {{0, 3, kelp::Target::kKnotOffset, {0.1f, 0, 0.06f}, 2, 0}}, {}});
    for (const char* name : {"kelp_plant", "sea_grass", "dulse"})
      scratch_.write(std::string(name) + ".kelp", kelp::test::bytesOf(plant));
    kelp::RawPack fish = kelp::test::packOf(fishVolume(), straightKnots());
    constexpr float kVoxel = 0.25f / 32;  // metres; swims along +x
    fish.parts[0].to_object = glm::mat4x3(glm::vec3(0, kVoxel, 0), glm::vec3(-kVoxel, 0, 0),
                                          glm::vec3(0, 0, kVoxel), kVoxel * glm::vec3(16, -6, -4));
    fish.clips.push_back({"swim", 1, {{0, 3, kelp::Target::kKnotOffset, {0, 0, 0.06f}, 1, 0}}, {}});
    for (const char* name : {"fish", "fusilier"})
      scratch_.write(std::string(name) + ".kelp", kelp::test::bytesOf(fish));
    std::string wrong;
    auto opened = Library::open(scratch_.folder().string(), wrong);
    EXPECT_TRUE(opened) << wrong;
    library = *std::move(opened);
  }
  bool isPlant(const Instance& instance) const {
    return instance.asset == &library->asset(Species::kKelpPlant) ||
           instance.asset == &library->asset(Species::kSeaGrass) ||
           instance.asset == &library->asset(Species::kDulse);
  }

 private:
  const kelp::test::Scratch scratch_;

 public:
  std::unique_ptr<Library> library;
};

// The voxels of an instance in the world, by the definition of its spline.
struct Bent {
  explicit Bent(const Instance& instance)
      : map(instance.pose->knots(0), instance.asset->pack().parts()[0].size),
        to_world(partToWorld(instance, 0)),
        to_part(glm::inverse(to_world)) {}
  kelp::reference::SplineMap map;
  glm::dmat4 to_world, to_part;
};

// How many of the fish meet a plant now: the centre of a voxel of the fish is in a voxel of the plant.
int countMeetings(const Waters& waters, std::span<const Instance> all) {
  static const kelp::fields::Occupancy kPlant = plantVolume(), kFish = fishVolume();
  int meetings = 0;
  for (const Instance& fish : all) {
    if (waters.isPlant(fish)) continue;
    const kelp::Box box = bounds(fish);
    std::vector<glm::dvec3> body;
    bool met = false;
    for (const Instance& plant : all) {
      if (!waters.isPlant(plant)) continue;
      const kelp::Box other = bounds(plant);
      if (glm::any(glm::lessThan(other.max, box.min)) || glm::any(glm::lessThan(box.max, other.min)))
        continue;
      if (body.empty()) {
        const Bent bent(fish);
        for (int z = 0; z < kFishSize.z; ++z)
          for (int y = z % 2; y < kFishSize.y; y += 2)
            for (int x = 0; x < kFishSize.x; x += 2)
              if (kFish.solid[kFish.index({x, y, z})])
                body.emplace_back(bent.to_world *
                                  glm::dvec4(bent.map.toDeformed(glm::dvec3(x, y, z) + 0.5), 1));
      }
      const Bent bent(plant);
      for (const glm::dvec3& at : body) {
        const glm::dvec3 p(bent.to_part * glm::dvec4(at, 1));
        if (p.y <= bent.map.low() || p.y >= bent.map.high()) continue;
        const glm::ivec3 voxel(glm::floor(bent.map.toRest(p)));
        if (glm::any(glm::lessThan(voxel, glm::ivec3(0))) ||
            glm::any(glm::greaterThanEqual(voxel, kPlantSize)))
          continue;
        met = met || kPlant.solid[kPlant.index(voxel)];
      }
      if (met) break;
    }
    meetings += met;
  }
  return meetings;
}

// A minute, six looks a second: how often a fish met a plant, and how fast one turned at most.
struct Minute {
  int meetings = 0, asked = 0;  // asked: questions put to kelp
  float hardest = 0;            // metres a second squared
};
Minute watch(bool distances) {
  const Waters waters(distances);
  const auto reef = *Reef::grow(*waters.library, 250);
  Minute minute;
  std::vector<glm::vec3> places, velocities;
  for (int frame = 1; frame <= 1800; ++frame) {
    reef->update(frame / 30.0, 1.0f / 30, {});
    minute.asked += reef->asked();
    if (frame % 5 == 0) minute.meetings += countMeetings(waters, reef->instances());
    std::vector<glm::vec3> now, speeds;
    for (const Instance& instance : reef->instances())
      if (!waters.isPlant(instance)) now.push_back(kelp::test::voxelToWorld(instance, 0, {6, 16, 4}));
    for (std::size_t i = 0; i < places.size(); ++i) speeds.push_back(30.0f * (now[i] - places[i]));
    for (std::size_t i = 0; i < velocities.size(); ++i)
      minute.hardest = std::max(minute.hardest, 30 * glm::distance(speeds[i], velocities[i]));
    places = now, velocities = speeds;
  }
  return minute;
}

TEST(Clearance, FishMeetNoPlantThoughTheirLanesDo) {
  const Minute blind = watch(false), seeing = watch(true);
  RecordProperty("blind", blind.meetings);
  RecordProperty("questions_a_frame", seeing.asked / 1800);
  EXPECT_GT(blind.meetings, 200);
  EXPECT_EQ(seeing.meetings, 0);
  EXPECT_LT(seeing.hardest, 15);  // at 1 m/s: no turn is narrower than 7 cm
  EXPECT_LT(seeing.asked / 1800, 59 * 16);
}

TEST(Clearance, PlantsGiveWayWhereTheyAreTouchedAndSwingBack) {
  const Waters waters(true);
  const auto alone = *Meadow::plant(*waters.library, 1), touched = *Meadow::plant(*waters.library, 1);
  std::vector<Instance> still(1), bent(1);
  const auto go = [&](int from, int to) {
    for (int i = from; i < to; ++i) {
      alone->update(0.02 * i, 0.02f, {});
      touched->update(0.02 * i, 0.02f, {});
    }
    alone->place(still);
    touched->place(bent);
  };
  go(0, 300);
  Solids solids(bent);
  for (const glm::vec3& side : {glm::vec3(1, 0, 0), glm::vec3(-1, 0, 0), glm::vec3(0, 0, 1)}) {
    // A ball on that side of the stem, two thirds up.
    const glm::vec3 stem = kelp::test::voxelToWorld(bent[0], 0, {12, 32, 12});
    const Sphere ball{stem + 0.12f * side, 0.2f};
    solids.look();
    solids.stayWithin({ball.centre - ball.radius, ball.centre + ball.radius});
    for (int round = 0; round < 8; ++round) {
      const auto touch = solids.touch(ball);
      ASSERT_TRUE(touch || round > 0);
      if (!touch) break;
      touched->giveWay(*touch, ball.radius);
      solids.lookAt(0);
    }
    EXPECT_FALSE(solids.touch(ball));
    const auto before = still[0].pose->knots(0), after = bent[0].pose->knots(0);
    EXPECT_EQ(before[0].position, after[0].position);  // the root holds
    for (std::size_t k = 1; k < before.size(); ++k) {
      const glm::vec3 moved = after[k].position - before[k].position,  // heights
          offset = glm::mat3(partToWorld(bent[0], 0)) * (static_cast<float>(kPlantSize.y) * moved);
      EXPECT_LT(glm::dot(offset, side), k > 1 ? -0.05f : -1e-3f) << k;  // metres, away from the ball
    }
    go(300, 1200);
    const auto at_rest = still[0].pose->knots(0), back = bent[0].pose->knots(0);
    for (std::size_t k = 0; k < before.size(); ++k)
      EXPECT_LT(glm::distance(at_rest[k].position, back[k].position), 1e-3f);
  }
}

}  // namespace
}  // namespace underwater
