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

// Where the point that is seen is at rest.
constexpr char kRestSurface[] = "vec4 kelpSurface(KelpSurface s) { return vec4(s.rest / s.size, 1.0); }\n";

// How two such pictures differ.
struct Difference {
  int covered = 0;  // in both
  int outline = 0;  // covered in one alone
  // Of `covered`: by more than 1/85 of the size from what the other shows there, and in each of the eight
  // pixels around it. (Edges of voxels are eroded without a cage, and not with one.)
  int apart = 0;
  double iou() const { return static_cast<double>(covered) / (covered + outline); }
};
Difference differenceOf(const std::vector<Pixel>& a, const std::vector<Pixel>& b, const glm::ivec2& size) {
  Difference difference;
  for (int y = 0; y < size.y; ++y) {
    for (int x = 0; x < size.x; ++x) {
      const Pixel& in_a = a[static_cast<std::size_t>(x + size.x * y)];
      const Pixel& in_b = b[static_cast<std::size_t>(x + size.x * y)];
      difference.covered += in_a[3] != 0 && in_b[3] != 0;
      difference.outline += (in_a[3] != 0) != (in_b[3] != 0);
      if (in_a[3] == 0 || in_b[3] == 0) continue;
      int least = 255;
      for (int i = 0; i < 9; ++i) {
        const glm::ivec2 at = glm::clamp(glm::ivec2(x + i % 3 - 1, y + i / 3 - 1), glm::ivec2(0), size - 1);
        const Pixel& near = a[static_cast<std::size_t>(at.x + size.x * at.y)];
        int most = 0;
        for (std::size_t k = 0; k < 4; ++k) most = std::max(most, std::abs(near[k] - in_b[k]));
        least = std::min(least, most);
      }
      difference.apart += least > 3;
    }
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
  const auto plain_renderer = makeRenderer(*plain.asset, kRestSurface);
  const int levels = plain.asset->pack().parts()[0].levels;
  for (const int cell : {2, 8, 16}) {
    const LoadedAsset with(cagedPackOf(volume, cell));
    const auto renderer = makeRenderer(*with.asset, kRestSurface);
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
                                                   draw(*renderer, view, same, canvas),
                                                   canvas.size());
        EXPECT_GT(difference.covered, 300);
        EXPECT_LE(difference.outline, 4 + difference.covered / 400);
        EXPECT_EQ(difference.apart, 0);
      }
    }
  }
}

// Bent by the same splines: nodes follow the spline, or are where the host puts them.
TEST_P(CagedTest, ItsNodesBendItAsItsSplineDoes) {
  const Canvas canvas({320, 240});
  const fields::Occupancy volume = ballClump({36, 96, 32}, 40, 3);
  const auto sweeps = reference::namedSweeps(volume.size);
  std::vector<RawPack> packs;
  for (const FigurePose& figure : std::span(kFigure6).subspan(1, 3))
    packs.push_back(packOf(volume, figureKnots(figure)));
  for (const std::size_t named : {2u, 5u}) packs.push_back(sweptPackOf(volume, sweeps[named]));
  for (std::size_t i = 0; i < packs.size(); ++i) {
    SCOPED_TRACE(i);
    const LoadedAsset plain(packs[i]), with(caged(packs[i], 2));
    const auto plain_renderer = makeRenderer(*plain.asset, kRestSurface),
               renderer = makeRenderer(*with.asset, kRestSurface);
    const Instance instance{plain.asset.get()};
    const gl::View view = closeTo(canvas, instance);
    const std::vector<Pixel> expected = draw(*plain_renderer, view, instance, canvas);
    const std::vector<Pixel> by_spline = draw(*renderer, view, {with.asset.get()}, canvas);
    const Difference difference = differenceOf(expected, by_spline, canvas.size());
    EXPECT_GT(difference.covered, 2000);
    EXPECT_GT(difference.iou(), 0.99);
    EXPECT_LE(difference.apart, difference.covered / 200);

    runtime::Pose pose = *runtime::Pose::create(*with.asset);
    const Part& part = with.asset->pack().parts()[0];
    const std::span<glm::vec3> nodes = pose.nodes(0);
    ASSERT_EQ(nodes.size(), part.cages[0].nodes());
    const glm::mat4 to_part = glm::inverse(*runtime::partToWorld(instance, 0));
    for (std::uint32_t n = 0; n < nodes.size(); ++n) {
      const glm::vec3 rest = part.to_object * glm::vec4(glm::vec3(part.cages[0].rest(n)), 1);
      nodes[n] = to_part * glm::vec4(*runtime::toWorld(instance, 0, rest), 1);
    }
    const Difference by_host =
        differenceOf(by_spline, draw(*renderer, view, {with.asset.get(), &pose}, canvas), canvas.size());
    EXPECT_LE(by_host.outline, 4);
    EXPECT_EQ(by_host.apart, 0);
    // What the nodes do shows.
    for (glm::vec3& node : pose.nodes(0)) node.x += 8;
    EXPECT_GT(differenceOf(by_spline, draw(*renderer, view, {with.asset.get(), &pose}, canvas), canvas.size())
                  .outline,
              300);
  }
}

KELP_GL_TESTS(CagedTest);

}  // namespace
}  // namespace kelp::test
