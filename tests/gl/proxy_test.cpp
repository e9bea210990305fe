// SPDX-License-Identifier: MIT
// The proxy covers each ray that meets a part's bounds, once, wherever the eye is: the outline's triangles,
// and what comes of them on the GPU.
#include <cmath>
#include <random>

#include <glm/gtc/matrix_transform.hpp>

#include "canvas.h"
#include "placing.h"

namespace kelp::test {
namespace {

using glm::dvec3;

// The stretch of o + s d inside a box; empty if the first is above the second.
std::pair<double, double> insideOf(const dvec3& low, const dvec3& high, const dvec3& o, const dvec3& d) {
  double enter = -1e300, leave = 1e300;
  for (int axis = 0; axis < 3; ++axis) {
    const double a = (low[axis] - o[axis]) / d[axis], b = (high[axis] - o[axis]) / d[axis];
    enter = std::max(enter, std::min(a, b));
    leave = std::min(leave, std::max(a, b));
  }
  return {enter, leave};
}

// True if the ray's half-line goes through the triangle: on one side of the three planes through the eye and
// an edge. Orthographic: along d, from anywhere.
bool meets(const dvec3 (&corners)[3], const dvec3& d) {
  const double a = glm::determinant(glm::dmat3(corners[0], corners[1], d)),
               b = glm::determinant(glm::dmat3(corners[1], corners[2], d)),
               c = glm::determinant(glm::dmat3(corners[2], corners[0], d));
  if (!((a > 0 && b > 0 && c > 0) || (a < 0 && b < 0 && c < 0))) return false;
  const dvec3 normal = glm::cross(corners[1] - corners[0], corners[2] - corners[0]);
  return glm::dot(normal, corners[0]) * glm::dot(normal, d) > 0;  // before the eye
}

// That of one of eight parts; the others have their eyes elsewhere.
std::uint32_t outlineOf(const glm::vec4& eye, const Box& bounds, std::size_t which) {
  draw::PlacedParts placed;
  for (int axis = 0; axis < 3; ++axis) {
    for (std::size_t part = 0; part < 8; ++part) {
      placed.bounds.min[axis].of[part] = bounds.min[axis];
      placed.bounds.max[axis].of[part] = bounds.max[axis];
      placed.eye[axis].of[part] = part == which ? eye[axis] : static_cast<float>(part) * bounds.max[axis];
    }
  }
  std::uint32_t outlines[8];
  draw::outlineParts(eye.w == 0, placed, outlines);
  return outlines[which];
}

TEST(Outline, EveryRayThatMeetsTheBoundsMeetsOneTriangle) {
  std::mt19937 random(7);
  std::uniform_real_distribution<float> unit(-1, 1);
  int near = 0, met = 0;
  for (int n = 0; n < 20000; ++n) {
    const glm::vec3 half(std::pow(10.0f, unit(random)), std::pow(10.0f, unit(random)),
                         std::pow(10.0f, unit(random)));
    const glm::vec3 middle(5 * unit(random), 5 * unit(random), 5 * unit(random));
    const Box bounds{middle - half, middle + half};
    const bool orthographic = n % 4 == 0;
    // Near and far, and within the slabs of every set of axes.
    const float far = n % 3 == 0 ? 30.0f : 1.5f;
    glm::vec4 eye(middle + far * glm::vec3(unit(random), unit(random), unit(random)) * half, 1);
    if (orthographic) eye = glm::vec4(glm::normalize(glm::vec3(unit(random), unit(random), unit(random))), 0);
    const std::uint32_t outline = outlineOf(eye, bounds, static_cast<std::size_t>(n) % 8);
    const dvec3 low(bounds.min), high(bounds.max);
    if (outline == 0) {
      ASSERT_FALSE(orthographic);
      const double close = glm::length(dvec3(eye) - glm::clamp(dvec3(eye), low, high));
      ASSERT_LE(close, 2 * std::sqrt(3.0) / 16 * std::max({half.x, half.y, half.z}) * 1.001);
      ++near;
      continue;
    }
    for (int k = 0; k < 20; ++k) {
      const dvec3 through =
          dvec3(middle) + 1.3 * dvec3(unit(random), unit(random), unit(random)) * dvec3(half);
      const dvec3 o = orthographic ? through - 1000.0 * dvec3(eye) : dvec3(eye);
      const dvec3 d = glm::normalize(through - o);
      const auto [enter, leave] = insideOf(low, high, o, d);
      if (std::abs(leave - enter) < 1e-3) continue;  // along an edge
      int count = 0;
      for (int t = 0; t < 4; ++t) {
        dvec3 corners[3];
        for (int i = 0; i < 3; ++i) {
          for (int axis = 0; axis < 3; ++axis)
            corners[i][axis] = (outline >> (3 * (t + i) + axis) & 1 ? high : low)[axis] - o[axis];
        }
        if (meets(corners, d)) ++count;
      }
      ASSERT_EQ(count, enter < leave && leave > 0 ? 1 : 0) << n << " " << k;
      met += count;
    }
  }
  EXPECT_GT(near, 1000);
  EXPECT_GT(met, 100000);
}

class ProxyTest : public GlTest {};

// A solid block, so that the picture is the proxy's: drawn are the pixels whose rays meet it, judged in
// double precision.
TEST_P(ProxyTest, ABlockIsDrawnWhereRaysMeetIt) {
  const Canvas canvas({48, 40});
  fields::Occupancy block;
  block.size = {12, 20, 7};
  block.solid.assign(12 * 20 * 7, 1);
  const LoadedAsset loaded(packOf(block));
  const auto renderer = makeRenderer(*loaded.asset);
  std::mt19937 random(8);
  std::uniform_real_distribution<float> unit(-1, 1);
  int drawn = 0, empty = 0, within = 0;
  for (int n = 0; n < 400; ++n) {
    // Mirrored, turned and stretched; to_object places the block's voxels in a box of some tenths to one.
    glm::mat4 to_world =
        glm::rotate(glm::mat4(1), 3 * unit(random), glm::vec3(unit(random), unit(random), 1));
    to_world = glm::scale(to_world, glm::vec3(n % 2 ? -1 : 1, 1, 1 + 0.5f * unit(random)));
    const runtime::Instance instance{loaded.asset.get(), nullptr, to_world};
    const Part& part = loaded.asset->pack().parts()[0];
    const glm::dmat4 to_part = glm::inverse(glm::dmat4(runtime::partToWorld(instance, 0).value()));
    const float reach = n % 3 == 0 ? 0.2f : n % 3 == 1 ? 0.9f : 4.0f;
    const glm::vec3 target = glm::vec3(0.2f * unit(random), 0.5f + 0.4f * unit(random), 0.2f * unit(random));
    const glm::vec3 eye = target + reach * glm::vec3(unit(random), unit(random), unit(random));
    const gl::View view =
        n % 5 == 0 ? orthographic(canvas, eye, target, 0.7f, -10, 10) : lookAt(canvas, eye, target, 1e-5f);
    canvas.clear();
    ASSERT_TRUE(renderer->draw(view, {&instance, 1}));
    const std::vector<Pixel> pixels = canvas.pixels();
    const dvec3 inner = dvec3(to_part * glm::dvec4(eye, 1));
    within += n % 5 != 0 && inner == glm::clamp(inner, dvec3(0), dvec3(part.size));
    for (int y = 0; y < canvas.size().y; ++y) {
      for (int x = 0; x < canvas.size().x; ++x) {
        const runtime::Ray ray = pixelRay(view, x, y);
        const dvec3 o(to_part * glm::dvec4(ray.origin, 1)), d(to_part * glm::dvec4(ray.direction, 0));
        // A little smaller and a little larger: between them either will do.
        const auto met = [&](double margin) {
          const auto [enter, leave] = insideOf(dvec3(-margin), dvec3(part.size) + margin, o, d);
          return enter <= leave && leave > 0 && enter < 1;
        };
        const bool sure = met(-0.02), possible = met(0.02);
        if (sure != possible) continue;
        const bool is_drawn = pixels[static_cast<std::size_t>(canvas.size().x * y + x)][3] != 0;
        ASSERT_EQ(is_drawn, sure) << "view " << n << ", pixel " << x << ", " << y;
        ++(sure ? drawn : empty);
      }
    }
  }
  EXPECT_GT(drawn, 50000);
  EXPECT_GT(empty, 50000);
  EXPECT_GT(within, 20);
}

KELP_GL_TESTS(ProxyTest);

}  // namespace
}  // namespace kelp::test
