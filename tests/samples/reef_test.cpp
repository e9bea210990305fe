// SPDX-License-Identifier: MIT
// The whole underwater scene without a window, on small packs of its own: everyone in the water, every spline
// monotone, nothing allocated.
#include <gtest/gtest.h>

#include <filesystem>
#include <thread>

#include "../gl/count_new.h"
#include "reef.h"
#include "support/scratch.h"
#include "support/test_pack.h"
#include "support/voxel_points.h"
#include "terrain.h"

namespace underwater {
namespace {

class ReefTest : public ::testing::Test {
 protected:
  void SetUp() override {
    kelp::RawPack plant = kelp::test::packOf(kelp::test::ballClump({16, 32, 16}, 5, 1), knots());
    // A clip that would turn the spline back.
    plant.clips.push_back({"sway",
                           2,
                           {{0, 3, kelp::Target::kKnotOffset, {0.16f, 0, 0.06f}, 2, 0},
                            {0, 2, kelp::Target::kKnotTangent, {0.3f, -2.8f, 0}, 2, 0.2f}},
                           {}});
    for (const char* name : {"kelp_plant", "sea_grass", "dulse"})
      scratch_.write(std::string(name) + ".kelp", kelp::test::bytesOf(plant));
    kelp::RawPack fish = kelp::test::packOf(kelp::test::ballClump({12, 32, 8}, 5, 1), knots());
    fish.parts[0].to_object =
        glm::mat4x3(glm::vec3(0, kVoxel, 0), glm::vec3(-kVoxel, 0, 0), glm::vec3(0, 0, kVoxel),
                    kVoxel * glm::vec3(16, -6, -4));  // swims along +x
    fish.clips.push_back({"swim", 1, {{0, 3, kelp::Target::kKnotOffset, {0, 0, 0.125f}, 1, 0}}, {}});
    for (const char* name : {"fish", "fusilier"})
      scratch_.write(std::string(name) + ".kelp", kelp::test::bytesOf(fish));
    auto library = Library::open(scratch_.folder().string(), wrong_);
    ASSERT_TRUE(library) << wrong_;
    library_ = *std::move(library);
  }
  void TearDown() override { library_.reset(); }

  static constexpr float kVoxel = 0.3f / 32;  // metres
  static std::vector<kelp::Knot> knots() {
    std::vector<kelp::Knot> all;
    for (const float at : {0.0f, 0.3f, 0.65f, 1.0f}) all.push_back({at, {0, at, 0}, {0, 1, 0}});
    return all;
  }
  std::unique_ptr<Reef> grow(int plants) {
    auto reef = Reef::grow(*library_, plants);
    EXPECT_TRUE(reef);
    return *std::move(reef);
  }
  bool isFish(const kelp::runtime::Instance& instance) const {
    return instance.asset == &library_->asset(Species::kFish) ||
           instance.asset == &library_->asset(Species::kFusilier);
  }

