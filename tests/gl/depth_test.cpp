// SPDX-License-Identifier: MIT
// The depth buffer against the ground truth: every pixel's depth is taken back to a point of its ray, in
// double precision, and compared with where the ray first touches the solid.
#include <cmath>

#include <glm/gtc/matrix_transform.hpp>

#include "depth_canvas.h"
#include "reference/judge.h"
#include "reference/trials.h"
#include "support/voxel_points.h"

namespace kelp::test {
namespace {

using glm::dvec3;
using glm::dvec4;
using runtime::Instance;

constexpr double kAllowed = 0.5;  // voxels

struct Tally {
  std::uint64_t hits = 0;
  // hits further than kAllowed from the first touch that two solids a margin apart would both allow
  std::uint64_t grazing = 0;
  std::uint64_t wrong = 0;  // further than that and not grazing, or a hit that is owed and not there
  double buffer = 0;        // what one step of the depth buffer is worth, at most
  void add(const Tally& more) {
    hits += more.hits;
    grazing += more.grazing;
    wrong += more.wrong;
    buffer = std::max(buffer, more.buffer);
  }
};

struct NamedView {
  const char* name;
  gl::View view;
};

class DepthTest : public GlTest {
 protected:
  static constexpr glm::ivec2 kPixels{120, 90};
  const fields::Occupancy volume_ = ballClump({192, 187, 146}, 40, 6);
  const LoadedAsset loaded_{packOf(volume_)};
  const reference::Volume truth_{volume_.size, volume_.solid, 1.0, volume_.size};
  const double voxel_ = 1.0 / volume_.size.y;  // meters

  // Six views of what `box` holds. Near and far are as close as the box allows, so that the buffer's own
  // steps are small.
  std::vector<NamedView> viewsOf(const Instance& instance) const {
    const Box box = bounds(instance);
    const glm::vec3 center = 0.5f * (box.min + box.max);
    const float reach = glm::distance(box.min, box.max);
    const auto voxels = [&](double n) { return static_cast<float>(n * voxel_); };
    const auto view = [&](const glm::vec3& eye, const glm::vec3& target, const glm::vec3& up,
                          const glm::mat4& to_clip) {
      gl::View v;
      v.camera.world_to_eye = glm::lookAt(eye, target, up);
      v.camera.eye_to_clip = to_clip;
      v.camera.viewport = kPixels;
      v.quality.pixels_per_voxel = 0;
      return v;
    };
    const float aspect = static_cast<float>(kPixels.x) / static_cast<float>(kPixels.y);
    const glm::vec3 y(0, 1, 0), size(volume_.size);
    const glm::vec3 middle = voxelToWorld(instance, 0, 0.5f * size);
    const glm::vec3 towards = glm::normalize(glm::vec3(0.5f, 0.3f, 0.8f));
    const glm::mat4 inside = glm::perspective(1.2f, aspect, voxels(2), reach);
    const float distance = voxels(1e4);
    const float narrow = 2 * std::atan(0.35f * reach / distance);
    return {
        {"perspective", view(center + reach * towards, center, y,
                             glm::perspective(0.8f, aspect, 0.4f * reach, 1.6f * reach))},
        {"inside the box",
         view(middle, voxelToWorld(instance, 0, size * glm::vec3(0.8f, 0.45f, 0.4f)), y, inside)},
        {"along the spline", view(center + glm::vec3(0, 1.2f * reach, 0), center, {0, 0, 1},
                                  glm::perspective(0.7f, aspect, 0.6f * reach, 1.8f * reach))},
        // Half a height that puts no row of pixels exactly between two layers of voxels, where either would
        // be right.
        {"exactly horizontal",
         view(middle + glm::vec3(0, 0, reach), middle, y,
              glm::ortho(-0.7123f * aspect, 0.7123f * aspect, -0.7123f, 0.7123f, 0.0f, 2 * reach))},
        {"1e4 voxels away",
         view(center + distance * towards, center, y,
              glm::perspective(narrow, aspect, distance - 0.6f * reach, distance + 0.6f * reach))},
        {"close up", view(voxelToWorld(instance, 0, size * glm::vec3(0.5f, 0.6f, 1.2f)), middle, y,
                          glm::perspective(0.9f, aspect, voxels(4), reach))},
    };
  }

