// SPDX-License-Identifier: MIT
// The caller's mistakes are answered, in every build, and nothing is drawn.
#include <cmath>
#include <limits>

#include "canvas.h"
#include "support/edit_knots.h"
#include "support/fake_gl.h"

namespace kelp::test {
namespace {

using runtime::Instance;

class MisuseTest : public GlTest {
 protected:
  const LoadedAsset loaded_{packOf(ballClump({24, 32, 20}, 12, 3))};
  const LoadedAsset other_{
      packOf(ballClump({24, 32, 20}, 12, 4),
             {{0, {0, 0, 0}, {0, 1, 0}}, {0.5f, {0, 0.5f, 0}, {0, 1, 0}}, {1, {0, 1, 0}, {0, 1, 0}}})};
  const Instance instance_{loaded_.asset.get(), nullptr};

  static gl::RendererOptions quiet() {
    gl::RendererOptions config;
    config.log = [](void*, const char*) {};
    return config;
  }

  // The bad instance is left out, the good one is drawn as it is alone.
  void expectLeftOut(gl::Renderer& renderer, const Canvas& canvas, const gl::View& view,
                     const Instance& bad) {
    canvas.clear();
    ASSERT_TRUE(renderer.draw(view, {&instance_, 1}));
    const std::vector<Pixel> alone = canvas.pixels();
    for (const std::size_t place : {0, 1}) {
      canvas.clear();
      const Instance both[2] = {place == 0 ? bad : instance_, place == 0 ? instance_ : bad};
      const auto drawn = renderer.draw(view, both);
      ASSERT_TRUE(drawn) << drawn.error().detail;
      EXPECT_EQ(drawn->left_out, 1u);
      EXPECT_EQ(drawn->first_left_out.offset, place);
      EXPECT_EQ(drawn->first_left_out.unit, Error::Unit::kInstance);
      EXPECT_NE(drawn->first_left_out.detail[0], '\0');
      EXPECT_EQ(drawn->instances, 1u);
      EXPECT_EQ(canvas.pixels(), alone);
      EXPECT_EQ(glGetError(), GLenum{GL_NO_ERROR});
    }
    canvas.clear();
  }

