// SPDX-License-Identifier: MIT
// The three ways of shading, where voxels are larger than pixels, against what geometry says: a sphere's
// radius, the face of a cube that a ray meets, the area under a curve.
#include <algorithm>
#include <cmath>

#include <glm/gtc/matrix_transform.hpp>

#include "canvas.h"
#include "support/poses.h"
#include "support/voxel_points.h"

namespace kelp::test {
namespace {

using runtime::Instance;

constexpr char kNormals[] = "vec4 kelpSurface(KelpSurface s) { return vec4(0.5 + 0.5 * s.normal, 1.0); }\n";
constexpr char kPartNormals[] = R"(
vec4 kelpSurface(KelpSurface s) {
  mat3 to_world = mat3(kelpPartToWorld());
  return vec4(0.5 + 0.5 * transpose(to_world) * s.normal / length(to_world[0]), 1.0);
}
)";
constexpr char kColors[] = "vec4 kelpSurface(KelpSurface s) { return vec4(s.color.rgb, 1.0); }\n";

glm::vec3 normalOf(const Pixel& pixel) { return glm::vec3(pixel[0], pixel[1], pixel[2]) / 127.5f - 1.0f; }
double degreesBetween(const glm::dvec3& a, const glm::dvec3& b) {
  return glm::degrees(std::acos(glm::clamp(glm::dot(glm::normalize(a), glm::normalize(b)), -1.0, 1.0)));
}

// A solid where `inside` holds at the voxels' centers.
template <class Inside>
fields::Occupancy solidWhere(const glm::ivec3& size, Inside&& inside) {
  return voxelsWhere(size, [&](const glm::ivec3& v) { return inside(glm::vec3(v) + 0.5f); });
}

// Level 0 alone, palette entry and normal of each surface voxel from `look`(center).
template <class Look>
RawPack packWith(const fields::Occupancy& volume, Look&& look) {
  RawPack pack = packOf(volume);
  std::vector<fields::SurfaceVoxel> surface;
  for (const std::uint64_t i : fields::surfaceVoxels(volume, 1)) {
    const auto sx = static_cast<std::uint64_t>(volume.size.x), sy = static_cast<std::uint64_t>(volume.size.y);
    const auto [material, normal] = look(glm::vec3(i % sx, i / sx % sy, i / sx / sy) + 0.5f);
    surface.push_back({i, makeAttribute(static_cast<std::uint8_t>(material), encodeNormal(normal))});
  }
  pack.parts[0].levels = {fields::buildLevel(volume, surface, 1)};
  return pack;
}

// A ball of 18 voxels across, its normals those of the sphere; half of it in the other color. Bricks meet in
// its middle.
constexpr float kRadius = 9;
const glm::vec3 kCenter(12);
RawPack ballPack() {
  const fields::Occupancy ball =
      solidWhere({24, 24, 24}, [](const glm::vec3& p) { return glm::distance(p, kCenter) < kRadius; });
  return packWith(ball, [](const glm::vec3& p) { return std::pair(p.x < 12, p - kCenter); });
}

// From voxel to voxel in double precision (Amanatides and Woo): the face through which the ray first enters a
// solid one; zero: none.
glm::ivec3 faceMet(const fields::Occupancy& volume, const runtime::Ray& ray, const glm::dmat4& to_part) {
  const glm::dvec3 o(to_part * glm::dvec4(ray.origin, 1)), r(to_part * glm::dvec4(ray.direction, 0));
  const auto beyond = [&](const glm::ivec3& v, int a) {
    return r[a] > 0 ? v[a] >= volume.size[a] : v[a] < 0;
  };
  glm::ivec3 voxel(glm::floor(o));
  for (int steps = 0; steps < 1000; ++steps) {
    int axis = 0;
    double next[3];
    for (int a = 0; a < 3; ++a) {
      next[a] = r[a] != 0 ? (voxel[a] + (r[a] > 0) - o[a]) / r[a] : 1e30;
      axis = next[a] < next[axis] ? a : axis;
    }
    voxel[axis] += r[axis] > 0 ? 1 : -1;
    if (beyond(voxel, axis)) break;
    bool within = true;
    for (int a = 0; a < 3; ++a) within = within && voxel[a] >= 0 && voxel[a] < volume.size[a];
    if (!within || !volume.solid[volume.index(voxel)]) continue;
    glm::ivec3 face(0);
    face[axis] = r[axis] > 0 ? -1 : 1;
    return face;
  }
  return glm::ivec3(0);
}

class ShadingTest : public GlTest {
 protected:
  std::vector<Pixel> draw(gl::Renderer& renderer, const Canvas& canvas, gl::View view, gl::Shading shading,
                          const Instance& instance) {
    canvas.clear();
    view.quality.shading = shading;
    const auto drawn = renderer.draw(view, {&instance, 1});
    EXPECT_TRUE(drawn) << (drawn ? "" : drawn.error().detail);
    return canvas.pixels();
  }
};

// Voxels of 20 pixels. The truth: the direction from the center to the point that was hit.
TEST_P(ShadingTest, SmoothFollowsTheSphereBetweenItsVoxels) {
  const LoadedAsset loaded(ballPack());
  const Canvas canvas({320, 320});
  const auto renderer = makeRenderer(*loaded.asset, kNormals);
  const Instance instance{loaded.asset.get(), nullptr};
  const gl::View view = orthographic(canvas, {0.4f, 0.9f, 2}, {0, 0.5f, 0}, 8.0f / 24);
  const std::vector<Pixel> gradient = draw(*renderer, canvas, view, gl::Shading::kGradient, instance);
  const std::vector<Pixel> smooth = draw(*renderer, canvas, view, gl::Shading::kSmooth, instance);

  double gradient_sum = 0, smooth_sum = 0, smooth_worst = 0, gradient_jump = 0, smooth_jump = 0;
  int count = 0;
  std::vector<std::optional<runtime::Hit>> hits;
  for (int y = 0; y < 320; ++y) {
    for (int x = 0; x < 320; ++x) hits.push_back(raycast(instance, pixelRay(view, x, y)));
  }
  for (std::size_t i = 0; i < hits.size(); ++i) {
    if (!hits[i] || smooth[i][3] == 0) continue;
    ++count;
    const glm::dvec3 truth = restToVoxel(instance, 0, hits[i]->rest) - kCenter;
    const double error = degreesBetween(normalOf(smooth[i]), truth);
    smooth_sum += error;
    smooth_worst = std::max(smooth_worst, error);
    gradient_sum += degreesBetween(normalOf(gradient[i]), truth);
    // Neighbors on one piece of surface: no edge between them behind which it goes on elsewhere.
    if (i % 320 == 0 || !hits[i - 1] ||
        glm::distance(restToVoxel(instance, 0, hits[i]->rest), restToVoxel(instance, 0, hits[i - 1]->rest)) >
            0.25f)
      continue;
    const double turn = degreesBetween(truth, restToVoxel(instance, 0, hits[i - 1]->rest) - kCenter);
    smooth_jump = std::max(smooth_jump, degreesBetween(normalOf(smooth[i]), normalOf(smooth[i - 1])) - turn);
    gradient_jump =
        std::max(gradient_jump, degreesBetween(normalOf(gradient[i]), normalOf(gradient[i - 1])) - turn);
  }
  ASSERT_GT(count, 70000);
  std::printf("gradient: mean %.2f, jump %.2f; smooth: mean %.2f, worst %.2f, jump %.2f degrees\n",
              gradient_sum / count, gradient_jump, smooth_sum / count, smooth_worst, smooth_jump);
  EXPECT_LT(smooth_sum / count, 0.5 * gradient_sum / count);
  EXPECT_LT(smooth_worst, 6);
  EXPECT_GT(gradient_jump, 5);
  EXPECT_LT(smooth_jump, 1.5);  // more than the sphere turns; 8 bits make up to 0.8 of it
}

// The same field in a coarser level, whose voxels are twice as large.
TEST_P(ShadingTest, SmoothKnowsTheLevel) {
  const fields::Occupancy ball = solidWhere(
      {48, 48, 48}, [](const glm::vec3& p) { return glm::distance(p, 2.0f * kCenter) < 2 * kRadius; });
  const LoadedAsset loaded(packOf(ball));  // normals away from the center, at every level
  const Canvas canvas({160, 160});
  const auto renderer = makeRenderer(*loaded.asset, kNormals);
  const Instance instance{loaded.asset.get(), nullptr};
  gl::View view = orthographic(canvas, {0.4f, 0.9f, 2}, {0, 0.5f, 0}, 8.0f / 24);
  view.quality.finest_level = 1;
  const std::vector<Pixel> pixels = draw(*renderer, canvas, view, gl::Shading::kSmooth, instance);
  double sum = 0;
  int count = 0;
  for (int i = 0; i < 160 * 160; ++i) {
    const auto hit = raycast(instance, pixelRay(view, i % 160, i / 160), 1);
    if (!hit || pixels[static_cast<std::size_t>(i)][3] == 0) continue;
    sum += degreesBetween(normalOf(pixels[static_cast<std::size_t>(i)]),
                          restToVoxel(instance, 0, hit->rest) - 2.0f * kCenter);
    ++count;
  }
  ASSERT_GT(count, 15000);
  EXPECT_LT(sum / count, 1.5);
}

// Across a straight border between two colors on a flat face the blend is the area under the B-spline on
// either side: by hand, the integral of a quadratic B-spline at the voxels' centers.
TEST_P(ShadingTest, SmoothBlendsColorsAcrossTheirBorder) {
  const fields::Occupancy block = solidWhere({16, 16, 16}, [](const glm::vec3&) { return true; });
  const LoadedAsset loaded(
      packWith(block, [](const glm::vec3& p) { return std::pair(p.x > 8, glm::vec3(0, 0, 1)); }));
  const Canvas canvas({160, 20});
  const auto renderer = makeRenderer(*loaded.asset, kColors);
  const Instance instance{loaded.asset.get(), nullptr};
  // 20 pixels a voxel, 8 voxels in all
  const gl::View view = orthographic(canvas, {0, 0.5f, 3}, {0, 0.5f, 0}, 0.5f / 16);
  const std::vector<Pixel> pixels = draw(*renderer, canvas, view, gl::Shading::kSmooth, instance);
  for (int x = 0; x < 160; ++x) {
    const double q = (x + 0.5) / 20 - 4;  // voxels from the border
    double right = 0;
    for (int center2 = 1; center2 < 13; center2 += 2) {
      const double d = std::abs(q - 0.5 * center2);
      right += d < 0.5 ? 0.75 - d * d : d < 1.5 ? 0.5 * (1.5 - d) * (1.5 - d) : 0;
    }
    const glm::dvec3 color = glm::mix(glm::dvec3(0.8, 0.4, 0.1), glm::dvec3(0.1, 0.6, 0.2), right);
    for (int i = 0; i < 3; ++i)
      EXPECT_NEAR(pixels[static_cast<std::size_t>(160 * 10 + x)][static_cast<std::size_t>(i)], 255 * color[i],
                  1.0)
          << x;
  }
}

// A leaf two voxels thick that leans: the voxels of its far side, whose normals are the opposite, do not turn
// the near side's.
TEST_P(ShadingTest, SmoothKeepsTheSidesOfALeafApart) {
  const glm::vec3 up = glm::normalize(glm::vec3(1, 0.35f, 1.6f));
  const auto height = [&](const glm::vec3& p) { return glm::dot(p - glm::vec3(16), up); };
  const fields::Occupancy leaf =
      solidWhere({32, 32, 32}, [&](const glm::vec3& p) { return std::abs(height(p)) < 1; });
  const LoadedAsset loaded(
      packWith(leaf, [&](const glm::vec3& p) { return std::pair(height(p) > 0, height(p) > 0 ? up : -up); }));
  const Canvas canvas({160, 160});
  const auto normals = makeRenderer(*loaded.asset, kNormals);
  const auto colors = makeRenderer(*loaded.asset, kColors);
  const Instance instance{loaded.asset.get(), nullptr};
  const gl::View view = orthographic(canvas, {0.9f, 1.0f, 2}, {0, 0.5f, 0}, 0.2f);
  const std::vector<Pixel> smooth = draw(*normals, canvas, view, gl::Shading::kSmooth, instance);
  const std::vector<Pixel> blended = draw(*colors, canvas, view, gl::Shading::kSmooth, instance);
  int far_off = 0, count = 0;
  for (std::size_t i = 0; i < smooth.size(); ++i) {
    if (smooth[i][3] == 0) continue;
    ++count;
    // the near side's red is 0.1
    far_off += degreesBetween(normalOf(smooth[i]), up) > 5 || std::abs(blended[i][0] - 26) > 13;
  }
  ASSERT_GT(count, 25000);
  EXPECT_LT(far_off, count / 100);
}

// Straight, and turned in the world: the axes of the part, and nothing between them.
TEST_P(ShadingTest, FacesAreTheCubesOwn) {
  const fields::Occupancy clump = ballClump({24, 32, 20}, 14, 7);
  const LoadedAsset loaded(packOf(clump));
  const Canvas canvas({160, 120});
  const auto renderer = makeRenderer(*loaded.asset, kPartNormals);
  Instance instance{loaded.asset.get(), nullptr};
  instance.to_world = glm::rotate(glm::mat4(1), 0.7f, glm::vec3(0.3f, 1, 0.2f));
  const Part& part = loaded.asset->pack().parts()[0];
  const glm::dmat4 to_part =
      glm::inverse(glm::dmat4(instance.to_world) * glm::dmat4(glm::dmat4x3(part.to_object)));
  for (const gl::View& view :
       {lookAt(canvas, {0.7f, 0.9f, 0.9f}, {0, 0.5f, 0}), lookAt(canvas, {0.2f, -0.3f, 1.1f}, {0, 0.5f, 0}),
        orthographic(canvas, {-2, 0.5f, 0.7f}, {0, 0.5f, 0}, 0.3123f)}) {
    const std::vector<Pixel> pixels = draw(*renderer, canvas, view, gl::Shading::kFaces, instance);
    int count = 0, other = 0;
    for (int i = 0; i < 160 * 120; ++i) {
      const runtime::Ray ray = pixelRay(view, i % 160, i / 160);
      const auto hit = raycast(instance, ray);
      if (!hit || pixels[static_cast<std::size_t>(i)][3] == 0) continue;
      ++count;
      const glm::vec3 normal = normalOf(pixels[static_cast<std::size_t>(i)]);
      const glm::ivec3 axis = glm::ivec3(glm::round(normal));
      ASSERT_EQ(std::abs(axis.x) + std::abs(axis.y) + std::abs(axis.z), 1);
      ASSERT_LT(glm::distance(normal, glm::vec3(axis)), 0.01f);
      other += axis != faceMet(clump, ray, to_part);
    }
    ASSERT_GT(count, 2500);
    // within 1/256 voxel of an edge a ray may slip past it and meet the next face
    EXPECT_LE(other, count / 200);
  }
}

// Along a floor of solid voxels: the borders between them, which nobody can see, do not show.
TEST_P(ShadingTest, FacesThatAreCoveredAreNotSeen) {
  const fields::Occupancy floor = solidWhere({40, 16, 40}, [](const glm::vec3& p) { return p.y < 8; });
  const LoadedAsset loaded(packOf(floor));
  const Canvas canvas({160, 60});
  const auto renderer = makeRenderer(*loaded.asset, kNormals);
  const gl::View view = lookAt(canvas, {0.9f, 0.6f, 2.5f}, {0, 0.5f, 0});  // 2 degrees from above
  const std::vector<Pixel> pixels =
      draw(*renderer, canvas, view, gl::Shading::kFaces, {loaded.asset.get(), nullptr});
  int top = 0;
  for (int i = 0; i < 160 * 60; ++i) {
    const Instance flat{loaded.asset.get(), nullptr};
    const auto hit = raycast(flat, pixelRay(view, i % 160, i / 160));
    if (!hit || restToVoxel(flat, 0, hit->rest).y < 7.98f || restToVoxel(flat, 0, hit->rest).z > 39.98f)
      continue;
    ++top;
    ASSERT_EQ(pixels[static_cast<std::size_t>(i)][1], 255) << i % 160 << ' ' << i / 160;
  }
  EXPECT_GT(top, 250);
}

// Bent: the plane that the face's own edges span in the world, by finite differences of runtime::toWorld.
TEST_P(ShadingTest, FacesBendWithTheirCubes) {
  const fields::Occupancy clump = ballClump({24, 32, 20}, 14, 7);
  const LoadedAsset loaded(packOf(clump));
  const Canvas canvas({160, 120});
  const auto renderer = makeRenderer(*loaded.asset, kNormals);
  for (const std::size_t figure : {std::size_t{1}, std::size_t{3}, std::size_t{4}}) {
    SCOPED_TRACE(kFigure6[figure].name);
    runtime::Pose pose = *runtime::Pose::create(*loaded.asset);
    const std::vector<Knot> knots = figureKnots(kFigure6[figure]);
    (void)pose.setKnots(0, knots);
    const Instance instance{loaded.asset.get(), &pose};
    const Box box = bounds(instance);
    const glm::vec3 center = 0.5f * (box.min + box.max);
    const gl::View view =
        lookAt(canvas, center + 0.8f * glm::distance(box.min, box.max) * glm::vec3(0.4f, 0.3f, 0.9f), center);
    const std::vector<Pixel> pixels = draw(*renderer, canvas, view, gl::Shading::kFaces, instance);
    int count = 0, other = 0;
    for (int i = 0; i < 160 * 120; ++i) {
      const auto hit = raycast(instance, pixelRay(view, i % 160, i / 160));
      if (!hit || pixels[static_cast<std::size_t>(i)][3] == 0) continue;
      // The face of the cube that the hit lies in; edges, and the ends of the spline with their infinite
      // slopes, are left out.
      const glm::vec3 from_center = restToVoxel(instance, 0, hit->rest) - glm::vec3(hit->voxel) - 0.5f;
      int axis = 0;
      for (int a = 1; a < 3; ++a) axis = std::abs(from_center[a]) > std::abs(from_center[axis]) ? a : axis;
      const int u = (axis + 1) % 3, v = (axis + 2) % 3;
      if (std::max(std::abs(from_center[u]), std::abs(from_center[v])) > 0.45f ||
          restToVoxel(instance, 0, hit->rest).y < 0.5f || restToVoxel(instance, 0, hit->rest).y > 31.5f)
        continue;
      const auto along = [&](int a) {
        glm::vec3 step(0);
        step[a] = 0.05f;
        return glm::dvec3(voxelToWorld(instance, 0, restToVoxel(instance, 0, hit->rest) + step)) -
               glm::dvec3(voxelToWorld(instance, 0, restToVoxel(instance, 0, hit->rest) - step));
      };
      const glm::dvec3 plane = (from_center[axis] > 0 ? 1.0 : -1.0) * glm::cross(along(u), along(v));
      ++count;
      other += degreesBetween(normalOf(pixels[static_cast<std::size_t>(i)]), plane) > 2;
    }
    ASSERT_GT(count, 1000);
    EXPECT_LE(other, count / 200);
  }
}

// Coarse voxels stand out of a volume of odd size; the ends of a steep spline are met where rays run along
// them.
TEST_P(ShadingTest, FacesEndWhereTheVolumeDoes) {
  const fields::Occupancy block = solidWhere({21, 24, 23}, [](const glm::vec3&) { return true; });
  const LoadedAsset loaded(packOf(block));
  const Canvas canvas({120, 120});
  const auto renderer = makeRenderer(*loaded.asset, kNormals);
  const auto expectCorner = [&](const Instance& instance, int level, const glm::vec3& from) {
    gl::View view = orthographic(canvas, glm::vec3(0, 0.5f, 0) + 3.0f * from, {0, 0.5f, 0}, 0.9f);
    view.quality.finest_level = level;
    const std::vector<Pixel> pixels = draw(*renderer, canvas, view, gl::Shading::kFaces, instance);
    int count = 0, other = 0;
    for (int i = 0; i < 120 * 120; ++i) {
      const auto hit = raycast(instance, pixelRay(view, i % 120, i / 120), level);
      if (!hit || pixels[static_cast<std::size_t>(i)][3] == 0) continue;
      // Which of the block's three planes on this side is the point in?
      const glm::vec3 beside =
          glm::abs(restToVoxel(instance, 0, hit->rest) - (from.x > 0 ? glm::vec3(block.size) : glm::vec3(0)));
      const int axis = beside.x < std::min(beside.y, beside.z) ? 0 : beside.y < beside.z ? 1 : 2;
      ++count;
      other += normalOf(pixels[static_cast<std::size_t>(i)])[axis] * from.x < 0.99f;
    }
    EXPECT_GT(count, 2000);
    EXPECT_LE(other, count / 200);
  };
  for (int level = 0; level < 3; ++level) {
    SCOPED_TRACE(level);
    expectCorner({loaded.asset.get(), nullptr}, level, {1, 1, 1});
    expectCorner({loaded.asset.get(), nullptr}, level, {-1, -1, -1});
  }
  // Steep ends of posts side by side, at heights that are no round numbers: what is seen from above is the
  // top, though the ray's image runs along it.
  const LoadedAsset posts(packOf(
      solidWhere(block.size, [](const glm::vec3& p) { return static_cast<int>(p.x + p.z) % 2 == 0; })));
  const auto posts_renderer = makeRenderer(*posts.asset, kNormals);
  runtime::Pose pose = *runtime::Pose::create(*posts.asset);
  std::vector<Knot> knots = figureKnots(kFigure6[5]);
  for (int trial = 0; trial < 32; ++trial) {
    const float side = trial < 16 ? 1.0f : -1.0f;
    knots[0].position.y = 0.3f / 24;
    knots[1].position.y = (24.1f + 0.013f * static_cast<float>(trial % 16)) / 24;
    (void)pose.setKnots(0, knots);
    gl::View view = orthographic(canvas, {0, 0, 0}, {0, 0, -1}, 0.3f);
    view.camera.world_to_eye = glm::rotate(glm::mat4(1), side * glm::radians(89.0f), glm::vec3(1, 0, 0)) *
                               glm::translate(glm::mat4(1), glm::vec3(0, -side * 5, 0));
    const std::vector<Pixel> pixels =
        draw(*posts_renderer, canvas, view, gl::Shading::kFaces, {posts.asset.get(), &pose});
    for (int y = 40; y < 80; ++y) {
      for (int x = 40; x < 80; ++x) {
        const Pixel& pixel = pixels[static_cast<std::size_t>(120 * y + x)];
        ASSERT_NEAR(pixel[1], pixel[3] == 0 ? 0 : side > 0 ? 255 : 0, 2) << trial << ' ' << x << ' ' << y;
      }
    }
  }
}

// No normal or material of the three changes the shape; an enumerator that there is none of is refused.
TEST_P(ShadingTest, ChangesNeitherShapeNorDepth) {
  const LoadedAsset loaded(ballPack());
  const Canvas canvas({120, 120});
  const auto renderer = makeRenderer(*loaded.asset, kVoxelSurface);
  const Instance instance{loaded.asset.get(), nullptr};
  gl::View view = lookAt(canvas, {0.6f, 0.8f, 1.2f}, {0, 0.5f, 0});
  EXPECT_EQ(view.quality.shading, gl::Shading::kGradient);
  const std::vector<Pixel> gradient = draw(*renderer, canvas, view, gl::Shading::kGradient, instance);
  const std::vector<float> depths = desktop() ? canvas.depths() : std::vector<float>();
  for (const gl::Shading shading : {gl::Shading::kFaces, gl::Shading::kSmooth}) {
    EXPECT_EQ(draw(*renderer, canvas, view, shading, instance), gradient);
    if (desktop()) {
      EXPECT_EQ(canvas.depths(), depths);
    }
  }
  view.quality.shading = static_cast<gl::Shading>(3);
  const auto refused = renderer->draw(view, {&instance, 1});
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().code, ErrorCode::kMisuse);
}

