// SPDX-License-Identifier: MIT
// In a debug context the driver has nothing to say against what kelp does, and kelp says who it is.
#include <algorithm>
#include <set>

#include "gl_state.h"
#include "support/fog_pack.h"
#include "swept_pack.h"

namespace kelp::test {
namespace {

using runtime::Instance;

struct Message {
  GLenum type = 0, severity = 0;
  std::string text;
  // A driver may send notes, and what the application itself pushes. All else is a complaint.
  bool isComplaint() const {
    return severity != GL_DEBUG_SEVERITY_NOTIFICATION &&
           (type == GL_DEBUG_TYPE_ERROR || type == GL_DEBUG_TYPE_UNDEFINED_BEHAVIOR ||
            type == GL_DEBUG_TYPE_DEPRECATED_BEHAVIOR || type == GL_DEBUG_TYPE_PORTABILITY ||
            type == GL_DEBUG_TYPE_PERFORMANCE);
  }
};

class DebugTest : public testing::TestWithParam<GlApi> {
 protected:
  void SetUp() override {
    context_.emplace(GetParam(), true);
    if (!*context_) GTEST_SKIP() << "no EGL device gives such a context: install libegl1 libgl1-mesa-dri";
    GLint flags = 0;
    if (GlLimits::read().has(43, 32)) glGetIntegerv(GL_CONTEXT_FLAGS, &flags);
    if (!(flags & GL_CONTEXT_FLAG_DEBUG_BIT)) GTEST_SKIP() << "this context has no debug output";
    glEnable(GL_DEBUG_OUTPUT);
    glEnable(GL_DEBUG_OUTPUT_SYNCHRONOUS);
    glDebugMessageControl(GL_DONT_CARE, GL_DONT_CARE, GL_DONT_CARE, 0, nullptr, GL_TRUE);
    glDebugMessageCallback(
        [](GLenum, GLenum type, GLuint, GLenum severity, GLsizei length, const GLchar* text,
           const void* user) {
          static_cast<std::vector<Message>*>(const_cast<void*>(user))
              ->push_back({type, severity, std::string(text, static_cast<std::size_t>(length))});
        },
        &messages_);
  }

  std::vector<std::string> complaints() const {
    std::vector<std::string> out;
    for (const Message& message : messages_) {
      if (message.isComplaint()) out.push_back(message.text);
    }
    return out;
  }

  // A renderer's life: two assets, every level in a step of its own while frames are drawn, all passes and
  // looks, instances near and far.
  void live(const char* surface, gl::State state) {
    const Canvas canvas({80, 60});
    gl::RendererOptions config;
    config.getProcAddress = EglContext::getProcAddress;
    config.gpu_budget = kGpuBudget;
    config.surface_glsl = surface;
    config.state = state;
    const auto created = gl::Renderer::create(config);
    ASSERT_TRUE(created);
    gl::Renderer& renderer = **created;
    std::vector<Instance> instances;
    for (int i = 0; i < 24; ++i) {
      Instance instance{i % 2 ? ball_.asset.get() : clump_.asset.get(), nullptr};
      instance.to_world[3] = {0.4f * static_cast<float>(i % 5) - 0.8f, 0, -0.5f * static_cast<float>(i), 1};
      instances.push_back(instance);
    }
    ASSERT_TRUE(renderer.add(*ball_.asset));
    ASSERT_TRUE(renderer.add(*clump_.asset));
    gl::View view = lookAt(canvas, {0.8f, 0.9f, 1.8f}, {0, 0.5f, 0});
    view.quality.pixels_per_voxel = 1;
    const auto frame = [&](std::size_t count) {
      for (const gl::Pass pass : {gl::Pass::kDepth, gl::Pass::kColor}) {
        for (const gl::Shading shading :
             {gl::Shading::kGradient, gl::Shading::kFaces, gl::Shading::kSmooth}) {
          view.quality.shading = shading;
          ASSERT_TRUE(renderer.draw(view, std::span(instances).first(count), pass));
        }
      }
    };
    for (std::uint32_t pending = 1; pending > 0;) {
      frame(4);
      const auto uploaded = renderer.upload(8192);
      ASSERT_TRUE(uploaded);
      pending = uploaded->pending;
    }
    for (std::size_t count = 0; count <= instances.size(); count += 6) frame(count);
    for (const gl::DebugView debug : {gl::DebugView::kParts, gl::DebugView::kSplines}) {
      view.debug = debug;
      frame(4);
    }
    view.debug = gl::DebugView::kNone;
    view.quality.depth_batches = 3;
    frame(4);
    renderer.remove(*ball_.asset);
    EXPECT_FALSE(renderer.draw(view, instances));
    ASSERT_TRUE(renderer.add(*ball_.asset));
    ASSERT_TRUE(renderer.upload(~std::uint64_t{0}));
    frame(instances.size());
  }

