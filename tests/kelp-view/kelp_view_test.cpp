// SPDX-License-Identifier: MIT
// kelp-view without its window: what the mouse takes hold of, and where it goes.
#include <gtest/gtest.h>

#include <filesystem>

#include "arguments.h"
#include "handles.h"
#include "support/scratch.h"
#include "support/test_pack.h"
#include "support/voxel_knots.h"

namespace kelp::view {
namespace {

constexpr glm::vec2 kWindow{800, 600};

class Viewer : public ::testing::Test {
 protected:
  void SetUp() override {
    RawPack pack = test::packOf(
        test::ballClump({40, 64, 32}, 12, 1),
        test::inHeights(
            {{0, {0, 0, 0}, {0, 64, 0}}, {0.5f, {3, 32, 0}, {10, 64, 0}}, {1, {0, 64, 2}, {0, 64, 5}}}, 64));
    pack.clips.push_back({"sway", 2, {{0, 2, Target::kKnotOffset, {0.09375f, 0, 0.015625f}, 2, 0}}, {}});
    auto opened = Model::open(scratch_.write("model.kelp", test::bytesOf(pack)).string());
    ASSERT_TRUE(opened) << describe(opened.error());
    model_ = *std::move(opened);
    camera_.resize(kWindow);
    camera_.frame(bounds(model_->instance()));
  }

  glm::vec2 pixelOf(const Handle& handle) const { return camera_.project(position(*model_, handle)).value(); }

  float depthOf(const Handle& handle) const {
    return (camera_.worldToEye() * glm::vec4(position(*model_, handle), 1)).z;
  }