KELP_GL_TESTS(ShadingTest);

// OpenGL 3.3 and OpenGL ES 3.0 draw one picture.
TEST(Shading, IsOneOnDesktopAndEmbedded) {
  const LoadedAsset loaded(ballPack());
  runtime::Pose pose = *runtime::Pose::create(*loaded.asset);
  const std::vector<Knot> knots = figureKnots(kFigure6[1]);
  (void)pose.setKnots(0, knots);
  const Instance instance{loaded.asset.get(), &pose};
  std::vector<std::vector<Pixel>> pictures[2];
  for (const GlApi api : {GlApi::kDesktop33, GlApi::kEs30}) {
    const EglContext context(api);
    if (!context) GTEST_SKIP() << "no EGL device gives such a context: install libegl1 libgl1-mesa-dri";
    const Canvas canvas({160, 160});
    gl::RendererOptions config;
    config.getProcAddress = EglContext::getProcAddress;
    config.gpu_budget = kGpuBudget;
    const auto renderer = gl::Renderer::create(config);
    ASSERT_TRUE(renderer);
    ASSERT_TRUE((*renderer)->add(*loaded.asset));
    ASSERT_TRUE((*renderer)->upload(~std::uint64_t{0}));
    gl::View view = lookAt(canvas, {0.6f, 0.9f, 1.9f}, {0.1f, 0.5f, 0.1f});
    for (const gl::Shading shading : {gl::Shading::kGradient, gl::Shading::kFaces, gl::Shading::kSmooth}) {
      view.quality.shading = shading;
      canvas.clear();
      ASSERT_TRUE((*renderer)->draw(view, {&instance, 1}));
      pictures[api == GlApi::kEs30].push_back(canvas.pixels());
    }
  }
  for (std::size_t s = 0; s < 3; ++s) {
    int covered = 0, different = 0;
    for (std::size_t i = 0; i < pictures[0][s].size(); ++i) {
      covered += pictures[0][s][i][3] != 0;
      bool near = true;
      for (std::size_t c = 0; c < 4; ++c)
        near = near && std::abs(pictures[0][s][i][c] - pictures[1][s][i][c]) <= 1;
      different += !near;
    }
    EXPECT_GT(covered, 4000);
    EXPECT_LE(different, covered / 500) << "shading " << s;  // edges
  }
}

}  // namespace
}  // namespace kelp::test
