// SPDX-License-Identifier: MIT
// Swept fog against the integral that it stands for, in double precision through the inverse map of each
// slice; beside the same fog sheared, where both are straight; and all that fog has to do with beside itself.
#include <cmath>
#include <numbers>

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

struct Errors {
  double hidden = 0, glow = 0, sum = 0;
};
// The greatest of a picture.
Errors errorsOf(const std::vector<glm::vec4>& drawn, const glm::ivec2& size, const gl::View& view,
                const Instance& instance, const ArcChain& chain, const FogTruth& truth,
                const glm::ivec3& voxels) {
  Errors errors;
  for (int y = 0; y < size.y; ++y) {
    for (int x = 0; x < size.x; ++x) {
      const PartRay ray = partRay(view, instance, chain.bounds, x, y);
      const FogSight sight =
          ray.begin < ray.end ? truth.lookThrough(placesIn(chain, voxels), ray.o, ray.r, ray.begin, ray.end,
                                                  getenv("FOG_STEP") ? atof(getenv("FOG_STEP")) : 1.0 / 16)
                              : FogSight();
      const glm::vec4& pixel = drawn[static_cast<std::size_t>(x + size.x * y)];
      errors.hidden = std::max(errors.hidden, std::abs(1 - sight.through - double{pixel.a}));
      for (int c = 0; c < 3; ++c)
        errors.glow = std::max(errors.glow, std::abs(sight.glow[c] - double{pixel[c]}));
      errors.sum += 1 - sight.through;
    }
  }
  return errors;
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
        const Errors errors = errorsOf(drawFog(*renderer, canvas, view, instance), canvas.size(), view,
                                       instance, *chain, truth, kSweptSize);
        EXPECT_GT(errors.sum, 0.01);
        EXPECT_LT(errors.hidden, 2.5e-4);  // a sixteenth of what 8 bits tell apart
        EXPECT_LT(errors.glow, 2.0 / 255);
        if (getenv("FOG_PRINT"))
          printf("%s %d: %.2e %.2e\n", rig.name.c_str(), level, errors.hidden, errors.glow);
      }
    }
  }
}

}  // namespace

KELP_GL_TESTS(SweptFog);

}  // namespace kelp::test
