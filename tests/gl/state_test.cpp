// SPDX-License-Identifier: MIT
// kelp leaves the GL state as it finds it, or touches what runtime/HOST_GUIDE.md lists and no more; it draws
// the same picture whatever it finds; and what the host has under way (queries, transform feedback,
// conditional rendering) goes on.
#include <cstdio>
#include <functional>
#include <set>

#include "awkward_state.h"
#include "depth_canvas.h"
#include "support/fog_pack.h"

namespace kelp::test {
namespace {

using runtime::Instance;

// The calls of the public interface, as README.md groups them.
enum Call : unsigned {
  kCreate = 1,
  kAdd = 2,
  kUpload = 4,
  kDraw = 8,
  kDrawDepth = 16,
  kRemove = 32,
  kDestroy = 64,
  kDrawFog = 128,
  kDrawDebug = 256
};

class StateTest : public GlTest {
 protected:
  using After = std::function<void(Call call, const std::string& name)>;

  // Every call there is, `after` each of them. The last color picture drawn is that of `view`.
  void callEverything(gl::State state, const gl::View& view, const After& after) const {
    gl::RendererOptions config;
    config.getProcAddress = EglContext::getProcAddress;
    config.gpu_budget = kGpuBudget;
    config.surface_glsl = "vec4 kelpSurface(KelpSurface s) { return nonsense; }\n";
    config.state = state;
    EXPECT_FALSE(gl::Renderer::create(config));
    after(kCreate, "create, refused");
    config.surface_glsl = kVoxelSurface;
    {
      const auto created = gl::Renderer::create(config);
      ASSERT_TRUE(created);
      gl::Renderer& renderer = **created;
      after(kCreate, "create");
      EXPECT_TRUE(renderer.add(*loaded_.asset));
      after(kAdd, "add");
      EXPECT_FALSE(renderer.add(*loaded_.asset));
      after(kAdd, "add, refused");
      for (std::uint32_t pending = 1; pending > 0;) {
        const auto uploaded = renderer.upload(8192);
        ASSERT_TRUE(uploaded);
        pending = uploaded->pending;
        after(kUpload, "upload");
      }
      EXPECT_TRUE(renderer.add(*fog_.asset));
      after(kAdd, "add, fog");
      for (std::uint32_t pending = 1; pending > 0;) {
        const auto uploaded = renderer.upload(~std::uint64_t{0});
        ASSERT_TRUE(uploaded);
        pending = uploaded->pending;
      }
      after(kUpload, "upload, fog");
      EXPECT_TRUE(renderer.draw(view, {&instance_, 1}));
      after(kDraw, "draw, first");
      for (const bool shadow : {false, true}) {
        gl::View foggy = view;
        foggy.quality.self_shadow = shadow;
        const Instance instance{fog_.asset.get(), nullptr};
        EXPECT_TRUE(renderer.draw(foggy, {&instance, 1}, gl::Pass::kFog));
        after(kDrawFog, "draw, fog");
      }
      const std::vector<Instance> many(100, instance_);  // more room for records than one asks for
      EXPECT_TRUE(renderer.draw(view, many, gl::Pass::kDepth));
      after(kDrawDepth, "draw, many, depth");
      for (const gl::Shading shading : {gl::Shading::kFaces, gl::Shading::kSmooth, gl::Shading::kGradient}) {
        gl::View shaded = view;
        shaded.quality.shading = shading;
        EXPECT_TRUE(renderer.draw(shaded, {&instance_, 1}));
        after(kDraw, "draw");
      }
      gl::View batched = view;
      batched.quality.depth_batches = 3;
      EXPECT_TRUE(renderer.draw(batched, std::vector<Instance>(3, instance_)));
      after(kDraw, "draw, in batches");
      EXPECT_TRUE(renderer.draw(view, {}));
      after(kDraw, "draw, nothing");
      for (const gl::DebugView debug : {gl::DebugView::kParts, gl::DebugView::kSplines}) {
        if (!explains_) break;
        gl::View explained = view;
        explained.debug = debug;
        EXPECT_TRUE(renderer.draw(explained, {&instance_, 1}));
        after(kDrawDebug, "draw, debug");
      }
      gl::View wrong;
      wrong.camera.viewport.x = -1;
      EXPECT_FALSE(renderer.draw(wrong, {&instance_, 1}));
      after(kDraw, "draw, refused");
      renderer.remove(*loaded_.asset);
      after(kRemove, "remove");
      EXPECT_TRUE(renderer.add(*loaded_.asset));
    }
    after(kDestroy, "destroy");
  }