  const test::Scratch scratch_;
  std::unique_ptr<Model> model_;
  OrbitCamera camera_;
};

TEST_F(Viewer, EveryKnotHasTwoHandles) { EXPECT_EQ(handlesOf(*model_).size(), 6u); }

TEST_F(Viewer, KnotsStandOnTheMiddleOfTheModel) {  // meters: one high, foot at the origin
  EXPECT_LT(glm::distance(position(*model_, {0, 0, Handle::Kind::kKnot}), glm::vec3(0)), 1e-5f);
  EXPECT_LT(glm::distance(position(*model_, {0, 2, Handle::Kind::kKnot}), glm::vec3(0, 1, 2.0f / 64)), 1e-5f);
}

TEST_F(Viewer, RayOfAPixelMeetsWhatIsProjectedThere) {
  for (const glm::vec2 turn : {glm::vec2(0), glm::vec2(100, 40), glm::vec2(-300, -150)}) {
    camera_.orbit(turn);
    for (const Handle& handle : handlesOf(*model_)) {
      const glm::vec3 at = position(*model_, handle);
      const runtime::Ray ray = camera_.ray(pixelOf(handle));
      const glm::vec3 along = glm::normalize(ray.direction);
      EXPECT_LT(glm::length(glm::cross(at - ray.origin, along)), 1e-4f);
      EXPECT_GT(glm::dot(at - ray.origin, along), 0);
    }
  }
}

TEST_F(Viewer, TheWholeModelIsInThePictureHoweverItTurns) {
  const Box box = bounds(model_->instance());
  for (int i = 0; i < 20; ++i) {
    camera_.orbit({57, i % 2 == 0 ? 90 : -60});
    for (int corner = 0; corner < 8; ++corner) {
      const glm::vec3 at(corner & 1 ? box.max.x : box.min.x, corner & 2 ? box.max.y : box.min.y,
                         corner & 4 ? box.max.z : box.min.z);
      const std::optional<glm::vec2> pixel = camera_.project(at);
      ASSERT_TRUE(pixel);
      EXPECT_TRUE(pixel->x > 0 && pixel->y > 0 && pixel->x < kWindow.x && pixel->y < kWindow.y)
          << pixel->x << " " << pixel->y;
    }
  }
}

TEST_F(Viewer, PickFindsTheNearestHandleOrNone) {
  for (const Handle& handle : handlesOf(*model_))
    EXPECT_EQ(pick(*model_, camera_, pixelOf(handle) + glm::vec2(1, -1), 12), handle);
  EXPECT_EQ(pick(*model_, camera_, {5, 5}, 12), std::nullopt);
}

TEST_F(Viewer, ADraggedHandleFollowsTheMouse) {
  for (const double seconds : {0.0, 0.4}) {  // at rest and while the clip sways
    for (const Handle& handle : handlesOf(*model_)) {
      model_->forgetEdits();
      model_->pose(seconds);
      camera_.orbit({130, 25});
      for (int move = 1; move <= 3; ++move) {
        const glm::vec2 mouse = pixelOf(handle) + glm::vec2(15 * move, -4);
        const float depth = depthOf(handle);
        drag(*model_, handle, camera_, mouse);
        model_->pose(seconds);
        EXPECT_NEAR(depthOf(handle), depth, 1e-4f);
        EXPECT_LT(glm::distance(pixelOf(handle), mouse), 0.1f)
            << "knot " << handle.knot << " tangent " << (handle.kind == Handle::Kind::kTangent);
      }
      EXPECT_TRUE(model_->edited());
    }
  }
}

TEST_F(Viewer, APoseThatWouldTurnBackStaysMonotoneAndTheWayBackIsShort) {
  const Handle top{0, 2, Handle::Kind::kKnot};
  const glm::vec2 start = pixelOf(top);
  for (int move = 1; move <= 5; ++move) {  // far below the foot
    drag(*model_, top, camera_, start + glm::vec2(0, 150 * move));
    model_->pose(0);
    EXPECT_TRUE(model_->instance().pose->check());
  }
  drag(*model_, top, camera_, start);
  model_->pose(0);
  EXPECT_LT(glm::distance(pixelOf(top), start), 0.1f);
  model_->forgetEdits();
  model_->pose(0);
  EXPECT_FALSE(model_->edited());
  EXPECT_LT(glm::distance(pixelOf(top), start), 0.1f);
}

TEST_F(Viewer, TheSplineRunsThroughTheKnots) {
  const std::vector<glm::vec3> spline = splineOf(*model_, 0);
  ASSERT_EQ(spline.size(), 49u);
  for (const int knot : {0, 1, 2}) {
    EXPECT_LT(glm::distance(spline[static_cast<std::size_t>(24 * knot)],
                            position(*model_, {0, knot, Handle::Kind::kKnot})),
              1e-5f);
  }
}

TEST(ViewerModel, SaysWhyAFileIsNotShown) {
  const auto absent = Model::open("/nonexistent/reed.kelp");
  ASSERT_FALSE(absent);
  EXPECT_EQ(absent.error().code, ErrorCode::kIo);
  const auto text = Model::open(std::string(KELP_SOURCE_DIR) + "/LICENSE");
  ASSERT_FALSE(text);
  EXPECT_EQ(text.error().code, ErrorCode::kNotAPack);
}

TEST(Surfaces, AreAnOption) {
  std::string wrong;
  for (int i = 0; i < static_cast<int>(Surface::kCount); ++i) {
    const auto surface = static_cast<Surface>(i);
    const char* const words[] = {"kelp-view", "--view", toString(surface), "fox.kelp"};
    const auto arguments = parseArguments(4, words, wrong);
    ASSERT_TRUE(arguments) << wrong;
    EXPECT_EQ(arguments->surface, surface);
    EXPECT_EQ(arguments->pack, "fox.kelp");
  }
  for (const char* const bad : {"nonsense", "fit"}) {
    const char* const words[] = {"kelp-view", "--view", bad};
    EXPECT_FALSE(parseArguments(3, words, wrong));
    EXPECT_FALSE(parseArguments(2, words, wrong));
  }
}

}  // namespace
}  // namespace kelp::view
