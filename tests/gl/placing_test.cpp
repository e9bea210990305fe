// SPDX-License-Identifier: MIT
// Parts as four lanes place them are those of the lanes that this processor has, to the last bit, so that pictures and picks do not depend on the
// processor. picture_test.cpp and proxy_test.cpp compare them with the truth.
#include "placing_steps.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <random>

#include <glm/gtc/matrix_transform.hpp>

namespace kelp::test {
namespace {

using namespace gl;

// What all steps come to; all bytes are zero before.
struct Everything {
  PlacedParts placed;
  JudgedParts judged;
  EightFloats sides;
  RecordHead heads[8];
};

void compute(const PlacingSteps& steps, const Camera& camera, const View& view, Rays rays, const PosedParts& parts, Everything& out) {
  std::memset(static_cast<void*>(&out), 0, sizeof out);
  ASSERT_EQ(boundParts(parts, out.placed), 255u);
  RecordHead* heads[8];
  for (int part = 0; part < 8; ++part) heads[part] = &out.heads[part];
  for (int first = 0; first < 8; first += steps.lanes) steps.place(camera, parts, first, out.placed);
  for (int first = 0; first < 8; first += steps.lanes) steps.judge(camera, view, rays, first, out.placed, out.judged);
  for (int first = 0; first < 8; first += steps.lanes) steps.findSides(camera.eye.w == 0, out.placed, first, out.sides);
  for (int first = 0; first < 8; first += steps.lanes) steps.writeHeads(camera, first, out.placed, heads);
}

TEST(Placing, FourLanesAndEightComeToTheSameBits) {
  if (widestLanes().lanes == 4) GTEST_SKIP() << "this processor has four lanes, or this compiler makes no more";
  std::mt19937 random(11);
  std::uniform_real_distribution<float> unit(-1, 1);
  const auto vector = [&] { return glm::vec3(unit(random), unit(random), unit(random)); };
  unsigned seen = 0;
  for (int n = 0; n < 500; ++n) {
    View view;
    view.viewport = {1280, 720};
    view.world_to_eye = glm::lookAt(3.0f * vector(), vector(), glm::vec3(0, 1, 0));
    view.eye_to_clip = n % 3 == 0 ? glm::ortho(-2.0f, 2.0f, -1.0f, 1.0f, -5.0f, 20.0f) : glm::perspective(1.0f, 1.7f, 0.1f, 100.0f);
    view.smallest_pixels = 2;
    const auto camera = makeCamera(view);
    ASSERT_TRUE(camera);
    PosedParts parts;
    glm::mat4 worlds[8];
    glm::mat4x3 objects[8];
    glm::vec4 extents[8];
    Knot knots[8][2];
    for (std::size_t part = 0; part < 8; ++part) {
      const glm::ivec3 size(1 + random() % 200, 1 + random() % 200, 1 + random() % 200);
      worlds[part] = glm::scale(glm::rotate(glm::translate(glm::mat4(1), 4.0f * vector()), 3.0f * unit(random), vector()), 1.1f + vector());
      objects[part] = glm::mat4x3(glm::scale(glm::mat4(1), glm::vec3(0.01f * (1.2f + unit(random)))));
      straightKnots(size, knots[part]);
      knots[part][1].position += glm::vec3(9.0f * unit(random), 0, 9.0f * unit(random));
      extents[part] = glm::vec4(glm::vec3(size), 1 + part % 7);
      parts.knots[part] = knots[part], parts.to_world[part] = &worlds[part], parts.to_object[part] = &objects[part], parts.extents[part] = &extents[part];
    }
    const Rays rays = n % 5 == 0 ? Rays::kAny : Rays::kView;
    Everything four, widest;
    compute(fourLanes(), *camera, view, rays, parts, four);
    compute(widestLanes(), *camera, view, rays, parts, widest);
    ASSERT_EQ(std::memcmp(&four, &widest, sizeof four), 0) << n;
    for (unsigned part = 0; part < 8; ++part) seen += widest.judged.seen >> part & 1;
  }
  EXPECT_GT(seen, 500u);
  EXPECT_LT(seen, 3500u);
}

}  // namespace
}  // namespace kelp::test