  Tally compare(gl::Renderer& renderer, const DepthCanvas& canvas, const gl::View& view,
                const Instance& instance, std::span<const Knot> knots, GLenum format = GL_DEPTH_COMPONENT32F,
                glm::dvec2 depth_range = {0, 1}) const {
    canvas.clear();
    glDepthRangef(static_cast<float>(depth_range.x), static_cast<float>(depth_range.y));
    const auto drawn = renderer.draw(view, {&instance, 1});
    glDepthRangef(0, 1);
    EXPECT_TRUE(drawn) << (drawn ? "" : drawn.error().detail);
    const std::vector<Pixel> pixels = canvas.pixels();
    const std::vector<float> depths = canvas.depths();
    const glm::dmat4 to_part =
        glm::inverse(glm::dmat4(view.camera.eye_to_clip) * glm::dmat4(view.camera.world_to_eye) *
                     glm::dmat4(partToWorld(instance, 0).value()));
    Tally tally;
    for (int row = 0; row < kPixels.y; ++row) {
      for (int column = 0; column < kPixels.x; ++column) {
        const auto i = static_cast<std::size_t>(kPixels.x * row + column);
        const glm::dvec2 at = 2.0 * (glm::dvec2(column, row) + 0.5) / glm::dvec2(kPixels) - 1.0;
        const auto point = [&](double depth) {
          const dvec4 p =
              to_part * dvec4(at, 2 * (depth - depth_range.x) / (depth_range.y - depth_range.x) - 1, 1);
          return dvec3(p) / p.w;
        };
        const dvec3 from = point(depth_range.x), to = point(depth_range.y);
        const double reach = glm::distance(from, to);
        const dvec3 ray = (to - from) / reach;
        const auto touch = reference::firstTouch(truth_, knots, from, ray, 0, reach, 0);
        if (pixels[i][3] == 0) {
          tally.wrong +=
              touch && reference::firstTouch(truth_, knots, from, ray, 0, reach, reference::kMargin);
          continue;
        }
        ++tally.hits;
        const double depth = double{depths[i]};
        const double next =
            format == GL_DEPTH_COMPONENT32F ? double{std::nextafter(depths[i], 2.0f)} : depth + 0x1p-24;
        tally.buffer = std::max(tally.buffer, glm::distance(point(depth), point(next)));
        const double s = glm::dot(point(depth) - from, ray);
        const double error = touch ? std::abs(s - touch->s) : 1e30;
        if (error > kAllowed) {
          // Right all the same if a solid that is a hundredth of a voxel larger or smaller is touched there.
          const reference::Truth truth = reference::truthOf(truth_, knots, from, ray, reach);
          const bool grazing = truth.possible && s >= *truth.possible - kAllowed &&
                               (!truth.owed || s <= *truth.owed + kAllowed);
          ++(grazing ? tally.grazing : tally.wrong);
        }
      }
    }
    return tally;
  }

  // At most 0.1 % of the hits may graze; a single view holds too few of them to be held to that.
  static void expectGood(const Tally& t, const char* what, double share = 0.001) {
    EXPECT_EQ(t.wrong, 0u) << what;
    EXPECT_LE(static_cast<double>(t.grazing), share * static_cast<double>(t.hits)) << what;
    EXPECT_LT(t.buffer, 0.05) << what << ": the depth buffer is measured, not the tracing";
  }
};

TEST_P(DepthTest, IsWithinHalfAVoxelOfTheTruth) {
  const DepthCanvas canvas(GetParam(), kPixels, GL_DEPTH_COMPONENT32F);
  const auto renderer = makeRenderer(*loaded_.asset, kVoxelSurface);
  std::vector<reference::TrialRig> rigs = reference::namedRigs(volume_.size);
  Tally all, of_views[6];
  std::vector<NamedView> views;
  for (const reference::TrialRig& rig : rigs) {
    // Rigs differ in their number of knots, so each needs a pack; the voxels are the same.
    std::optional<LoadedAsset> own;
    std::unique_ptr<gl::Renderer> own_renderer;
    std::optional<runtime::Pose> pose;
    if (rig.knots.size() == 2) {
      pose.emplace(*runtime::Pose::create(*loaded_.asset));
      (void)pose->setKnots(0, rig.knots);
    } else {
      own.emplace(packOf(volume_, rig.knots));
      own_renderer = makeRenderer(*own->asset, kVoxelSurface);
    }
    const Instance instance{own ? own->asset.get() : loaded_.asset.get(), pose ? &*pose : nullptr};
    views = viewsOf(instance);
    Tally of_rig;
    for (std::size_t v = 0; v < views.size(); ++v) {
      const Tally tally =
          compare(own ? *own_renderer : *renderer, canvas, views[v].view, instance, rig.knots);
      of_rig.add(tally);
      of_views[v].add(tally);
    }
    EXPECT_GT(of_rig.hits, 500u) << rig.name;
    all.add(of_rig);
  }
  for (std::size_t v = 0; v < views.size(); ++v) {
    EXPECT_GT(of_views[v].hits, 1000u) << views[v].name;
    expectGood(of_views[v], views[v].name, 0.002);
  }
  expectGood(all, "all");
}

// 24 bits, the host's own depth range, and one that is turned around. Clip coordinates reach from -w to w, so
// a reversed range is no more exact.
TEST_P(DepthTest, IsThatInEveryBufferAndRange) {
  runtime::Pose pose = *runtime::Pose::create(*loaded_.asset);
  const std::vector<Knot> knots = figureKnots(kFigure6[1]);
  (void)pose.setKnots(0, knots);
  const Instance instance{loaded_.asset.get(), &pose};
  const auto renderer = makeRenderer(*loaded_.asset, kVoxelSurface);
  for (const GLenum format : {GL_DEPTH_COMPONENT24, GL_DEPTH_COMPONENT32F}) {
    const DepthCanvas canvas(GetParam(), kPixels, format);
    for (const glm::dvec2 range : {glm::dvec2(0, 1), glm::dvec2(1, 0), glm::dvec2(0.25, 0.75)}) {
      Tally tally;
      for (const NamedView& view : viewsOf(instance))
        tally.add(compare(*renderer, canvas, view.view, instance, knots, format, range));
      const std::string bits = format == GL_DEPTH_COMPONENT24 ? "24 bits" : "32 bits";
      const std::string what = bits + " from " + std::to_string(range.x);
      EXPECT_GT(tally.hits, 1500u) << what;
      expectGood(tally, what.c_str());
    }
  }
}

KELP_GL_TESTS(DepthTest);

}  // namespace
}  // namespace kelp::test
