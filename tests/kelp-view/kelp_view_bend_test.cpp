// SPDX-License-Identifier: MIT
// kelp-view and swept parts, without its window: the rig editor bends and curls them, the handles and the
// spline are where the part is.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <numbers>

#include "kelp/formats/sweep.h"
#include "model.h"
#include "rig_editor.h"
#include "rig_knots.h"
#include "rig_packs.h"
#include "support/fog_pack.h"
#include "support/scratch.h"

namespace kelp::view {
namespace {

using Kind = Handle::Kind;

constexpr glm::ivec3 kSlim(12, 64, 10), kThick(64, 64, 60);

RigDescription straight(int knots, Bend bend, Axis axis = Axis::kPlusY) {
  RigDescription rig;
  rig.axis = axis;
  rig.bend = bend;
  for (int i = 0; i < knots; ++i)
    rig.knots.push_back({static_cast<float>(i) / static_cast<float>(knots - 1), {}, {}});
  return rig;
}

RawPack slim(const RigDescription& rig, const glm::ivec3& size = kSlim) {
  return packWith(rig, glm::mat3(1), "{}", size);
}

TEST(ViewerBend, IsChangedAndUndoneWithItsRoll) {
  const OpenPack open(slim(straight(3, Bend::kShear)));
  RigEditor editor(*open.pack);
  const RigDescription before = editor.rig(0);
  RigDescription rig = before;
  bendAs(rig, Bend::kSweep);
  EXPECT_EQ(editor.change(0, rig), "");
  editor.endGesture();
  EXPECT_EQ(editor.realized().parts[0].bend, Bend::kSweep);
  for (const double degrees : {10.0, 20.0, 33.3}) {  // one drag
    rig.roll = rollOfDegrees(degrees);
    EXPECT_EQ(editor.change(0, rig), "");
  }
  editor.endGesture();
  EXPECT_EQ(editor.realized().parts[0].roll, rig.roll);
  EXPECT_NE(printRig(editor.rig(0)).find("\"bend\": \"sweep\""), std::string::npos)
      << printRig(editor.rig(0));
  EXPECT_NE(printRig(editor.rig(0)).find("\"roll\": 33.3}"), std::string::npos) << printRig(editor.rig(0));
  EXPECT_EQ(parseRig(printRig(editor.rig(0))), rig);
  bendAs(rig, Bend::kShear);
  EXPECT_EQ(editor.change(0, rig), "") << "a sheared part has no roll";
  editor.endGesture();
  EXPECT_EQ(editor.rig(0), before);
  EXPECT_FALSE(editor.unsaved());

  editor.undo();
  EXPECT_EQ(editor.rig(0).bend, Bend::kSweep);
  EXPECT_EQ(editor.rig(0).roll, rollOfDegrees(33.3));
  EXPECT_TRUE(editor.unsaved());
  editor.undo();
  EXPECT_EQ(editor.rig(0).roll, 0.0f);
  EXPECT_EQ(editor.rig(0).bend, Bend::kSweep);
  editor.undo();
  EXPECT_EQ(editor.rig(0), before);
  EXPECT_FALSE(editor.canUndo());

  // Half a turn is the most, either way.
  bendAs(rig, Bend::kSweep);
  for (const double degrees : {-180.0, 180.0}) {
    rig.roll = rollOfDegrees(degrees);
    EXPECT_EQ(editor.change(0, rig), "") << degrees;
  }
  rig.roll = rollOfDegrees(181);
  EXPECT_NE(editor.change(0, rig).find("/roll"), std::string::npos);
}

TEST(ViewerBend, FogBendsInEitherWay) {
  const OpenPack open(test::fogPack(test::fogOf(glm::ivec3(16), test::puffs), 1));
  RigEditor editor(*open.pack);
  RigDescription rig = editor.rig(0);
  bendAs(rig, Bend::kSweep);
  EXPECT_EQ(editor.change(0, rig), "");
  EXPECT_EQ(editor.rig(0).bend, Bend::kSweep);
  EXPECT_TRUE(editor.unsaved());
}

// Where the handles of a straight part have to be for a curl of so many radians: a circle about the root.
std::vector<Knot> curlOf(float angle, int knots) {
  std::vector<Knot> curl;
  for (int i = 0; i < knots; ++i) {
    const float at = static_cast<float>(i) / static_cast<float>(knots - 1), turn = at * angle;
    const glm::vec3 on =
        angle > 0 ? glm::vec3(1 - std::cos(turn), std::sin(turn), 0) / angle : glm::vec3(0, at, 0);
    curl.push_back({at, on, {std::sin(turn), std::cos(turn), 0}});
  }
  return curl;
}

TEST(ViewerBend, ACurlIsMadeWithHandlesAndKept) {
  constexpr int kKnots = 5;
  const float three_quarters = 1.5f * std::numbers::pi_v<float>;
  for (const Axis axis : {Axis::kPlusY, Axis::kMinusX}) {
    SCOPED_TRACE(toString(axis));
    const OpenPack open(slim(straight(kKnots, Bend::kSweep, axis)));
    RigEditor editor(*open.pack);
    const RigDescription before = editor.rig(0);
    const auto knotNow = [&](int knot) {
      return editor.realized().parts[0].knots[static_cast<std::size_t>(knot)];
    };
    for (int step = 1; step <= 54; ++step) {
      const std::vector<Knot> wanted = curlOf(three_quarters * static_cast<float>(step) / 54, kKnots);
      for (int knot = 0; knot < kKnots; ++knot) {
        const Knot& to = wanted[static_cast<std::size_t>(knot)];
        ASSERT_EQ(editor.pull({0, knot, Kind::kKnot}, to.position - knotNow(knot).position), "") << step;
        ASSERT_EQ(editor.pull({0, knot, Kind::kTangent}, to.tangent - knotNow(knot).tangent), "") << step;
      }
    }
    const std::vector<Knot> curl = curlOf(three_quarters, kKnots);
    for (int knot = 0; knot < kKnots; ++knot) {
      expectNear(knotNow(knot).position, curl[static_cast<std::size_t>(knot)].position, 3e-5f);
      expectNear(knotNow(knot).tangent, curl[static_cast<std::size_t>(knot)].tangent, 3e-5f);
    }
    EXPECT_LT(knotNow(3).tangent.y, -0.9f) << "down";
    expectNear(knotNow(4).tangent, {-1, 0, 0}, 3e-5f);
    EXPECT_EQ(parseRig(printRig(editor.rig(0))), editor.rig(0));
    // Sheared it would turn back; the knot and its place are said.
    RigDescription sheared = editor.rig(0);
    bendAs(sheared, Bend::kShear);
    const std::string refused = editor.change(0, sheared);
    EXPECT_NE(refused.find("knot 1 (at 0.25): the spline turns back"), std::string::npos) << refused;
    editor.endGesture();
    editor.undo();
    EXPECT_EQ(editor.rig(0), before) << "one gesture";
  }
}

TEST(ViewerBend, AHandleThatWouldFoldThePartComesAsNearAsItGets) {
  const OpenPack open(slim(straight(2, Bend::kSweep), kThick));
  RigEditor editor(*open.pack);
  const glm::vec3 target(2, -3, 0);
  const auto now = [&] { return editor.realized().parts[0].knots[1].tangent; };
  std::string said;
  for (int frame = 0; frame < 30; ++frame) said = editor.pull({0, 1, Kind::kTangent}, target - now());
  EXPECT_NE(said.find("knot 0 (at 0): "), std::string::npos) << said;
  EXPECT_GT(glm::distance(now(), glm::vec3(0, 1, 0)), 0.3f) << "it went on";
  std::vector<Knot> knots = editor.realized().parts[0].knots;
  EXPECT_TRUE(checkSweep(knots, kThick));
  knots[1].tangent += (target - now()) / 32.0f;
  EXPECT_FALSE(checkSweep(knots, kThick)) << "it could have gone on";
  editor.endGesture();
  editor.undo();
  EXPECT_EQ(now(), glm::vec3(0, 1, 0));
  EXPECT_FALSE(editor.canUndo()) << "one gesture";
}

// A part that goes up, over to the side and down again, rolled.
RigDescription hook() {
  RigDescription rig = straight(3, Bend::kSweep);
  rig.roll = 0.6f;
  rig.knots = {{0, {0, 0, 0}, glm::vec3(0, 1.6f, 0)},
               {0.5f, {0.5f, 0, 0.1f}, glm::vec3(1.6f, 0, 0)},
               {1, {1, -1, 0.2f}, glm::vec3(0, -1.6f, 0.3f)}};
  rig.sockets = {{"side", 0.7f, {0.1f, 0, 0.05f}, {1, 0, 0, 0}}};
  return rig;
}

class SweptViewer : public ::testing::Test {
 protected:
  void open(const RigDescription& rig, const glm::ivec3& size = kSlim) {
    auto opened = Model::open(scratch_.write("model.kelp", test::bytesOf(slim(rig, size))).string());
    ASSERT_TRUE(opened) << describe(opened.error());
    model_ = *std::move(opened);
    camera_.resize({800, 600});
    camera_.frame(bounds(model_->instance()));
  }
  glm::vec2 pixelOf(const Handle& handle) const { return camera_.project(position(*model_, handle)).value(); }
  const Part& part() const { return model_->asset().pack().parts()[0]; }
  ArcChain chain() const {
    ArcChain made;
    EXPECT_TRUE(makeArcs(model_->instance().pose->knots(0), part().size,
                         part().roll + model_->instance().pose->motion(0)->roll, 1e-5f, made));
    return made;
  }
  glm::vec3 inWorld(const glm::vec3& voxel) const {
    return glm::vec3(partToWorld(model_->instance(), 0).value() * glm::vec4(voxel, 1));
  }