  std::vector<Pixel> expectedPicture(const Canvas& canvas, const gl::View& view) {
    const auto plain = makeRenderer(*loaded_.asset, kVoxelSurface);
    EXPECT_TRUE(plain->draw(view, {&instance_, 1}));
    const std::vector<Pixel> picture = canvas.pixels();
    canvas.clear();
    return picture;
  }

  static gl::View viewOf(const Canvas& canvas) { return lookAt(canvas, {0.8f, 0.9f, 1.8f}, {0, 0.5f, 0}); }

  bool explains_ = true;  // whether callEverything() draws debug views too

  void expectRestored(const gl::View& view) const {
    const GlState before = readGlState();
    callEverything(gl::State::kRestore, view, [&](Call, const std::string& name) {
      EXPECT_EQ(glGetError(), GLenum{GL_NO_ERROR}) << name;
      for (const std::string& line : differences(before, readGlState()))
        ADD_FAILURE() << "after " << name << ": " << line;
    });
  }

  const LoadedAsset loaded_{packOf(ballClump({60, 80, 50}, 20, 2))};
  // Too thin to be seen: the picture is that of the solid.
  const LoadedAsset fog_{fogPack(fogOf({20, 24, 18}, puffs, puffs), 1e-9f)};
  const Instance instance_{loaded_.asset.get(), nullptr};
};

// The tests below rest on this: no compared value could be right because it is the initial one.
TEST_P(StateTest, TheAwkwardStateDiffersFromTheInitialOneInEveryValue) {
  const GlState initial = readGlState();
  setAwkwardState(Awkward::kEverything);
  std::size_t values = 0, set = 0;
  std::map<std::string, int> excused;
  for (const auto& [name, now] : readGlState()) {
    const auto found = initial.find(name);
    for (std::size_t i = 0; i < now.size(); ++i) {
      ++values;
      if (found == initial.end() || found->second[i] != now[i]) {
        ++set;
      } else if (const char* why = whyInitial(name)) {
        ++excused[why];
      } else {
        ADD_FAILURE() << name << ", value " << i << ", is " << now[i] << " as at the start";
      }
    }
  }
  std::printf("%s: %zu entries, %zu values, of which %zu differ from the initial ones\n",
              glGetString(GL_VERSION), initial.size(), values, set);
  for (const auto& [why, count] : excused) std::printf("  %d are initial: %s\n", count, why.c_str());
  EXPECT_GT(set, 1000u);
}

TEST_P(StateTest, IsLeftAsFoundWhenEverythingIsSet) {
  const Canvas canvas({80, 60});
  setAwkwardState(Awkward::kEverything);
  expectRestored(viewOf(canvas));
}

TEST_P(StateTest, IsLeftAsFoundWhenNothingIsSet) {
  const Canvas canvas({80, 60});
  expectRestored(viewOf(canvas));
}

TEST_P(StateTest, IsLeftAsFoundAndDoesNotChangeThePicture) {
  explains_ = false;
  const Canvas canvas({80, 60});
  const gl::View view = viewOf(canvas);
  const std::vector<Pixel> expected = expectedPicture(canvas, view);
  setAwkwardState(Awkward::kDrawable);
  expectRestored(view);
  setReadable();
  EXPECT_EQ(canvas.pixels(), expected);
}

TEST_P(StateTest, KLeaveDrawsTheSamePicture) {
  explains_ = false;
  const Canvas canvas({80, 60});
  const gl::View view = viewOf(canvas);
  const std::vector<Pixel> expected = expectedPicture(canvas, view);
  setAwkwardState(Awkward::kDrawable);
  std::vector<Pixel> drawn;
  callEverything(gl::State::kLeave, view, [&](Call call, const std::string& name) {
    // The depth pass leaves the color mask off, as it may; the rest is drawn on a canvas with the depth that
    // is there.
    if (call == kDrawDepth) glColorMask(GL_TRUE, GL_TRUE, GL_TRUE, GL_TRUE);
    EXPECT_EQ(glGetError(), GLenum{GL_NO_ERROR}) << name;
  });
  setReadable();
  EXPECT_EQ(canvas.pixels(), expected);
}

// There is nothing to invalidate: the host may change all of the state between two draws of a renderer, and
// its own names too.
TEST_P(StateTest, NothingIsRememberedFromDrawToDraw) {
  for (const gl::State state : {gl::State::kRestore, gl::State::kLeave}) {
    context_.reset();
    context_.emplace(GetParam());
    const Canvas canvas({80, 60});
    const gl::View view = viewOf(canvas);
    gl::RendererOptions config;
    config.state = state;
    const auto renderer = makeRenderer(*loaded_.asset, kVoxelSurface, config);
    ASSERT_TRUE(renderer->draw(view, {&instance_, 1}));
    const std::vector<Pixel> expected = canvas.pixels();
    canvas.clear();
    setAwkwardState(Awkward::kDrawable);
    ASSERT_TRUE(renderer->draw(view, {&instance_, 1}));
    setReadable();
    EXPECT_EQ(canvas.pixels(), expected);
  }
}

// The table "What is touched" of runtime/HOST_GUIDE.md. A name that ends in a star stands for all that begin
// so; "unit A" is the active one.
struct Touched {
  unsigned calls;
  const char* entry;
  double left = -1;   // the value that is left behind; -1: a name of kelp's own, or a unit
  int since_es = 30;  // 0: OpenGL only
  int since_gl = 33;
};
constexpr unsigned kUploading = kCreate | kAdd | kUpload | kDraw | kDrawDepth | kDrawFog | kDrawDebug;
constexpr unsigned kDrawing = kDraw | kDrawDepth | kDrawFog | kDrawDebug;
constexpr Touched kTouched[] = {
    {kUploading, "GL_PIXEL_UNPACK_BUFFER_BINDING", 0},
    {kUploading, "GL_UNPACK_ALIGNMENT", 1},
    {kUploading, "GL_UNPACK_ROW_LENGTH", 0},
    {kUploading, "GL_UNPACK_IMAGE_HEIGHT", 0},
    {kUploading, "GL_UNPACK_SKIP_ROWS", 0},
    {kUploading, "GL_UNPACK_SKIP_PIXELS", 0},
    {kUploading, "GL_UNPACK_SKIP_IMAGES", 0},
    {kUploading, "GL_UNPACK_SWAP_BYTES", 0, 0},
    {kUploading, "GL_UNPACK_LSB_FIRST", 0, 0},
    {kUploading, "GL_TEXTURE_2D of unit A"},
    {kUploading, "GL_TEXTURE_2D_ARRAY of unit A"},
    {kCreate | kAdd | kDrawing, "GL_CURRENT_PROGRAM"},
    {kCreate | kDrawing, "GL_VERTEX_ARRAY_BINDING"},
    {kDrawing, "GL_ACTIVE_TEXTURE"},
    {kDrawing, "GL_TEXTURE_2D_ARRAY of unit 0"},
    {kDrawing, "GL_TEXTURE_2D of unit 1"},
    {kDrawing, "GL_TEXTURE_2D of unit 2", 0},
    {kCreate | kDrawing, "GL_SAMPLER_BINDING of unit 0"},
    {kDrawing, "GL_SAMPLER_BINDING of unit 1"},
    {kDrawing, "GL_SAMPLER_BINDING of unit 2"},
    {kDrawing, "GL_DEPTH_TEST", 1},
    {kDrawing, "GL_DEPTH_FUNC", GL_LEQUAL},
    {kDraw | kDrawDepth | kDrawDebug, "GL_DEPTH_WRITEMASK", 1},
    {kDrawFog, "GL_DEPTH_WRITEMASK", 0},
    {kDrawing, "GL_CULL_FACE", 0},
    {kDrawing, "GL_BLEND", 0},
    {kDrawing, "GL_BLEND *", 0, 32},  // of each draw buffer
    {kDrawFog, "GL_BLEND_SRC_RGB", GL_ONE},
    {kDrawFog, "GL_BLEND_SRC_RGB 0", GL_ONE, 32, 40},
    {kDrawFog, "GL_BLEND_SRC_ALPHA", GL_ONE},
    {kDrawFog, "GL_BLEND_SRC_ALPHA 0", GL_ONE, 32, 40},
    {kDrawFog, "GL_BLEND_DST_RGB", GL_ONE_MINUS_SRC_ALPHA},
    {kDrawFog, "GL_BLEND_DST_RGB 0", GL_ONE_MINUS_SRC_ALPHA, 32, 40},
    {kDrawFog, "GL_BLEND_DST_ALPHA", GL_ONE_MINUS_SRC_ALPHA},
    {kDrawFog, "GL_BLEND_DST_ALPHA 0", GL_ONE_MINUS_SRC_ALPHA, 32, 40},
    {kDrawFog, "GL_BLEND_EQUATION_RGB", GL_FUNC_ADD},
    {kDrawFog, "GL_BLEND_EQUATION_RGB 0", GL_FUNC_ADD, 32, 40},
    {kDrawFog, "GL_BLEND_EQUATION_ALPHA", GL_FUNC_ADD},
    {kDrawFog, "GL_BLEND_EQUATION_ALPHA 0", GL_FUNC_ADD, 32, 40},
    {kDrawFog | kDrawDebug, "GL_COLOR_WRITEMASK *", 0, 32},  // of the other draw buffers
    {kDrawing, "GL_POLYGON_MODE", GL_FILL, 0},
    {kDrawDepth, "GL_COLOR_WRITEMASK", 0},
    {kDrawDepth, "GL_COLOR_WRITEMASK *", 0, 32},
    // Objects that were bound when they were deleted.
    {kDestroy, "GL_TEXTURE_2D of unit *", 0},
    {kDestroy, "GL_TEXTURE_2D_ARRAY of unit *", 0},
    {kDestroy, "GL_SAMPLER_BINDING of unit *", 0},
    {kDestroy, "GL_VERTEX_ARRAY_BINDING", 0},
};

// The binding that an entry is seen through: with another object bound, it tells of that object.
std::string seenThrough(const std::string& entry) {
  for (const char* of : {"sampling of ", "parameters of ", "image of "}) {
    if (entry.starts_with(of)) return entry.substr(std::string(of).size());
  }
  if (entry.starts_with("sampler's parameters"))
    return "GL_SAMPLER_BINDING" + entry.substr(entry.find(" of unit"));
  if (entry.starts_with("uniform ")) return "GL_CURRENT_PROGRAM";
  if (entry.starts_with("GL_VERTEX_ATTRIB_") || entry.starts_with("GL_VERTEX_BINDING_") ||
      entry == "GL_ELEMENT_ARRAY_BUFFER_BINDING")
    return "GL_VERTEX_ARRAY_BINDING";
  return {};
}

std::vector<double> valueOf(const GlState& state, const std::string& name) {
  const auto found = state.find(name);
  return found == state.end() ? std::vector<double>{} : found->second;
}

TEST_P(StateTest, KLeaveTouchesWhatIsDocumentedAndNothingElse) {
  const Canvas canvas({80, 60});
  const gl::View view = viewOf(canvas);
  std::set<const Touched*> seen;
  // From a state where the depth test is on, and one where it is off and the draw buffers differ.
  for (const Awkward how : {Awkward::kDrawable, Awkward::kEverything}) {
    if (how == Awkward::kEverything) {
      context_.reset();
      context_.emplace(GetParam());
    }
    setAwkwardState(how);
    GlState before = readGlState();
    const GlState first = before;
    // True if an entry names an object that is not the host's.
    const auto isKelps = [&](const std::string& name, const GlState& now) {
      const std::string through = seenThrough(name);
      return !through.empty() && valueOf(now, through) != valueOf(first, through);
    };
    callEverything(gl::State::kLeave, view, [&](Call call, const std::string& call_name) {
      const GlState after = readGlState();
      const std::string active =
          " of unit " + std::to_string(static_cast<int>(before.at("GL_ACTIVE_TEXTURE")[0]) - GL_TEXTURE0);
      for (const auto& [name, values] : after) {
        if (valueOf(before, name) == values || isKelps(name, after)) continue;
        const Touched* by = nullptr;
        for (const Touched& touched : kTouched) {
          std::string entry = touched.entry;
          if (entry.ends_with(" of unit A")) entry = entry.substr(0, entry.size() - 10) + active;
          const bool same =
              entry.ends_with("*") ? name.starts_with(entry.substr(0, entry.size() - 1)) : name == entry;
          if (!same || !(touched.calls & call)) continue;
          seen.insert(&touched);
          by = &touched;
          for (const double value : values)
            EXPECT_TRUE(touched.left < 0 || value == touched.left)
                << name << " is " << value << " after " << call_name;
        }
        EXPECT_TRUE(by) << name << " is touched by " << call_name << ", and not documented";
      }
      for (const auto& [name, values] : before) {
        EXPECT_TRUE(after.contains(name) || isKelps(name, after)) << name << " is gone after " << call_name;
      }
      before = after;
    });
  }
  const GlLimits limits = GlLimits::read();
  for (const Touched& touched : kTouched) {
    if (!limits.has(touched.since_gl, touched.since_es)) continue;
    EXPECT_TRUE(seen.contains(&touched)) << touched.entry << " is documented, and never touched";
  }
}

// bindTrace() leaves bound what the host's program reads, and nothing else changes.
TEST_P(StateTest, BindTraceTouchesItsUnitsAlone) {
  const Canvas canvas({80, 60});
  const gl::View view = viewOf(canvas);
  const auto renderer = makeRenderer(*loaded_.asset);
  std::string text;
  for (const char* string : renderer->traceGlsl()) text += string;
  const GLuint program = makeProgram(GetParam(), "void main() { gl_Position = vec4(0.0); }\n",
                                     text +
                                         "layout(location = 0) out vec4 color;\nvoid main() { color = "
                                         "vec4(kelpTrace(vec3(0.0), vec3(1.0), 1.0).t); }\n");
  ASSERT_NE(program, 0u);
  setAwkwardState(Awkward::kEverything);
  const GlState before = readGlState();
  ASSERT_TRUE(renderer->bindTrace(program, view, {&instance_, 1}, 5));
  EXPECT_EQ(glGetError(), GLenum{GL_NO_ERROR});
  int changed = 0;
  const GlState after = readGlState();
  EXPECT_EQ(before.size(), after.size());
  for (const auto& [name, values] : after) {
    if (valueOf(before, name) == values) continue;
    ++changed;
    EXPECT_TRUE(name.ends_with(" of unit 5") || name.ends_with(" of unit 6")) << name;
  }
  EXPECT_GE(changed, 4);
}

TEST_P(StateTest, TheHostsOwnErrorIsNotTakenForKelps) {
  const Canvas canvas({80, 60});
  const auto renderer = makeRenderer(*loaded_.asset);
  glEnable(0xdead);
  renderer->remove(*loaded_.asset);
  EXPECT_TRUE(renderer->add(*loaded_.asset));
  glEnable(0xdead);
  EXPECT_TRUE(renderer->upload(~std::uint64_t{0}));
  glEnable(0xdead);
  gl::RendererOptions config;
  config.getProcAddress = EglContext::getProcAddress;
  config.gpu_budget = kGpuBudget;
  EXPECT_TRUE(gl::Renderer::create(config));
}

TEST_P(StateTest, AnErrorThatWasPendingIsStillThereAfterADraw) {
  const Canvas canvas({80, 60});
  const auto renderer = makeRenderer(*loaded_.asset);
  ASSERT_TRUE(renderer->draw(viewOf(canvas), {&instance_, 1}));  // from now on there is room for the records
  glEnable(0xdead);
  EXPECT_TRUE(renderer->draw(viewOf(canvas), {&instance_, 1}));
  EXPECT_EQ(glGetError(), GLenum{GL_INVALID_ENUM});
  EXPECT_EQ(glGetError(), GLenum{GL_NO_ERROR});
}

TEST_P(StateTest, AQueryOfTheHostsCountsWhatKelpDraws) {
  const Canvas canvas({80, 60});
  const auto renderer = makeRenderer(*loaded_.asset, kVoxelSurface);
  const GLenum what = desktop() ? GL_SAMPLES_PASSED : GL_ANY_SAMPLES_PASSED;
  GLuint query = 0, passed = 0;
  glGenQueries(1, &query);
  glBeginQuery(what, query);
  ASSERT_TRUE(renderer->draw(viewOf(canvas), {&instance_, 1}));
  glEndQuery(what);
  glGetQueryObjectuiv(query, GL_QUERY_RESULT, &passed);
  GLuint covered = 0;
  for (const Pixel& pixel : canvas.pixels()) covered += pixel != Pixel{};
  ASSERT_GT(covered, 300u);
  EXPECT_GE(passed, desktop() ? covered : 1);
  EXPECT_EQ(glGetError(), GLenum{GL_NO_ERROR});
}

TEST_P(StateTest, ATransformFeedbackThatIsPausedGoesOn) {
  if (!GlLimits::read().has(40, 30)) GTEST_SKIP() << "this context cannot pause one";
  const Canvas canvas({80, 60});
  const auto renderer = makeRenderer(*loaded_.asset, kVoxelSurface);
  GLuint names[3], written = 0;
  glGenVertexArrays(1, &names[0]);
  glBindVertexArray(names[0]);
  glGenQueries(1, &names[1]);
  glGenBuffers(1, &names[2]);
  glBindBufferBase(GL_TRANSFORM_FEEDBACK_BUFFER, 0, names[2]);
  glBufferData(GL_TRANSFORM_FEEDBACK_BUFFER, 1024, nullptr, GL_STREAM_READ);
  glUseProgram(makeHostProgram());
  glBeginQuery(GL_TRANSFORM_FEEDBACK_PRIMITIVES_WRITTEN, names[1]);
  glBeginTransformFeedback(GL_POINTS);
  glDrawArrays(GL_POINTS, 0, 3);
  glPauseTransformFeedback();
  EXPECT_TRUE(renderer->draw(viewOf(canvas), {&instance_, 1}));
  glResumeTransformFeedback();
  glDrawArrays(GL_POINTS, 0, 4);
  glEndTransformFeedback();
  glEndQuery(GL_TRANSFORM_FEEDBACK_PRIMITIVES_WRITTEN);
  glGetQueryObjectuiv(names[1], GL_QUERY_RESULT, &written);
  EXPECT_EQ(written, 7u);
  EXPECT_EQ(glGetError(), GLenum{GL_NO_ERROR});
}

// Draws are left out where the host wants them left out; what is uploaded meanwhile is there.
TEST_P(StateTest, ConditionalRenderingIsObeyed) {
  if (!desktop()) return;  // OpenGL ES has none
  const Canvas canvas({80, 60});
  const gl::View view = viewOf(canvas);
  const std::vector<Pixel> expected = expectedPicture(canvas, view);
  gl::RendererOptions config;
  config.getProcAddress = EglContext::getProcAddress;
  config.gpu_budget = kGpuBudget;
  config.surface_glsl = kVoxelSurface;
  GLuint query = 0;
  glGenQueries(1, &query);
  glBeginQuery(GL_SAMPLES_PASSED, query);
  glEndQuery(GL_SAMPLES_PASSED);
  glBeginConditionalRender(query, GL_QUERY_WAIT);
  const auto created = gl::Renderer::create(config);
  ASSERT_TRUE(created);
  EXPECT_TRUE((*created)->add(*loaded_.asset));
  EXPECT_TRUE((*created)->upload(~std::uint64_t{0}));
  EXPECT_TRUE((*created)->draw(view, {&instance_, 1}));
  glEndConditionalRender();
  for (const Pixel& pixel : canvas.pixels()) ASSERT_EQ(pixel, Pixel{});
  EXPECT_TRUE((*created)->draw(view, {&instance_, 1}));
  EXPECT_EQ(canvas.pixels(), expected);
  EXPECT_EQ(glGetError(), GLenum{GL_NO_ERROR});
}

KELP_EVERY_GL_TESTS(StateTest);

}  // namespace
}  // namespace kelp::test