  const kelp::test::Scratch scratch_;
  std::string wrong_;
  std::unique_ptr<Library> library_;
};

using kelp::runtime::Sphere;
constexpr Sphere kNobody{};

TEST_F(ReefTest, EveryoneStaysInTheWaterWithASoundSpline) {
  const auto reef = grow(120);
  for (int step = 0; step < 900; ++step) {
    reef->update(0.21 * step, 0.21f, {{0, 0.5f, 0}, 0.8f});
    for (const kelp::runtime::Instance& instance : reef->instances()) {
      ASSERT_TRUE(instance.pose->check());
      const kelp::Box box = bounds(instance);
      ASSERT_LT(box.max.y, kSurface);
      const glm::vec3 middle = 0.5f * (box.min + box.max);
      ASSERT_LT(glm::length(glm::vec2(middle.x, middle.z)), kReefRadius + 2);
      if (isFish(instance)) {
        ASSERT_GT(box.min.y, sandHeight({middle.x, middle.z}) + 0.05f) << step;
      }
    }
  }
}

TEST_F(ReefTest, FishSwimHeadFirstAndBendAsTheirWayDoes) {
  const auto reef = grow(0);
  std::vector<glm::vec3> before;
  int curved = 0, fish = 0;
  for (int step = 0; step < 200; ++step) {
    reef->update(0.05 * step, 0.05f, kNobody);
    std::vector<glm::vec3> now;
    for (const kelp::runtime::Instance& instance : reef->instances()) {
      ASSERT_TRUE(isFish(instance));
      now.push_back(kelp::test::voxelToWorld(instance, 0, {6, 16, 4}));
      const glm::vec3 nose = kelp::test::voxelToWorld(instance, 0, {6, 0, 4}),
                      tail = kelp::test::voxelToWorld(instance, 0, {6, 32, 4});
      if (!before.empty()) {
        const glm::vec3 moved = now.back() - before[now.size() - 1];
        EXPECT_GT(glm::dot(moved, nose - tail), 0.8f * glm::length(moved) * glm::length(nose - tail));
        EXPECT_LT(glm::length(moved), 0.05f * 1.4f);  // slower than 1.4 m/s
      }
      const glm::vec3 chord = glm::normalize(nose - tail), aside = now.back() - tail;
      ++fish;
      curved += glm::length(aside - chord * glm::dot(aside, chord)) > 0.01f * glm::length(nose - tail);
    }
    before = now;
  }
  EXPECT_GT(curved, fish / 4);
}

TEST_F(ReefTest, PlantsMakeWayForWhoeverComesAndSwingBack) {
  const auto alone = grow(60), visited = grow(60);
  const auto tip = [](const kelp::runtime::Instance& instance) {
    return kelp::test::voxelToWorld(instance, 0, {8, 32, 8});
  };
  const auto go = [&](int from, int to, const Sphere& visitor) {
    for (int i = from; i < to; ++i) {
      alone->update(0.02 * i, 0.02f, kNobody);
      visited->update(0.02 * i, 0.02f, visitor);
    }
  };
  const glm::vec3 foot = kelp::test::voxelToWorld(alone->instances()[0], 0, {8, 0, 8});
  go(0, 100, {foot + glm::vec3(0.3f, 0.8f, 0), 0.5f});
  EXPECT_LT(tip(visited->instances()[0]).x, tip(alone->instances()[0]).x - 0.05f);  // away from the visitor
  EXPECT_LT(glm::distance(kelp::test::voxelToWorld(visited->instances()[0], 0, {8, 0, 8}), foot), 1e-4f);
  go(100, 700, kNobody);
  EXPECT_LT(glm::distance(tip(visited->instances()[0]), tip(alone->instances()[0])), 1e-3f);
}

TEST_F(ReefTest, PlantsLeanAsTheCurrentDoes) {
  const auto reef = grow(150);
  // The mean over a long time and all plants: the current's own mean, 0.07 heights in x. Clips and swings
  // cancel out.
  double lean = 0;
  int count = 0;
  for (int i = 0; i < 2000; ++i) {
    reef->update(0.11 * i, 0.11f, kNobody);
    for (std::size_t k = 0; k < 150; ++k) {
      const kelp::runtime::Instance& plant = reef->instances()[k];
      const glm::vec3 foot = kelp::test::voxelToWorld(plant, 0, {8, 0, 8}),
                      top = kelp::test::voxelToWorld(plant, 0, {8, 32, 8});
      lean += (top.x - foot.x) / (plant.to_world[1].y);  // these packs are a metre high
      ++count;
    }
  }
  EXPECT_NEAR(lean / count, 0.07, 0.02);
}

TEST_F(ReefTest, IsTheSameEveryTimeAndAllocatesNothing) {
  const auto first = grow(200), second = grow(200);
  ASSERT_GT(first->instances().size(), 240u);
  first->update(0, 0, kNobody);
  const auto* const place = first->instances().data();
  while (!library_->idle()) std::this_thread::yield();  // its thread allocates
  const long before = kelp::test::newCalls();
  for (int i = 1; i < 50; ++i) first->update(0.03 * i, 0.03f, kNobody);
  EXPECT_EQ(kelp::test::newCalls(), before);
  EXPECT_EQ(first->instances().data(), place);
  for (int i = 0; i < 50; ++i) second->update(0.03 * i, i > 0 ? 0.03f : 0.0f, kNobody);
  for (std::size_t i = 0; i < first->instances().size(); ++i) {
    EXPECT_EQ(first->instances()[i].to_world, second->instances()[i].to_world);
    const auto a = std::as_const(*first->instances()[i].pose).knots(0),
               b = std::as_const(*second->instances()[i].pose).knots(0);
    for (std::size_t k = 0; k < a.size(); ++k) EXPECT_EQ(a[k].position, b[k].position);
  }
}

TEST_F(ReefTest, ReadsOnWheneverItIsAsked) {
  for (int i = 0; i < 3; ++i) {
    while (!library_->idle()) std::this_thread::yield();
    library_->ask();
  }
  while (!library_->idle()) std::this_thread::yield();
  EXPECT_EQ(library_->asset(Species::kFish).residentLevel(0), 0);
  EXPECT_FALSE(library_->damaged());
}

TEST_F(ReefTest, NamesThePackThatIsWrong) {
  std::filesystem::remove(scratch_ / "dulse.kelp");
  std::string wrong;
  const auto library = Library::open(scratch_.folder().string(), wrong);
  ASSERT_FALSE(library);
  EXPECT_EQ(library.error().code, kelp::ErrorCode::kIo);
  EXPECT_EQ(wrong, (scratch_ / "dulse.kelp").string());
}

}  // namespace
}  // namespace underwater