  const test::Scratch scratch_;
  std::unique_ptr<Model> model_;
  OrbitCamera camera_;
};

// The pack stands 0.02 meters for each voxel.
constexpr float kHeight = 0.02f * 64;

TEST_F(SweptViewer, HandlesSplineAndSocketsAreWhereThePartIs) {
  open(hook());
  const ArcChain arcs = chain();
  for (int knot = 0; knot < 3; ++knot) {
    const glm::mat4x3 section = sectionAt(arcs, 64 * part().knots[static_cast<std::size_t>(knot)].at);
    const glm::vec3 at = position(*model_, {0, knot, Kind::kKnot});
    expectNear(at, inWorld(section[3]), 1e-4f * kHeight);
    expectNear(glm::normalize(position(*model_, {0, knot, Kind::kTangent}) - at),
               glm::normalize(inWorld(section[3] + section[1]) - inWorld(section[3])), 2e-3f);
  }
  // The spline against the center line, as far as arcs and cubics differ: each point has one beside it.
  const std::vector<glm::vec3> spline = splineOf(*model_, 0);
  const auto nearest = [](const glm::vec3& point, const std::vector<glm::vec3>& line) {
    float best = INFINITY;
    for (std::size_t i = 0; i + 1 < line.size(); ++i) {
      const glm::vec3 along = line[i + 1] - line[i];
      const float t = glm::clamp(glm::dot(point - line[i], along) / glm::dot(along, along), 0.0f, 1.0f);
      best = std::min(best, glm::distance(point, line[i] + t * along));
    }
    return best;
  };
  std::vector<glm::vec3> center;
  for (int i = 0; i <= 256; ++i) center.push_back(inWorld(sectionAt(arcs, 0.25f * static_cast<float>(i))[3]));
  for (const glm::vec3& point : spline) EXPECT_LT(nearest(point, center), kHeight / 1000);
  for (const glm::vec3& point : center) EXPECT_LT(nearest(point, spline), kHeight / 1000);

  const PackRig rig = rigOf(model_->asset().pack());
  const glm::mat4 frame = socketFrame(*model_, rig.sockets[0]);
  const glm::mat4x3 section = sectionAt(arcs, 0.7f * 64);
  expectNear(glm::vec3(frame[3]), inWorld(section[3] + 6.4f * section[0] + 3.2f * section[2]),
             1e-3f * kHeight);
  for (int axis = 0; axis < 3; ++axis) expectNear(glm::vec3(frame[axis]), section[axis], 1e-2f);
}

TEST_F(SweptViewer, ATangentIsDraggedBeyondTheHorizontal) {
  RigDescription arch = straight(3, Bend::kSweep);
  arch.knots = {{0, {0, 0, 0}, glm::vec3(0, 1.5f, 0)},
                {0.5f, {0.4f, 0, 0}, glm::vec3(1.2f, 0.4f, 0)},
                {1, {1, -0.6f, 0}, glm::vec3(1.2f, 0.2f, 0)}};
  open(arch);
  const Handle tip{0, 2, Kind::kTangent};
  const glm::vec2 knot = pixelOf({0, 2, Kind::kKnot});
  const float reach = glm::distance(pixelOf(tip), knot);
  for (int degrees = 0; degrees <= 70; degrees += 10) {  // below the horizontal
    const float turn = glm::radians(static_cast<float>(degrees));
    const glm::vec2 mouse = knot + reach * glm::vec2(std::cos(turn), std::sin(turn));
    drag(*model_, tip, camera_, mouse);
    model_->pose(0);
    EXPECT_TRUE(model_->instance().pose->check());
    EXPECT_LT(glm::distance(pixelOf(tip), mouse), 0.1f) << degrees;
  }
  EXPECT_LT(model_->knot(0, 2).tangent.y, -0.5f);
}

TEST_F(SweptViewer, ARollPlaysAtOnceAndAnotherBendIsReread) {
  open(hook());
  PackRig rig = rigOf(model_->asset().pack());
  const auto corner = [](const Model& model) {
    return toWorld(model.instance(), 0, model.asset().pack().parts()[0].to_object * glm::vec4(12, 50, 0, 1))
        .value();
  };
  const glm::vec3 before = corner(*model_);
  const auto bakedWith = [&](const RigDescription& wanted) {
    auto baked = Model::open(scratch_.write("baked.kelp", test::bytesOf(slim(wanted))).string());
    EXPECT_TRUE(baked);
    return *std::move(baked);
  };
  for (const float roll : {-1.0f, 3.0f}) {
    RigDescription turned = hook();
    turned.roll = roll;
    rig.parts[0].roll = roll;
    ASSERT_TRUE(model_->fits(rig));
    ASSERT_TRUE(model_->setRig(rig));
    model_->pose(0.3);
    EXPECT_GT(glm::distance(corner(*model_), before), 0.05f * kHeight);
    expectNear(corner(*model_), corner(*bakedWith(turned)), 1e-5f);
  }
  RigDescription other = straight(3, Bend::kSweep);
  other.knots[2].offset = {0.3f, 0, 0};
  open(other);
  bendAs(other, Bend::kShear);
  const PackRig sheared = rigOf(bakedWith(other)->asset().pack());
  EXPECT_FALSE(model_->fits(sheared));
  EXPECT_FALSE(model_->setRig(sheared));
  const auto again = model_->rerigged(sheared);
  ASSERT_TRUE(again) << describe(again.error());
  expectNear(corner(**again), corner(*bakedWith(other)), 1e-6f);
  EXPECT_GT(glm::distance(corner(**again), corner(*model_)), 0.01f * kHeight);
}

}  // namespace
}  // namespace kelp::view
