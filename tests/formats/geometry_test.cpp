// SPDX-License-Identifier: MIT
#include "kelp/formats/geometry.h"

#include <gtest/gtest.h>

#include <random>

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

// The box of the eight corners, each transformed by GLM: the same to the last bit.
TEST(Box, TransformedIsTheBoxOfTheCorners) {
  std::mt19937 random(5);
  std::uniform_real_distribution<float> d(-10, 10);
  for (int n = 0; n < 1000; ++n) {
    Box box;
    for (int i = 0; i < 2; ++i) box.add({d(random), d(random), d(random)});
    glm::mat4 matrix(1.0f);
    for (int column = 0; column < 4; ++column) {
      for (int row = 0; row < 3; ++row) matrix[column][row] = d(random);
    }
    Box corners;
    for (int i = 0; i < 8; ++i) {
      corners.add(glm::vec3(matrix * glm::vec4(i & 1 ? box.min.x : box.max.x, i & 2 ? box.min.y : box.max.y,
                                               i & 4 ? box.min.z : box.max.z, 1)));
    }
    EXPECT_EQ(transformed(matrix, box).min, corners.min);
    EXPECT_EQ(transformed(matrix, box).max, corners.max);
  }
}

}  // namespace
}  // namespace kelp
