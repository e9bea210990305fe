// SPDX-License-Identifier: MIT
#include "kelp/formats/geometry.h"

#include <gtest/gtest.h>

namespace kelp {
namespace {

TEST(Box, IsEmptyUntilSomethingIsAdded) {
  Box box;
  EXPECT_TRUE(box.empty());
  box.add({1, 2, 3});
  EXPECT_FALSE(box.empty());
  EXPECT_EQ(box.min, box.max);
  box.add({-1, 5, 3});
  EXPECT_EQ(box.min, glm::vec3(-1, 2, 3));
  EXPECT_EQ(box.max, glm::vec3(1, 5, 3));
}

TEST(Box, TransformedHoldsAllCorners) {
  Box box;
  box.add({0, 0, 0});
  box.add({1, 2, 3});
  // A quarter turn about z takes (x, y) to (-y, x).
  glm::mat4 turn(1.0f);
  turn[0] = glm::vec4(0, 1, 0, 0);
  turn[1] = glm::vec4(-1, 0, 0, 0);
  turn[3] = glm::vec4(10, 20, 30, 1);
  const Box result = transformed(turn, box);
  EXPECT_EQ(result.min, glm::vec3(8, 20, 30));
  EXPECT_EQ(result.max, glm::vec3(10, 21, 33));
  EXPECT_TRUE(transformed(turn, Box()).empty());
}

}  // namespace
}  // namespace kelp
