// SPDX-License-Identifier: MIT
// Swept fog against the integral that it stands for, in double precision through the inverse map of each
// slice; beside the same fog sheared, where both are straight; and all that fog has to do with beside itself.
#include <cmath>
#include <numbers>

#include <glm/gtc/matrix_transform.hpp>

#include "fog_canvas.h"
#include "reference/sweep_truth.h"
#include "swept_pack.h"

namespace kelp::test {
namespace {

constexpr glm::ivec3 kSweptSize(24, 96, 20);

class SweptFog : public GlTest {};

RawPack sweptFog(fields::FogSamples fog, float extinction, const reference::SweepRig& rig) {
  RawPack pack = fogPack(std::move(fog), extinction, rig.knots);
  pack.parts[0].bend = Bend::kSweep;
  pack.parts[0].roll = rig.roll;
  return pack;
}

// A circle of more than one turn: it goes through itself.
reference::SweepRig overlapping() {
  reference::SweepRig rig{"once and a quarter round", {}, 0.4f};
  constexpr float kTurn = 2.5f * std::numbers::pi_v<float>, kLength = 1.5f;
  for (int i = 0; i <= 5; ++i) {
    const float at = 0.2f * static_cast<float>(i), a = kTurn * at, drift = 0.12f;
    rig.knots.push_back({at, kLength / kTurn * glm::vec3(1 - std::cos(a), std::sin(a), drift * a),
                         kLength * glm::vec3(std::sin(a), std::cos(a), drift)});
  }
  return rig;
}

std::vector<reference::SweepRig> sweptRigs() {
  std::vector<reference::SweepRig> rigs = reference::namedSweeps(kSweptSize);
  rigs.push_back(overlapping());
  for (const unsigned seed : {1u, 2u, 3u}) rigs.push_back(reference::randomSweep(kSweptSize, seed));
  return rigs;
}

// The arcs that are drawn at a level: half a voxel off the spline at most.
std::unique_ptr<ArcChain> drawnArcs(const RawPart& part, int level) {
  auto chain = std::make_unique<ArcChain>();
  const float tolerance = std::max(std::ldexp(0.5f, level) / static_cast<float>(part.size.y), kArcTolerance);
  EXPECT_TRUE(makeArcs(part.knots, part.size, part.roll, tolerance, *chain));
  return chain;
}

// Every place at rest of a point: one for each slice that it is in.
auto placesIn(const ArcChain& chain, const glm::ivec3& size) {
  return [&chain, size](const glm::dvec3& p, auto&& visit) {
    for (int i = 0; i < chain.count; ++i) {
      const auto side = [&p](const glm::vec4& plane) {
        return glm::dot(glm::dvec3(plane), p) + double{plane.w};
      };
      if (side(chain.joints[i].plane) < 0 || side(chain.joints[i + 1].plane) >= 0) continue;
      if (glm::distance(p, glm::dvec3(chain.arcs[i].middle)) > double{chain.arcs[i].radius}) continue;
      // (Half a turn away the planes of a slice have another wedge between them; the ball leaves it out, or
      // the place at rest is outside of the part.)
      visit(reference::unswept(chain.arcs[i], size, p));
    }
  };
}

// The light along a pixel's ray, from `begin` to `end`.
FogSight lookAlong(const FogTruth& truth, const ArcChain& chain, const PartRay& ray, double begin, double end,
                   double step = 1.0 / 16) {
  if (!(begin < end)) return {};
  return truth.lookThrough(placesIn(chain, kSweptSize), ray.o, ray.r, begin, end, step);
}

TEST_P(SweptFog, IsTheIntegralInEveryPose) {
  if (!desktop()) return;  // OpenGL ES reads no floats back
  const FloatCanvas canvas({16, 12});
  for (const bool glows : {false, true}) {
    for (const reference::SweepRig& rig : sweptRigs()) {
      const RawPack pack =
          sweptFog(fogOf(kSweptSize, puffs,
                         glows ? FogShape([](const glm::dvec3& p) { return puffs(p) * p.y; }) : FogShape()),
                   0.21f, rig);
      const LoadedAsset loaded(pack);
      const auto renderer = makeRenderer(*loaded.asset);
      ASSERT_TRUE(renderer);
      const Instance instance{loaded.asset.get(), nullptr};
      for (const int level : {0, 1}) {
        SCOPED_TRACE(rig.name + " level " + std::to_string(level));
        const FogTruth truth(pack.parts[0], level);
        const auto chain = drawnArcs(pack.parts[0], level);
        gl::View view = dark(framing(canvas.size(), instance));
        view.quality.finest_level = level;
        const std::vector<glm::vec4> drawn = drawFog(*renderer, canvas, view, instance);
        double worst = 0, worst_glow = 0, sum = 0;
        for (int y = 0; y < canvas.size().y; ++y) {
          for (int x = 0; x < canvas.size().x; ++x) {
            const PartRay ray = partRay(view, instance, chain->bounds, x, y);
            const FogSight sight = lookAlong(truth, *chain, ray, ray.begin, ray.end);
            const glm::vec4& pixel = drawn[static_cast<std::size_t>(x + canvas.size().x * y)];
            worst = std::max(worst, std::abs(1 - sight.through - double{pixel.a}));
            for (int c = 0; c < 3; ++c)
              worst_glow = std::max(worst_glow, std::abs(sight.glow[c] - double{pixel[c]}));
            sum += 1 - sight.through;
          }
        }
        EXPECT_GT(sum, 0.01);
        EXPECT_LT(worst, 2.5e-4);  // a sixteenth of what 8 bits tell apart
        EXPECT_LT(worst_glow, 2.0 / 255);
      }
    }
  }
}

// Straight, both ways to bend are the same, with heat and shadows too; and so is the light of swept fog.
TEST_P(SweptFog, IsThatOfAStraightSpline) {
  if (!desktop()) return;  // OpenGL ES reads no floats back
  const FloatCanvas canvas({32, 40});
  for (const bool glows : {false, true}) {
    const auto heat = [](const glm::dvec3& p) { return puffs(p) * p.x; };
    const fields::FogSamples fog = fogOf(kSweptSize, puffs, glows ? FogShape(heat) : FogShape());
    const RawPack sheared = fogPack(fog, 0.1f);
    RawPack swept = sheared;
    swept.parts[0].bend = Bend::kSweep;
    const LoadedAsset assets[2] = {LoadedAsset(sheared), LoadedAsset(swept)};
    gl::RendererOptions config;
    config.features = gl::Features::kSecondaryRays;
    const auto renderer = makeRenderer(*assets[0].asset, nullptr, config);
    ASSERT_TRUE(renderer && renderer->add(*assets[1].asset) && renderer->upload(~std::uint64_t{0}));
    for (const bool shadow : {false, true}) {
      std::vector<glm::vec4> pictures[2];
      for (std::size_t i = 0; i < 2; ++i) {
        const Instance instance{assets[i].asset.get(), nullptr};
        gl::View view = framing(canvas.size(), instance);
        view.quality.pixels_per_voxel = 0;
        view.quality.self_shadow = shadow;
        pictures[i] = drawFog(*renderer, canvas, view, instance);
      }
      // (Where the curves end differs, and so where shadows are looked at.)
      EXPECT_LT(greatest(pictures[0], pictures[1]), shadow ? 2e-3 : 2e-4) << glows << shadow;
    }
  }
}

// The sun's light that reaches the eye, with the fog's shadow on itself at a level four times coarser.
TEST_P(SweptFog, ShadesItselfInACurl) {
  if (!desktop()) return;  // OpenGL ES reads no floats back
  const FloatCanvas canvas({12, 9});
  const reference::SweepRig rig = reference::namedSweeps(kSweptSize)[6];
  const RawPack pack = sweptFog(fogOf(kSweptSize, puffs), 0.15f, rig);
  const LoadedAsset loaded(pack);
  gl::RendererOptions config;
  config.features = gl::Features::kSecondaryRays;
  const auto renderer = makeRenderer(*loaded.asset, nullptr, config);
  ASSERT_TRUE(renderer);
  const Instance instance{loaded.asset.get(), nullptr};
  const FogTruth truth(pack.parts[0], 0), coarse(pack.parts[0], 2);
  const auto chain = drawnArcs(pack.parts[0], 0);
  const auto places = placesIn(*chain, kSweptSize);
  gl::View view = dark(framing(canvas.size(), instance));
  view.light.sun_color = glm::vec3(20);
  view.light.sun_direction = glm::normalize(glm::vec3(0.95f, 0.1f, 0.2f));
  view.quality.self_shadow = true;
  const std::vector<glm::vec4> drawn = drawFog(*renderer, canvas, view, instance);
  const double sun = double{pack.parts[0].fog->color.x} * 20 / (4 * std::numbers::pi);
  double most = 0, off = 0, shaded = 0, plain = 0;
  for (int y = 0; y < canvas.size().y; ++y) {
    for (int x = 0; x < canvas.size().x; ++x) {
      const PartRay ray = partRay(view, instance, chain->bounds, x, y);
      constexpr double kStep = 0.5;
      double through = 1, light = 0;
      for (double s = ray.begin + 0.5 * kStep; s < ray.end; s += kStep) {
        const glm::dvec3 p = ray.o + s * ray.r;
        double depth = 0;
        places(p, [&](const glm::dvec3& rest) { depth += truth.extinction() * truth.density(rest) * kStep; });
        if (depth == 0) continue;
        const double lit = coarse
                               .lookThrough(places, p, glm::dvec3(view.light.sun_direction), 0,
                                            glm::distance(chain->bounds.min, chain->bounds.max), kStep)
                               .through;
        light += through * (1 - std::exp(-depth)) * lit * sun;
        plain += through * (1 - std::exp(-depth)) * sun;
        through *= std::exp(-depth);
      }
      const double error =
          std::abs(light - double{drawn[static_cast<std::size_t>(x + canvas.size().x * y)].r});
      most = std::max(most, light);
      off = std::max(off, error);
      shaded += light;
    }
  }
  EXPECT_LT(shaded, 0.8 * plain);
  EXPECT_LT(off, 0.01 * most);
}

// Fog ends at the depth so far, in either convention, and begins at an eye that is in it.
TEST_P(SweptFog, EndsAtTheDepthSoFarAndBeginsAtTheEye) {
  if (!desktop()) return;  // OpenGL ES reads no floats back
  const FloatCanvas canvas({24, 20});
  const reference::SweepRig rig = reference::namedSweeps(kSweptSize)[6];
  const RawPack pack = sweptFog(fogOf(kSweptSize, [](const glm::dvec3&) { return 1.0; }), 0.05f, rig);
  const LoadedAsset fog(pack),
      wall(packOf({glm::ivec3(64, 64, 4), std::vector<std::uint8_t>(64 * 64 * 4, 1)}));
  const auto renderer = makeRenderer(*fog.asset);
  ASSERT_TRUE(renderer && renderer->add(*wall.asset) && renderer->upload(~std::uint64_t{0}));
  Instance both[2] = {{fog.asset.get(), nullptr}, {wall.asset.get(), nullptr}};
  const Box box = runtime::bounds(both[0]);
  const glm::vec3 middle = 0.5f * (box.min + box.max);
  const float reach = glm::length(box.max - box.min);
  // Its front goes through the middle of the fog; larger than the picture.
  both[1].to_world = glm::scale(
      glm::translate(glm::mat4(1), middle - glm::vec3(0, 2 * reach, 0.125f * reach)), glm::vec3(4 * reach));
  const double front = double{middle.z};
  const FogTruth truth(pack.parts[0], 0);
  const auto chain = drawnArcs(pack.parts[0], 0);
  const glm::vec3 inside = runtime::partToWorld(both[0], 0).value() *
                           glm::vec4(sweepPoint(*chain, kSweptSize, glm::vec3(kSweptSize) * 0.5f), 1);
  for (const bool reversed : {false, true}) {
    for (const bool in_it : {false, true}) {
      gl::View view =
          dark(in_it ? lookAt(canvas.size(), inside, inside + glm::vec3(0.2f, 0.1f, -1), 0.01f, 9)
                     : lookAt(canvas.size(), middle + glm::vec3(0.1f, 0.2f, 0.6f * reach), middle, 0.01f, 9));
      const gl::View rays = view;
      view.camera.reversed_depth = reversed;
      if (reversed) {
        view.camera.eye_to_clip[2][2] = -view.camera.eye_to_clip[2][2];
        view.camera.eye_to_clip[3][2] = -view.camera.eye_to_clip[3][2];
      }
      glClearDepth(reversed ? 0.0 : 1.0);
      glClearColor(0, 0, 0, 0);
      glClear(GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT);
      glClearDepth(1.0);
      if (!in_it) {
        ASSERT_TRUE(renderer->draw(view, both));
      }
      glClear(GL_COLOR_BUFFER_BIT);  // what the fog alone hides
      ASSERT_TRUE(renderer->draw(view, both, gl::Pass::kFog));
      const std::vector<glm::vec4> drawn = canvas.pixels();
      double sum = 0, error = 0;
      for (int y = 0; y < canvas.size().y; ++y) {
        for (int x = 0; x < canvas.size().x; ++x) {
          const PartRay ray = partRay(rays, both[0], chain->bounds, x, y);
          const runtime::Ray seen = pixelRay(rays, x, y);
          const glm::dmat4 to_part = glm::inverse(glm::dmat4(runtime::partToWorld(both[0], 0).value()));
          // (The wall stands across z.)
          const double to_wall = (front - double{seen.origin.z}) / double{seen.direction.z} *
                                 glm::length(glm::dmat3(to_part) * glm::dvec3(seen.direction));
          const FogSight sight = lookAlong(truth, *chain, ray, ray.begin,
                                           in_it ? ray.end : std::min(ray.end, to_wall), 1.0 / 64);
          const std::size_t at = static_cast<std::size_t>(x + canvas.size().x * y);
          // (Rays that touch a curved face see the hundredth of a voxel by which it is thicker.)
          EXPECT_NEAR(drawn[at].a, 1 - sight.through, 1e-2) << x << ' ' << y << reversed << in_it;
          error += std::abs(double{drawn[at].a} - (1 - sight.through));
          sum += 1 - sight.through;
        }
      }
      EXPECT_GT(sum, 10) << in_it;
      EXPECT_LT(error, 2e-3 * sum) << in_it;
    }
  }
}

// Clouds of both kinds, one behind the other: as if all were sheared.
TEST_P(SweptFog, IsBlendedFarToNearWithSheared) {
  const Canvas canvas({24, 24});
  const fields::FogSamples cube = fogOf({16, 16, 16}, [](const glm::dvec3&) { return 1.0; });
  const RawPack sheared = fogPack(cube, 0.1f);
  RawPack swept = sheared;
  swept.parts[0].bend = Bend::kSweep;
  const LoadedAsset assets[2] = {LoadedAsset(sheared), LoadedAsset(swept)};
  const auto renderer = makeRenderer(*assets[0].asset);
  ASSERT_TRUE(renderer && renderer->add(*assets[1].asset) && renderer->upload(~std::uint64_t{0}));
  const gl::View view = orthographic(canvas, {0, 0.5f, 5}, {0, 0.5f, 0}, 0.4f);
  const glm::vec4 tints[3] = {{1, 0, 0, 1}, {0, 1, 0, 1}, {0, 0, 1, 1}};
  std::vector<Pixel> pictures[2];
  for (const bool mixed : {false, true}) {
    Instance all[3];
    for (int i = 0; i < 3; ++i) {
      all[i] = {assets[mixed && i != 1].asset.get(), nullptr};
      all[i].to_world[3].z = 1.2f * static_cast<float>(i);
      all[i].tint = tints[i];
    }
    canvas.clear();
    const auto drawn = renderer->draw(view, all, gl::Pass::kFog);
    ASSERT_TRUE(drawn);
    EXPECT_EQ(drawn->draws, mixed ? 3u : 1u);
    EXPECT_EQ(drawn->instances, 3u);
    pictures[mixed] = canvas.pixels();
  }
  EXPECT_GT(pictures[0][12 * 24 + 12][2], 2 * pictures[0][12 * 24 + 12][1]);
  for (std::size_t i = 0; i < pictures[0].size(); ++i)
    for (std::size_t c = 0; c < 4; ++c) ASSERT_NEAR(pictures[0][i][c], pictures[1][i][c], 1) << i;
}

// While finer pages are missing, the coarser ones are drawn in their place.
TEST_P(SweptFog, IsCoarserUntilItsPagesAreThere) {
  if (!desktop()) return;  // OpenGL ES reads no floats back
  const glm::ivec3 size(48, 120, 40);
  const LoadedAsset loaded(sweptFog(fogOf(size, puffs), 0.1f, reference::namedSweeps(size)[6]));
  const auto renderer = makeRenderer(*loaded.asset);
  ASSERT_TRUE(renderer);
  expectCoarserUntilLoaded(*renderer, *loaded.asset);
}

TEST_P(SweptFog, IsTheSameInBothApis) {
  static std::vector<Pixel> first;
  const Canvas canvas({40, 48});
  const LoadedAsset loaded(sweptFog(
      fogOf(kSweptSize, puffs, [](const glm::dvec3& p) { return puffs(p) * p.x; }), 0.1f, overlapping()));
  gl::RendererOptions config;
  config.features = gl::Features::kSecondaryRays;
  const auto renderer = makeRenderer(*loaded.asset, nullptr, config);
  ASSERT_TRUE(renderer);
  const Instance instance{loaded.asset.get(), nullptr};
  gl::View view = framing(canvas.size(), instance);
  view.quality.self_shadow = true;
  ASSERT_TRUE(renderer->draw(view, {&instance, 1}, gl::Pass::kFog));
  const std::vector<Pixel> drawn = canvas.pixels();
  EXPECT_GT(std::count_if(drawn.begin(), drawn.end(), [](const Pixel& p) { return p[3] > 20; }), 200);
  if (first.empty()) {
    first = drawn;
  } else {
    EXPECT_EQ(first, drawn);
  }
}

}  // namespace

KELP_GL_TESTS(SweptFog);

}  // namespace kelp::test
