// SPDX-License-Identifier: MIT
// OpenGL 3.3 core and OpenGL ES 3.0 draw the same picture: colors within 1/255 of each other but at edges,
// depths within half a voxel.
#include <cmath>
#include <cstdio>
#include <cstdlib>

#include <glm/gtc/matrix_transform.hpp>

#include "depth_canvas.h"
#include "support/voxel_points.h"
#include "swept_pack.h"

namespace kelp::test {
namespace {

using runtime::Instance;

constexpr glm::ivec2 kPixels{200, 150};

// The picture by one API: the default look, and which instance and how far.
struct Picture {
  std::vector<Pixel> colors;
  std::vector<Pixel> names;    // the instance's tint: nothing, or one of the scene's instances
  std::vector<double> depths;  // along the view, meters
};

struct Scene {
  std::string name;
  std::vector<Instance> instances;
  gl::View view;
  double voxel;  // meters, of the largest instance
};

// The scenes, made anew for each context: bent poses, several instances, mirrored and stretched, coarse
// voxels near the eye, the eye inside.
class Scenes {
 public:
  Scenes() {
    for (std::size_t i = 0; i < kFigure6.size(); ++i) {
      const std::vector<Knot> knots = figureKnots(kFigure6[i]);
      (void)poses_[i].setKnots(0, knots);
    }
    const Instance rest{asset(), nullptr};
    for (std::size_t i = 1; i < kFigure6.size(); ++i) {
      const Instance bent{asset(), &poses_[i]};
      const glm::vec3 middle = voxelToWorld(bent, 0, 0.5f * glm::vec3(volume_.size));
      scenes_.push_back({kFigure6[i].name,
                         {bent},
                         lookAt(kPixels, middle + glm::vec3(0.4f, 0.25f, 0.65f), middle),
                         voxel()});
    }
    std::vector<Instance> many;
    for (int i = 0; i < 9; ++i) {
      Instance instance{asset(), i % 3 ? &poses_[static_cast<std::size_t>(1 + i % 3)] : nullptr};
      const auto f = static_cast<float>(i);
      instance.to_world =
          glm::rotate(glm::translate(glm::mat4(1), {1.1f * static_cast<float>(i % 3) - 1, 0.2f * f - 0.8f,
                                                    -0.9f * static_cast<float>(i / 3)}),
                      f, {0.2f, 1, 0.1f * f}) *
          glm::scale(glm::mat4(1), {i % 2 ? 0.7f : -0.7f, 0.6f + 0.05f * f, 0.8f});
      instance.tint = {0.3f + 0.07f * f, 1 - 0.09f * f, 0.5f + 0.05f * f, 1};
      many.push_back(instance);
    }
    scenes_.push_back(
        {"nine instances", many, lookAt(kPixels, {0.4f, 0.8f, 1.6f}, {0.1f, 0.3f, -0.6f}), voxel()});
    gl::View close = lookAt(kPixels, {0.25f, 0.55f, 0.75f}, {0, 0.5f, 0});
    scenes_.push_back({"close up", {rest}, close, voxel()});
    close.quality.shading = gl::Shading::kFaces;
    scenes_.push_back({"close up, faces", {rest}, close, voxel()});
    close.quality.shading = gl::Shading::kSmooth;
    scenes_.push_back({"close up, smooth", {rest}, close, voxel()});
    const Instance bent{asset(), &poses_[1]};
    scenes_.push_back(
        {"eye inside",
         {bent},
         lookAt(kPixels, voxelToWorld(bent, 0, {30, 62, 25}), voxelToWorld(bent, 0, {60, 40, 30}), 0.02f),
         voxel()});
    scenes_.push_back({"orthographic",
                       {Instance{asset(), &poses_[2]}},
                       orthographic(kPixels, {3, 2, 4}, {0, 0.5f, 0}, 0.7f),
                       voxel()});
    gl::View coarse = lookAt(kPixels, {0.8f, 0.9f, 1.8f}, {0, 0.5f, 0});
    coarse.quality.finest_level = 2;
    scenes_.push_back({"level 2", {Instance{asset(), &poses_[3]}}, coarse, 4 * voxel()});
    for (const reference::SweepRig& rig : reference::namedSweeps(volume_.size)) {
      swept_.push_back(std::make_unique<LoadedAsset>(sweptPackOf(volume_, rig)));
      const Instance swept{swept_.back()->asset.get()};
      const Box box = bounds(swept);
      const glm::vec3 middle = 0.5f * (box.min + box.max), away = glm::vec3(0.5f, 0.3f, 0.8f);
      scenes_.push_back({"swept, " + rig.name,
                         {swept},
                         lookAt(kPixels, middle + 0.6f * glm::distance(box.min, box.max) * away, middle),
                         voxel()});
    }
  }
  const std::vector<Scene>& all() const { return scenes_; }
  const runtime::Asset* asset() const { return loaded_.asset.get(); }
  void addTo(gl::Renderer& renderer) const {
    EXPECT_TRUE(renderer.add(*asset()));
    for (const auto& swept : swept_) EXPECT_TRUE(renderer.add(*swept->asset));
    EXPECT_TRUE(renderer.upload(~std::uint64_t{0}));
  }

 private:
  double voxel() const { return 1.0 / volume_.size.y; }