  void expectMisuse(gl::Renderer& renderer, const Canvas& canvas, const gl::View& view, const Instance& bad) {
    const Instance both[2] = {instance_, bad};
    const auto drawn = renderer.draw(view, both);
    ASSERT_FALSE(drawn);
    EXPECT_EQ(drawn.error().code, ErrorCode::kMisuse);
    EXPECT_NE(drawn.error().detail[0], '\0');
    EXPECT_EQ(drawn.error().offset, 1u);
    EXPECT_EQ(drawn.error().unit, Error::Unit::kInstance);
    EXPECT_EQ(glGetError(), GLenum{GL_NO_ERROR});
    for (const Pixel& pixel : canvas.pixels()) ASSERT_EQ(pixel, Pixel{}) << "the good instance was drawn";
  }
};

TEST_P(MisuseTest, OfInstances) {
  const Canvas canvas({40, 30});
  const auto renderer = makeRenderer(*loaded_.asset, nullptr, quiet());
  const gl::View view = lookAt(canvas, {0.8f, 0.9f, 1.8f}, {0, 0.5f, 0});
  expectMisuse(*renderer, canvas, view, {nullptr, nullptr});
  expectMisuse(*renderer, canvas, view, {other_.asset.get(), nullptr});

  const runtime::Pose foreign = *runtime::Pose::create(*other_.asset);
  expectMisuse(*renderer, canvas, view, {loaded_.asset.get(), &foreign});
  const std::vector<Material> materials(loaded_.asset->pack().palette().size() + 1);
  Instance painted = instance_;
  painted.palette = materials;
  expectMisuse(*renderer, canvas, view, painted);
  runtime::Pose turning = *runtime::Pose::create(*loaded_.asset);
  edit(turning, 0, 32)[0].tangent.y = -400;
  expectLeftOut(*renderer, canvas, view, {loaded_.asset.get(), &turning});

  Instance bad = instance_;
  bad.to_world[1] = glm::vec4(0);
  expectLeftOut(*renderer, canvas, view, bad);
  bad = instance_;
  bad.to_world[3].x = std::numeric_limits<float>::quiet_NaN();
  expectLeftOut(*renderer, canvas, view, bad);
  bad = instance_;
  bad.to_world[0][3] = 0.5f;  // not affine
  expectLeftOut(*renderer, canvas, view, bad);
}

TEST_P(MisuseTest, OfNumbersThatAreNone) {
  const Canvas canvas({40, 30});
  const auto renderer = makeRenderer(*loaded_.asset, nullptr, quiet());
  const gl::View view = lookAt(canvas, {0.8f, 0.9f, 1.8f}, {0, 0.5f, 0});
  constexpr float kNan = std::numeric_limits<float>::quiet_NaN(),
                  kInfinity = std::numeric_limits<float>::infinity();
  runtime::Pose pose = *runtime::Pose::create(*loaded_.asset);
  const Instance posed{loaded_.asset.get(), &pose};
  for (const float bad : {kNan, kInfinity, -kInfinity}) {
    for (std::size_t knot = 0; knot < 2; ++knot) {
      for (int axis = 0; axis < 3; ++axis) {
        SCOPED_TRACE(testing::Message() << bad << " in knot " << knot << ", axis " << axis);
        pose.reset();
        edit(pose, 0, 32)[knot].tangent[axis] = bad;
        expectLeftOut(*renderer, canvas, view, posed);
        pose.reset();
        edit(pose, 0, 32)[knot].position[axis] = bad;
        expectLeftOut(*renderer, canvas, view, posed);
      }
    }
    for (int axis = 0; axis < 3; ++axis) {
      SCOPED_TRACE(testing::Message() << bad << " in the motion, axis " << axis);
      for (const int what : {0, 1, 2}) {
        pose.reset();
        runtime::Motion& motion = *pose.motion(0);
        (what == 0 ? motion.translation[axis] : what == 1 ? motion.scale[axis] : motion.rotation[axis]) = bad;
        expectLeftOut(*renderer, canvas, view, posed);
      }
    }
    for (int column = 0; column < 4; ++column) {
      for (int row = 0; row < 4; ++row) {
        SCOPED_TRACE(testing::Message() << bad << " in column " << column << ", row " << row);
        Instance moved = instance_;
        moved.to_world[column][row] = bad;
        expectLeftOut(*renderer, canvas, view, moved);
      }
    }
  }
  // Numbers, but such that nothing can be computed with them: whatever is answered, OpenGL is not troubled,
  // and the next frame is drawn.
  for (const float huge : {1e15f, 1e30f, 3e38f}) {
    pose.reset();
    edit(pose, 0, 32)[0].tangent.x = huge;
    edit(pose, 0, 32)[1].tangent.z = -huge;
    (void)renderer->draw(view, {&posed, 1});
    EXPECT_EQ(glGetError(), GLenum{GL_NO_ERROR}) << huge;
  }
  canvas.clear();
  const auto drawn = renderer->draw(view, {&instance_, 1});
  ASSERT_TRUE(drawn);
  EXPECT_EQ(drawn->draws, 1u);
}

TEST_P(MisuseTest, OfViews) {
  const Canvas canvas({40, 30});
  const auto renderer = makeRenderer(*loaded_.asset);
  const gl::View good = lookAt(canvas, {0.8f, 0.9f, 1.8f}, {0, 0.5f, 0});
  const auto expectMisuseOf = [&](const gl::View& view) {
    const auto drawn = renderer->draw(view, {&instance_, 1});
    ASSERT_FALSE(drawn);
    EXPECT_EQ(drawn.error().code, ErrorCode::kMisuse);
    EXPECT_EQ(glGetError(), GLenum{GL_NO_ERROR});
  };
  gl::View view = good;
  view.camera.eye_to_clip = glm::mat4(0);
  expectMisuseOf(view);
  view = good;
  view.camera.world_to_eye[2].y = std::numeric_limits<float>::infinity();
  expectMisuseOf(view);
  view = good;
  view.light.sun_direction = glm::vec3(0);
  expectMisuseOf(view);
  view = good;
  view.quality.pixels_per_voxel = std::nanf("");
  expectMisuseOf(view);
  view = good;
  view.debug = static_cast<gl::DebugView>(7);
  expectMisuseOf(view);

  for (const Pixel& pixel : canvas.pixels()) ASSERT_EQ(pixel, Pixel{});
  EXPECT_EQ(renderer->draw(good, {})->draws, 0u);
}

// A renderer without the other shadings draws the same picture, and refuses them.
TEST_P(MisuseTest, OfShadingsThatAreLeftOut) {
  const Canvas canvas({80, 60});
  gl::View view = lookAt(canvas, {0.8f, 0.9f, 1.8f}, {0, 0.5f, 0});
  gl::RendererOptions config = quiet();
  const auto whole = makeRenderer(*loaded_.asset, nullptr, config);
  canvas.clear();
  ASSERT_TRUE(whole->draw(view, {&instance_, 1}));
  const std::vector<Pixel> expected = canvas.pixels();
  config.features = gl::Features::kGradientOnly;
  const auto smaller = makeRenderer(*loaded_.asset, nullptr, config);
  canvas.clear();
  ASSERT_TRUE(smaller->draw(view, {&instance_, 1}));
  EXPECT_EQ(canvas.pixels(), expected);
  EXPECT_NE(expected, std::vector<Pixel>(expected.size()));
  for (const gl::Shading shading : {gl::Shading::kFaces, gl::Shading::kSmooth}) {
    view.quality.shading = shading;
    EXPECT_TRUE(whole->draw(view, {&instance_, 1}));
    const auto refused = smaller->draw(view, {&instance_, 1});
    ASSERT_FALSE(refused);
    EXPECT_EQ(refused.error().code, ErrorCode::kMisuse);
  }
}

TEST_P(MisuseTest, OfTheRenderer) {
  const auto renderer = makeRenderer(*loaded_.asset);
  EXPECT_EQ(renderer->add(*loaded_.asset).error().code, ErrorCode::kMisuse);
  renderer->remove(*other_.asset);  // unknown: nothing happens
  EXPECT_EQ(gl::Renderer::create({}).error().code, ErrorCode::kMisuse);
  gl::RendererOptions nothing;
  nothing.getProcAddress = [](void*, const char*) -> void* { return nullptr; };
  EXPECT_EQ(gl::Renderer::create(nothing).error().code, ErrorCode::kGraphics);
  gl::RendererOptions partial;
  partial.getProcAddress = [](void* user, const char* name) {
    return std::string(name) == "glDrawArraysInstanced" ? nullptr : EglContext::getProcAddress(user, name);
  };
  EXPECT_EQ(gl::Renderer::create(partial).error().code, ErrorCode::kGraphics);
}

TEST_P(MisuseTest, NoContextIsAnError) {
  context_.reset();
  gl::RendererOptions config;
  config.getProcAddress = EglContext::getProcAddress;
  config.gpu_budget = kGpuBudget;
  const auto created = gl::Renderer::create(config);
  ASSERT_FALSE(created);
  EXPECT_EQ(created.error().code, ErrorCode::kGraphics);
}

TEST_P(MisuseTest, ASurfaceThatDoesNotCompileIsExplained) {
  static std::string said;
  said.clear();
  gl::RendererOptions config;
  config.getProcAddress = EglContext::getProcAddress;
  config.gpu_budget = kGpuBudget;
  config.log = [](void*, const char* text) { said = text; };
  config.surface_glsl = "vec4 kelpSurface(KelpSurface s) {\n  return s.nonsense;\n}\n";
  const auto created = gl::Renderer::create(config);
  ASSERT_FALSE(created);
  EXPECT_EQ(created.error().code, ErrorCode::kGraphics);
  EXPECT_NE(said.find("nonsense"), std::string::npos) << said;
  EXPECT_NE(said.find(":2("), std::string::npos) << "the line in the host's text: " << said;
}

// A loader may invent a function for every name that begins with "gl". GLX has no context of OpenGL ES.
TEST(ContextOfGlx, IsNotAskedForWithOpenGlEs) {
  static int asked;
  FakeGl fake;
  FakeGl::current() = &fake;
  gl::RendererOptions config;
  config.gpu_budget = kGpuBudget;
  config.getProcAddress = [](void* user, const char* name) {
    void* (*const invented)() = []() -> void* { return ++asked, nullptr; };
    return std::string(name) == "glXGetCurrentContext" ? reinterpret_cast<void*>(invented)
                                                       : FakeGl::getProcAddress(user, name);
  };
  for (const auto& [version, calls] : {std::pair{"OpenGL ES 3.0 fake", 0}, std::pair{"3.3 fake", 1}}) {
    asked = 0;
    fake.version = version;
    EXPECT_TRUE(gl::Renderer::create(config));
    EXPECT_EQ(asked, calls) << version;
  }
}

KELP_GL_TESTS(MisuseTest);

}  // namespace
}  // namespace kelp::test
