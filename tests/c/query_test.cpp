// SPDX-License-Identifier: MIT
// Bounds, points, frames, rays and distances are those of C++.
#include <limits>

#include "both.h"

namespace kelp::test {
namespace {

constexpr float kEndless = std::numeric_limits<float>::infinity();

TEST(CInstance, PointsAndFramesAreThoseOfCpp) {
  const BothAssets assets(packFile("distance"));
  const BothInstances instances(assets);
  Dice dice;
  for (std::size_t i = 0; i < instances.c.size(); ++i) {
    const kelp_instance& c = instances.c[i];
    const runtime::Instance& cpp = instances.cpp[i];
    kelp_box box = {};
    ASSERT_KELP(kelp_instance_get_bounds(&c, &box));
    expectSame(box, bounds(cpp), "bounds");
    glm::mat4 one(0), two[2] = {}, expected[2];
    partsToWorld(cpp, expected).value();
    ASSERT_KELP(kelp_instance_parts_to_world(&c, &two[0][0].x, 2));
    EXPECT_EQ(expected[0], two[0]);
    EXPECT_EQ(expected[1], two[1]);
    for (int part = 0; part < 2; ++part) {
      ASSERT_KELP(kelp_instance_part_to_world(&c, part, &one[0].x));
      EXPECT_EQ(partToWorld(cpp, part).value(), one);
      ASSERT_KELP(kelp_instance_socket_to_world(&c, part, &one[0].x));
      EXPECT_EQ(socketToWorld(cpp, part).value(), one);
      for (int k = 0; k < 20; ++k) {
        const glm::vec3 rest = glm::vec3(0, 12, 0) + dice.vec3(4);
        glm::vec3 world(0), back(-1);
        ASSERT_KELP(kelp_instance_to_world(&c, part, &rest.x, &world.x));
        EXPECT_EQ(toWorld(cpp, part, rest).value(), world);
        ASSERT_KELP(kelp_instance_frame_at(&c, part, &rest.x, &one[0].x));
        EXPECT_EQ(frameAt(cpp, part, rest).value(), one);
        kelp_bool found = 7;
        ASSERT_KELP(kelp_instance_to_rest(&c, part, &world.x, &back.x, &found));
        const auto expected_rest = toRest(cpp, part, world);
        ASSERT_EQ(expected_rest.has_value(), found != 0);
        EXPECT_EQ(expected_rest.value_or(glm::vec3(-1)), back);
      }
    }
    EXPECT_KELP(KELP_ERROR_MISUSE, kelp_instance_part_to_world(&c, 2, &one[0].x));
    EXPECT_KELP(KELP_ERROR_MISUSE, kelp_instance_parts_to_world(&c, &one[0].x, 3));
    EXPECT_KELP(KELP_ERROR_MISUSE, kelp_instance_socket_to_world(&c, -1, &one[0].x));
  }
}

TEST(CInstance, RaysHitWhatTheyHitInCpp) {
  const BothAssets assets(packFile("distance"));
  const BothInstances instances(assets);
  Dice dice;
  int hits = 0;
  for (int i = 0; i < 2000; ++i) {
    const glm::vec3 from = glm::vec3(14, 12, 0) + dice.vec3(30);
    const glm::vec3 aim = toWorld(instances.cpp[i % 3], 0, glm::vec3(0, 12, 0) + dice.vec3(12)).value();
    const runtime::Ray ray{from, aim - from, i % 5 == 0 ? 0.9f : 1e30f};
    const auto expected = raycast(instances.cpp, ray, i % 2);
    auto answer = sized<kelp_raycast_answer>();
    ASSERT_KELP(kelp_raycast(instances.c.data(), instances.kCount, &ray.origin.x, &ray.direction.x, ray.t_max,
                             i % 2, &answer));
    ASSERT_EQ(expected.has_value(), answer.found != 0);
    if (!expected) continue;
    ++hits;
    EXPECT_EQ(expected->t, answer.t);
    expectSame(answer.position, expected->position, "position");
    expectSame(answer.normal, expected->normal, "normal");
    expectSame(answer.rest, expected->rest, "rest");
    expectSame(answer.voxel, expected->voxel, "voxel");
    EXPECT_EQ(expected->instance, answer.instance);
    EXPECT_EQ(expected->part, answer.part);
    EXPECT_EQ(expected->level, answer.level);
    EXPECT_EQ(expected->material, answer.material);
  }
  EXPECT_GT(hits, 50);
}

TEST(CDistance, AnswersAreThoseOfCpp) {
  const BothAssets assets(packFile("distance"));
  const BothInstances instances(assets);
  std::vector<Box> boxes;
  std::vector<kelp_box> c_boxes(instances.kCount);
  for (std::size_t i = 0; i < instances.kCount; ++i) {
    boxes.push_back(bounds(instances.cpp[i]));
    ASSERT_KELP(kelp_instance_get_bounds(&instances.c[i], &c_boxes[i]));
  }
  Dice dice;
  int overlapping = 0, casts = 0;
  for (int i = 0; i < 300; ++i) {
    const bool boxed = i % 2 == 0;
    const std::span<const Box> around = boxed ? std::span<const Box>(boxes) : std::span<const Box>();
    const kelp_box* const c_around = boxed ? c_boxes.data() : nullptr;
    const std::uint32_t count = instances.kCount;
    const glm::vec3 point = glm::vec3(14, 12, 0) + dice.vec3(20), other = point + dice.vec3(25);

    auto far = sized<kelp_distance_answer>();
    ASSERT_KELP(kelp_distance(instances.c.data(), count, c_around, &point.x, &far));
    const runtime::Distance expected = distance(instances.cpp, point, around).value();
    EXPECT_EQ(expected.bound, far.bound);
    expectSame(far.away, expected.away, "away");
    EXPECT_EQ(expected.instance, far.instance);
    EXPECT_EQ(expected.part.value_or(KELP_NONE), far.part);
    EXPECT_EQ(expected.level, far.level);

    auto closest = sized<kelp_closest_point_answer>();
    const float reach = i % 3 == 0 ? 5 : kEndless;
    ASSERT_KELP(kelp_closest_point(instances.c.data(), count, c_around, &point.x, reach, &closest));
    const runtime::ClosestPoint nearest = closestPoint(instances.cpp, point, reach, around).value();
    EXPECT_EQ(nearest.distance, closest.distance);
    expectSame(closest.point, nearest.point, "point");
    EXPECT_EQ(nearest.instance, closest.instance);
    EXPECT_EQ(nearest.part.value_or(KELP_NONE), closest.part);
    EXPECT_EQ(nearest.ran_out, closest.ran_out != 0);

    std::int32_t found = -9;
    ASSERT_KELP(kelp_overlaps_sphere(instances.c.data(), count, c_around, &point.x, 2, &found));
    EXPECT_EQ(overlaps(instances.cpp, runtime::Sphere{point, 2}, around).value().value_or(KELP_NONE), found);
    overlapping += found >= 0;
    ASSERT_KELP(kelp_overlaps_capsule(instances.c.data(), count, c_around, &point.x, &other.x, 1, &found));
    EXPECT_EQ(overlaps(instances.cpp, runtime::Capsule{point, other, 1}, around).value().value_or(KELP_NONE),
              found);
    overlapping += found >= 0;
    const glm::vec3 half(1, 2, 3);
    const float turn[4] = {0, 0.6f, 0, 0.8f};
    ASSERT_KELP(kelp_overlaps_box(instances.c.data(), count, c_around, &point.x, &half.x, turn, &found));
    EXPECT_EQ(overlaps(instances.cpp, runtime::OrientedBox{point, half, glm::quat(0.8f, 0, 0.6f, 0)}, around)
                  .value()
                  .value_or(KELP_NONE),
              found);

    auto cast = sized<kelp_sphere_cast_answer>();
    ASSERT_KELP(kelp_sphere_cast(instances.c.data(), count, c_around, &point.x, &other.x, 0.5f, &cast));
    const runtime::SphereCast moved = sphereCast(instances.cpp, point, other, 0.5f, around).value();
    EXPECT_EQ(moved.hit, cast.hit != 0);
    casts += moved.hit;
    EXPECT_EQ(moved.t, cast.t);
    expectSame(cast.center, moved.center, "center");
    expectSame(cast.away, moved.away, "away");
    EXPECT_EQ(moved.instance, cast.instance);
    EXPECT_EQ(moved.part.value_or(KELP_NONE), cast.part);
    EXPECT_EQ(moved.ran_out, cast.ran_out != 0);
  }
  EXPECT_GT(overlapping, 20);
  EXPECT_GT(casts, 20);
}

// A list of one is what C++ asks one instance.
TEST(CDistance, OneInstance) {
  const BothAssets assets(packFile("distance"));
  const BothInstances instances(assets);
  Dice dice;
  for (std::size_t i = 0; i < 90; ++i) {
    const kelp_instance* const c = &instances.c[i % 3];
    const runtime::Instance& cpp = instances.cpp[i % 3];
    const glm::vec3 point = glm::vec3(14, 12, 0) + dice.vec3(20), other = point + dice.vec3(25);
    auto far = sized<kelp_distance_answer>();
    ASSERT_KELP(kelp_distance(c, 1, nullptr, &point.x, &far));
    EXPECT_EQ(distance(cpp, point).value().bound, far.bound);
    auto closest = sized<kelp_closest_point_answer>();
    ASSERT_KELP(kelp_closest_point(c, 1, nullptr, &point.x, kEndless, &closest));
    expectSame(closest.point, closestPoint(cpp, point).value().point, "point");
    std::int32_t found = -9;
    ASSERT_KELP(kelp_overlaps_sphere(c, 1, nullptr, &point.x, 2, &found));
    EXPECT_EQ(overlaps(cpp, runtime::Sphere{point, 2}).value().value_or(KELP_NONE), found);
    auto cast = sized<kelp_sphere_cast_answer>();
    ASSERT_KELP(kelp_sphere_cast(c, 1, nullptr, &point.x, &other.x, 0.5f, &cast));
    EXPECT_EQ(sphereCast(cpp, point, other, 0.5f).value().t, cast.t);
  }
}

TEST(CDistance, AssetsWithoutDistancesAreTheErrorsOfCpp) {
  const glm::vec3 point(1);
  for (const char* const name : {"distance", "solid"}) {
    const BothAssets assets(packFile(name), std::string(name) == "solid" ? 0 : -1);
    const kelp_instance instance = instanceOf(assets.c, {});
    auto answer = sized<kelp_distance_answer>();
    const auto expected = distance(runtime::Instance{assets.cpp.get()}, point);
    ASSERT_FALSE(expected);
    EXPECT_KELP(static_cast<int>(expected.error().code),
                kelp_distance(&instance, 1, nullptr, &point.x, &answer));
    EXPECT_STREQ(expected.error().detail, lastError().text);
  }
}

}  // namespace
}  // namespace kelp::test