  const fields::Occupancy volume_ = ballClump({60, 80, 50}, 20, 2);
  const LoadedAsset loaded_{packOf(volume_)};
  std::array<runtime::Pose, 7> poses_{pose(), pose(), pose(), pose(), pose(), pose(), pose()};
  std::vector<std::unique_ptr<LoadedAsset>> swept_;
  std::vector<Scene> scenes_;
  runtime::Pose pose() const { return *runtime::Pose::create(*loaded_.asset); }
};

class TwoApisTest : public testing::Test {
 protected:
  // Empty, if the machine has no such context.
  static std::vector<Picture> draw(GlApi api, std::vector<std::string>& names, std::vector<double>& voxels) {
    EglContext context(api);
    if (!context) return {};
    const DepthCanvas canvas(api, kPixels, GL_DEPTH_COMPONENT32F);
    const Scenes scenes;
    gl::RendererOptions config;
    config.getProcAddress = EglContext::getProcAddress;
    config.gpu_budget = kGpuBudget;
    config.log = [](void*, const char* text) { ADD_FAILURE() << text; };
    const auto shaded = gl::Renderer::create(config);
    config.surface_glsl =
        "vec4 kelpSurface(KelpSurface s) { return vec4(kelpRecord(kelp_record + 11).rgb, 1.0); }\n";
    const auto named = gl::Renderer::create(config);
    std::vector<Picture> pictures;
    for (const auto* renderer : {&shaded, &named}) scenes.addTo(***renderer);
    for (const Scene& scene : scenes.all()) {
      Picture picture;
      canvas.clear();
      EXPECT_TRUE((*shaded)->draw(scene.view, scene.instances));
      picture.colors = canvas.pixels();
      const glm::dmat4 to_eye = glm::inverse(glm::dmat4(scene.view.camera.eye_to_clip));
      const std::vector<float> depths = canvas.depths();
      for (std::size_t i = 0; i < depths.size(); ++i) {
        const glm::dvec2 at =
            2.0 * (glm::dvec2(i % kPixels.x, i / kPixels.x) + 0.5) / glm::dvec2(kPixels) - 1.0;
        const glm::dvec4 p = to_eye * glm::dvec4(at, 2 * double{depths[i]} - 1, 1);
        picture.depths.push_back(-p.z / p.w);
      }
      canvas.clear();
      EXPECT_TRUE((*named)->draw(scene.view, scene.instances));
      picture.names = canvas.pixels();
      pictures.push_back(std::move(picture));
      names.push_back(scene.name);
      voxels.push_back(scene.voxel);
    }
    EXPECT_EQ(glGetError(), GLenum{GL_NO_ERROR});
    return pictures;
  }

  // An edge: a pixel one of whose four neighbors shows another instance, or nothing where it shows
  // something, or lies more than two voxels nearer or farther; in either picture.
  static bool isEdge(const Picture& picture, int x, int y, double voxel) {
    const auto i = static_cast<std::size_t>(kPixels.x * y + x);
    for (const glm::ivec2 step : {glm::ivec2(1, 0), glm::ivec2(-1, 0), glm::ivec2(0, 1), glm::ivec2(0, -1)}) {
      const glm::ivec2 at = glm::ivec2(x, y) + step;
      if (at.x < 0 || at.y < 0 || at.x >= kPixels.x || at.y >= kPixels.y) continue;
      const auto j = static_cast<std::size_t>(kPixels.x * at.y + at.x);
      if (picture.names[i] != picture.names[j]) return true;
      if (picture.names[i][3] != 0 && std::abs(picture.depths[i] - picture.depths[j]) > 2 * voxel)
        return true;
    }
    return false;
  }
};

TEST_F(TwoApisTest, DrawTheSameColorsButAtEdges) {
  std::vector<std::string> names, same_names;
  std::vector<double> voxels, same_voxels;
  const std::vector<Picture> desktop = draw(GlApi::kDesktop33, names, voxels),
                             embedded = draw(GlApi::kEs30, same_names, same_voxels);
  if (desktop.empty() || embedded.empty())
    GTEST_SKIP() << "no EGL device gives both contexts: install libegl1 libgl1-mesa-dri";
  ASSERT_EQ(desktop.size(), embedded.size());
  for (std::size_t s = 0; s < desktop.size(); ++s) {
    const Picture &a = desktop[s], &b = embedded[s];
    int within = 0, edges = 0, edges_differ = 0, others_differ = 0, worst = 0, depths_differ = 0;
    for (int y = 0; y < kPixels.y; ++y) {
      for (int x = 0; x < kPixels.x; ++x) {
        const auto i = static_cast<std::size_t>(kPixels.x * y + x);
        const bool edge = isEdge(a, x, y, voxels[s]) || isEdge(b, x, y, voxels[s]);
        int difference = 0;
        for (std::size_t c = 0; c < 4; ++c)
          difference = std::max(difference, std::abs(a.colors[i][c] - b.colors[i][c]));
        edges += edge;
        within += !edge && a.names[i][3] != 0;
        edges_differ += edge && difference > 1;
        others_differ += !edge && difference > 1;
        depths_differ += !edge && std::abs(a.depths[i] - b.depths[i]) > 0.5 * voxels[s];
        if (!edge) worst = std::max(worst, difference);
      }
    }
    std::printf(
        "%-20s %5d pixels at edges, of which %d differ by more than 1/255; %5d within surfaces; %d differ "
        "anywhere but at edges, at most %d/255\n",
        names[s].c_str(), edges, edges_differ, within, others_differ, worst);
    EXPECT_GT(within, 2000) << names[s] << ": hardly anything but edges";
    EXPECT_EQ(others_differ, 0) << names[s];
    EXPECT_EQ(depths_differ, 0) << names[s];
    EXPECT_LE(50 * edges_differ, edges) << names[s];
  }
}

}  // namespace
}  // namespace kelp::test