  std::vector<Message> messages_;  // outlives the context, which tells it
  std::optional<EglContext> context_;
  const LoadedAsset ball_{packOf(ballClump({24, 32, 20}, 12, 3))};
  const LoadedAsset clump_{packOf(ballClump({60, 80, 50}, 20, 2))};
  const LoadedAsset swept_{sweptPackOf(ballClump({24, 32, 20}, 12, 3), 5)};
  const LoadedAsset fog_{fogPack(fogOf({20, 24, 18}, puffs), 0.05f)};
};

TEST_P(DebugTest, AMistakeIsComplainedOf) {
  glEnable(0xdead);
  EXPECT_EQ(complaints().size(), 1u);
  EXPECT_EQ(glGetError(), GLenum{GL_INVALID_ENUM});
}

TEST_P(DebugTest, NothingIsComplainedOf) {
  for (const gl::State state : {gl::State::kRestore, gl::State::kLeave}) {
    for (const char* surface : {static_cast<const char*>(nullptr), kVoxelSurface}) live(surface, state);
  }
  for (const std::string& text : complaints()) ADD_FAILURE() << text;
  EXPECT_EQ(glGetError(), GLenum{GL_NO_ERROR});
}

// A capture of a frame shows every object of kelp by its name, and every call within a group.
TEST_P(DebugTest, ObjectsHaveLabels) {
  gl::RendererOptions config;
  config.getProcAddress = EglContext::getProcAddress;
  config.gpu_budget = kGpuBudget;
  const Canvas canvas({80, 60});
  // Objects of each kind that are there now, without their labels.
  const std::pair<GLenum, GLboolean (*)(GLuint)> kinds[] = {{GL_TEXTURE, glIsTexture},
                                                            {GL_PROGRAM, glIsProgram},
                                                            {GL_VERTEX_ARRAY, glIsVertexArray},
                                                            {GL_BUFFER, glIsBuffer},
                                                            {GL_FRAMEBUFFER, glIsFramebuffer}};
  const auto objects = [&] {
    std::vector<std::pair<GLenum, GLuint>> out;
    for (const auto& [kind, is] : kinds) {
      for (GLuint name = 1; name < 1024; ++name) {
        if (is(name)) out.push_back({kind, name});
      }
    }
    return out;
  };
  const auto of_the_host = objects();
  const auto created = gl::Renderer::create(config);
  ASSERT_TRUE(created);
  ASSERT_TRUE((*created)->add(*clump_.asset));
  ASSERT_TRUE((*created)->upload(~std::uint64_t{0}));
  const Instance instance{clump_.asset.get(), nullptr};
  const Instance all[] = {instance, {swept_.asset.get(), nullptr}, {fog_.asset.get(), nullptr}};
  for (const Instance& other : std::span(all).subspan(1)) ASSERT_TRUE((*created)->add(*other.asset));
  ASSERT_TRUE((*created)->upload(~std::uint64_t{0}));
  gl::View view = lookAt(canvas, {0.8f, 0.9f, 1.8f}, {0, 0.5f, 0});
  view.quality.depth_batches = 2;
  for (const gl::DebugView debug : {gl::DebugView::kNone, gl::DebugView::kParts, gl::DebugView::kBounds}) {
    view.debug = debug;
    for (const gl::Pass pass : {gl::Pass::kDepth, gl::Pass::kColor, gl::Pass::kFog})
      ASSERT_TRUE((*created)->draw(view, all, pass));
  }
  int textures = 0;
  std::set<std::string> programs, groups;
  for (const auto& object : objects()) {
    if (std::find(of_the_host.begin(), of_the_host.end(), object) != of_the_host.end()) continue;
    const auto& [kind, name] = object;
    GLchar label[64] = "";
    glGetObjectLabel(kind, name, sizeof label, nullptr, label);
    EXPECT_TRUE(std::string(label).starts_with("kelp"))
        << "object " << name << " of kind " << kind << " is labeled \"" << label << '"';
    textures += kind == GL_TEXTURE;
    if (kind == GL_PROGRAM) programs.insert(label);
  }
  EXPECT_GT(textures, 0);
  const std::set<std::string> names{"kelp solids sheared", "kelp solids swept",      "kelp fog sheared",
                                    "kelp debug solids",   "kelp debug fog sheared", "kelp debug lines"};
  EXPECT_EQ(programs, names);
  // Every pass and every program is a group.
  for (const Message& message : messages_) {
    if (message.type == GL_DEBUG_TYPE_PUSH_GROUP) groups.insert(message.text);
  }
  for (const char* pass : {"kelp create", "kelp add", "kelp upload", "kelp depth", "kelp color", "kelp fog",
                           "kelp depth batch", "kelp depth copy"})
    EXPECT_TRUE(groups.contains(pass)) << pass;
  for (const std::string& name : names) EXPECT_TRUE(groups.contains(name)) << name;
}

TEST_P(DebugTest, GroupsAreBalanced) {
  const auto depth = [] {
    GLint out = 0;
    glGetIntegerv(GL_DEBUG_GROUP_STACK_DEPTH, &out);
    return out;
  };
  const GLint before = depth();
  live(nullptr, gl::State::kRestore);
  EXPECT_EQ(depth(), before);
  long pushed = 0, popped = 0;
  for (const Message& message : messages_) {
    if (!message.text.starts_with("kelp")) continue;
    pushed += message.type == GL_DEBUG_TYPE_PUSH_GROUP;
    popped += message.type == GL_DEBUG_TYPE_POP_GROUP;
  }
  EXPECT_GT(pushed, 0);
  EXPECT_EQ(pushed, popped);
}

KELP_EVERY_GL_TESTS(DebugTest);

}  // namespace
}  // namespace kelp::test
