// SPDX-License-Identifier: MIT
// Parts that are drawn through cages, against the same parts without, which splines bend.
#include <cmath>
#include <random>

#include <glm/gtc/matrix_transform.hpp>

#include "canvas.h"
#include "support/cage_pack.h"
#include "support/voxel_points.h"
#include "swept_pack.h"

namespace kelp::test {
namespace {

using runtime::Instance;

// How two pictures with something (a voxel, coverage) in each pixel differ. Nothing is a pixel of zeros.
struct Difference {
  int covered = 0;      // in both
  int outline = 0;      // covered in one alone
  int apart = 0;        // of `covered`, not the same
  double iou() const { return static_cast<double>(covered) / (covered + outline); }
};
Difference differenceOf(const std::vector<Pixel>& a, const std::vector<Pixel>& b) {
  Difference difference;
  for (std::size_t i = 0; i < a.size(); ++i) {
    const bool in_a = a[i] != Pixel{}, in_b = b[i] != Pixel{};
    difference.covered += in_a && in_b;
    difference.outline += in_a != in_b;
    difference.apart += in_a && in_b && a[i] != b[i];
  }
  return difference;
}

class CagedTest : public GlTest {
 protected:
  static std::vector<Pixel> draw(gl::Renderer& renderer, const gl::View& view, const Instance& instance,
                                 const Canvas& canvas) {
    canvas.clear();
    const auto drawn = renderer.draw(view, instance);
    EXPECT_TRUE(drawn);
    if (drawn) {
      EXPECT_EQ(drawn->instances, 1u);
      EXPECT_EQ(drawn->left_out, 0u);
    }
    EXPECT_EQ(glGetError(), GLenum{GL_NO_ERROR});
    return canvas.pixels();
  }
  static gl::View closeTo(const Canvas& canvas, const Instance& instance,
                          const glm::vec3& from = {0.5f, 0.3f, 0.8f}) {
    const Box box = bounds(instance);
    const glm::vec3 middle = 0.5f * (box.min + box.max);
    return lookAt(canvas, middle + 0.9f * glm::distance(box.min, box.max) * from, middle);
  }
};

TEST_P(CagedTest, AtRestItIsThePartWithoutACage) {
  const Canvas canvas({160, 120});
  const fields::Occupancy volume = ballClump({60, 80, 50}, 20, 2);
  const LoadedAsset plain(packOf(volume));
  const auto plain_renderer = makeRenderer(*plain.asset, kVoxelSurface);
  const int levels = plain.asset->pack().parts()[0].levels;
  for (const int cell : {2, 8, 16}) {
    const LoadedAsset with(cagedPackOf(volume, cell));
    const auto renderer = makeRenderer(*with.asset, kVoxelSurface);
    Instance instance{plain.asset.get()};
    instance.to_world = glm::rotate(glm::mat4(1), 0.4f, glm::vec3(1, 2, 3)) *
                        glm::scale(glm::mat4(1), glm::vec3(-1, 1.2f, 0.8f));
    Instance same = instance;
    same.asset = with.asset.get();
    const glm::vec3 inside = voxelToWorld(instance, 0, 0.5f * glm::vec3(volume.size));
    const std::pair<const char*, gl::View> views[] = {
        {"outside", closeTo(canvas, instance)},
        {"from below", closeTo(canvas, instance, {-0.5f, -0.9f, 0.1f})},
        {"orthographic", orthographic(canvas, {3, 2, 4}, {0, 0.5f, 0}, 0.7f)},
        {"inside the bounds", lookAt(canvas, inside + glm::vec3(0.12f, 0.2f, 0.1f), inside, 0.01f)},
        {"inside the solid", lookAt(canvas, inside, inside + glm::vec3(1, 0.2f, 0.3f), 0.01f)},
        {"cut by the near plane", lookAt(canvas, {0.3f, 0.6f, 1.6f}, {0, 0.5f, 0}, 1.4f)},
        {"cut by the far plane", lookAt(canvas, {0.3f, 0.6f, 1.6f}, {0, 0.5f, 0}, 0.1f, 1.7f)},
    };
    for (const auto& [name, of] : views) {
      for (int level = 0; level < levels; ++level) {
        SCOPED_TRACE(testing::Message() << "cell " << cell << ", " << name << ", level " << level);
        gl::View view = of;
        view.quality.finest_level = level;
        const Difference difference = differenceOf(draw(*plain_renderer, view, instance, canvas),
                                                   draw(*renderer, view, same, canvas));
        EXPECT_GT(difference.covered, 400);
        EXPECT_LE(difference.outline, 2 + difference.covered / 500);
        EXPECT_LE(difference.apart, 2 + difference.covered / 200);
      }
    }
  }
}

KELP_GL_TESTS(CagedTest);

}  // namespace
}  // namespace kelp::test
