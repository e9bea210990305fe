// SPDX-License-Identifier: MIT
// A renderer by C draws, to the last bit, what one by C++ draws.
#include <algorithm>
#include <thread>

#include "../gl/canvas.h"
#include "both.h"
#include "support/distance_pack.h"

namespace kelp::test {
namespace {

constexpr glm::ivec2 kSize(96, 96);

// A body of a meter a voxel, with distances.
std::string bodyFile(const Scratch& scratch) {
  RawPack pack = distancePackOf(ballClump({24, 32, 20}, 12, 3));
  pack.parts[0].to_object = glm::mat4x3(1);
  return scratch.write("body.kelp", std::span<const std::byte>(bytesOf(pack))).string();
}

class CDraw : public GlTest {
 protected:
  void SetUp() override {
    GlTest::SetUp();
    if (!IsSkipped()) canvas_.emplace(kSize);
  }
  kelp_renderer make(kelp_features features = 0) {
    auto config = sized<kelp_renderer_options>();
    EXPECT_KELP(KELP_OK, kelp_renderer_options_defaults(&config));
    EXPECT_EQ(gl::RendererOptions{}.gpu_budget, config.gpu_budget);
    config.gpu_budget = 1 << 20;
    config.get_proc_address = EglContext::getProcAddress;
    config.log = [](void*, const char* text) { ADD_FAILURE() << text; };
    config.features = features;
    kelp_renderer out = {};
    EXPECT_KELP(KELP_OK, kelp_renderer_create(&config, &out));
    return out;
  }
  static std::unique_ptr<gl::Renderer> makeCpp(const BothAssets& assets,
                                               gl::Features features = gl::Features::kNone) {
    gl::RendererOptions config;
    config.getProcAddress = EglContext::getProcAddress;
    config.gpu_budget = 1 << 20;
    config.features = features;
    auto out = std::move(gl::Renderer::create(config)).value();
    out->add(*assets.cpp).value();
    EXPECT_EQ(0u, out->upload(1 << 20).value().pending);
    return out;
  }
  static gl::View look() { return lookAt(kSize, {44, 30, 60}, {20, 14, 6}, 1, 200); }
  // Draws and reads; what a picture holds besides the background.
  template <class Draw>
  std::vector<Pixel> picture(const Draw& draw) const {
    canvas_->clear();
    draw();
    return canvas_->pixels();
  }
  static long drawn(const std::vector<Pixel>& pixels) {
    return std::count_if(pixels.begin(), pixels.end(), [](const Pixel& pixel) { return pixel[3] != 0; });
  }

  std::optional<Canvas> canvas_;
};

TEST_P(CDraw, PixelsAreThoseOfCpp) {
  const Scratch scratch;
  const BothAssets assets(bodyFile(scratch));
  BothInstances instances(assets);
  const std::vector<kelp_material> red(2, {{1, 0, 0, 1}, {0, 0, 0}, 0, 1});
  const std::vector<Material> same_red(2, Material{{1, 0, 0, 1}});
  instances.c[1].palette = red.data();
  instances.c[1].palette_count = 2;
  instances.cpp[1].palette = same_red;
  instances.c[2].tint[0] = instances.cpp[2].tint.r = 0.2f;
  const kelp_renderer renderer = make(KELP_FEATURE_SECONDARY_RAYS | KELP_FEATURE_DISTANCES);
  ASSERT_KELP(kelp_renderer_add(renderer, assets.c));
  EXPECT_KELP(KELP_ERROR_MISUSE, kelp_renderer_add(renderer, assets.c));
  auto stats = sized<kelp_stats>();
  ASSERT_KELP(kelp_renderer_upload(renderer, 1 << 20, &stats));
  EXPECT_EQ(0u, stats.pending);
  EXPECT_GT(stats.bytes_uploaded, 0u);
  const auto cpp = makeCpp(assets, gl::Features::kSecondaryRays | gl::Features::kDistances);

  std::vector<std::vector<Pixel>> pictures;
  for (int kind = 0; kind < 10; ++kind) {
    gl::View view = look();
    view.quality.shading = static_cast<gl::Shading>(kind % 3);
    kelp_view c_view = viewOf(view);
    c_view.shading = kind % 3;
    if (kind == 3) {
      view.output = gl::Output::kDisplay, c_view.output = KELP_OUTPUT_DISPLAY;
      view.light.sun_direction = {-1, 1, 0}, c_view.sun_direction[0] = -1, c_view.sun_direction[1] = 1,
      c_view.sun_direction[2] = 0;
    }
    if (kind == 8) view.debug = gl::DebugView::kParts, c_view.debug = KELP_DEBUG_VIEW_PARTS;
    if (kind == 9) view.debug = gl::DebugView::kBounds, c_view.debug = KELP_DEBUG_VIEW_BOUNDS;
    if (kind == 4) view.quality.self_shadow = true, c_view.self_shadow = 1;
    if (kind == 5) {
      view.quality.occlusion_rays = c_view.occlusion_rays = 4;
      view.quality.occlusion_reach = c_view.occlusion_reach = 1;
    }
    if (kind == 6) view.quality.soft_shadows = c_view.soft_shadows = 5;
    if (kind == 7) {
      view.quality.occlusion = true, c_view.occlusion = 1;
      view.quality.finest_level = c_view.finest_level = 1;
      view.quality.depth_batches = c_view.depth_batches = 3;
      view.light.sun_color = {1, 0, 0}, c_view.sun_color[0] = 1,
      c_view.sun_color[1] = c_view.sun_color[2] = 0;
      view.light.sky_color = {0, 1, 0}, c_view.sky_color[0] = c_view.sky_color[2] = 0,
      c_view.sky_color[1] = 1;
      view.light.ground_color = {0, 0, 1}, c_view.ground_color[0] = c_view.ground_color[1] = 0,
      c_view.ground_color[2] = 1;
    }
    gl::Stats expected;
    const auto by_cpp = picture([&] { expected = cpp->draw(view, instances.cpp).value(); });
    const auto by_c = picture([&] {
      ASSERT_KELP(kelp_renderer_draw(renderer, &c_view, instances.c.data(), instances.kCount, KELP_PASS_COLOR,
                                     &stats));
    });
    EXPECT_TRUE(by_cpp == by_c) << kind;
    expectStats(expected, stats);
    EXPECT_GT(drawn(by_c), 200) << kind;
    for (const auto& other : pictures) EXPECT_FALSE(other == by_c) << kind << " changes nothing";
    pictures.push_back(by_c);
  }
  ASSERT_KELP(kelp_renderer_remove(renderer, assets.c));
  const kelp_view view = viewOf(look());
  EXPECT_KELP(KELP_ERROR_MISUSE, kelp_renderer_draw(renderer, &view, instances.c.data(), instances.kCount,
                                                    KELP_PASS_COLOR, nullptr));
  EXPECT_EQ(kelp_unit{KELP_UNIT_INSTANCE}, lastError().unit);
  ASSERT_KELP(kelp_renderer_destroy(renderer));
  EXPECT_KELP(KELP_ERROR_HANDLE, kelp_renderer_destroy(renderer));
}

TEST_P(CDraw, DepthFogAndReversedDepth) {
  const BothAssets assets(packFile("fog"), -1);
  BothInstances instances(assets);
  const kelp_renderer renderer = make();
  ASSERT_KELP(kelp_renderer_add(renderer, assets.c));
  ASSERT_KELP(kelp_renderer_upload(renderer, 1 << 20, nullptr));
  const auto cpp = makeCpp(assets);
  const gl::View view = look();
  const kelp_view c_view = viewOf(view);
  const auto fog_by_cpp = picture([&] { cpp->draw(view, instances.cpp, gl::Pass::kFog).value(); });
  const auto fog_by_c = picture([&] {
    ASSERT_KELP(
        kelp_renderer_draw(renderer, &c_view, instances.c.data(), instances.kCount, KELP_PASS_FOG, nullptr));
  });
  EXPECT_TRUE(fog_by_cpp == fog_by_c);
  EXPECT_GT(drawn(fog_by_c), 100);
  if (desktop()) {
    for (const bool reversed : {false, true}) {
      gl::View depth_view = view;
      kelp_view c_depth = c_view;
      depth_view.camera.reversed_depth = reversed;
      c_depth.reversed_depth = reversed;
      std::vector<float> depths[2];
      for (const bool by_c : {false, true}) {
        glClearDepth(reversed ? 0 : 1);
        canvas_->clear();
        if (by_c)
          ASSERT_KELP(kelp_renderer_draw(renderer, &c_depth, instances.c.data(), instances.kCount,
                                         KELP_PASS_DEPTH, nullptr));
        else
          cpp->draw(depth_view, instances.cpp, gl::Pass::kDepth).value();
        depths[by_c] = canvas_->depths();
        EXPECT_EQ(0, drawn(canvas_->pixels()));
      }
      EXPECT_TRUE(depths[0] == depths[1]);
      EXPECT_NE(std::count(depths[1].begin(), depths[1].end(), reversed ? 0.0f : 1.0f), 96 * 96);
    }
  }
  ASSERT_KELP(kelp_renderer_destroy(renderer));
}

// The inputs of a host's shader: kelpSurface, View::bind, motion vectors.
TEST_P(CDraw, ShadersOfTheHost) {
  const BothAssets assets(packFile("distance"));
  const BothInstances instances(assets);
  auto config = sized<kelp_renderer_options>();
  ASSERT_KELP(kelp_renderer_options_defaults(&config));
  config.get_proc_address = EglContext::getProcAddress;
  config.gpu_budget = 1 << 20;
  config.state = KELP_STATE_LEAVE;
  std::string log;
  config.user = &log;
  config.log = [](void* user, const char* text) { *static_cast<std::string*>(user) += text; };
  kelp_renderer renderer = {};
  config.surface_glsl = "vec4 kelpSurface(KelpSurface s) { return nothing; }\n";
  EXPECT_KELP(KELP_ERROR_GRAPHICS, kelp_renderer_create(&config, &renderer));
  EXPECT_NE(std::string::npos, log.find("nothing"));
  log.clear();
  config.surface_glsl =
      "uniform float mine;\nvec4 kelpSurface(KelpSurface s) {\n"
      "  return vec4(mine, fract(s.previous_clip.xy / s.previous_clip.w), 1.0); }\n";
  ASSERT_KELP(kelp_renderer_create(&config, &renderer));
  ASSERT_KELP(kelp_renderer_add(renderer, assets.c));
  ASSERT_KELP(kelp_renderer_upload(renderer, 1 << 20, nullptr));
  gl::View view = look();
  kelp_view c_view = viewOf(view);
  int bound = 0;
  c_view.bind_user = &bound;
  c_view.bind = [](void* user, std::uint32_t program) {
    ++*static_cast<int*>(user);
    glUniform1f(glGetUniformLocation(program, "mine"), 0.5f);
    // A list within a list: the outer one stays whole.
    auto answer = sized<kelp_distance_answer>();
    const float point[3] = {0, 0, 0};
    EXPECT_KELP(KELP_OK, kelp_distance(nullptr, 0, nullptr, point, &answer));
  };
  c_view.previous_world_to_clip = c_view.world_to_eye;
  auto stats = sized<kelp_stats>();
  const auto pixels = picture([&] {
    ASSERT_KELP(
        kelp_renderer_draw(renderer, &c_view, instances.c.data(), instances.kCount, KELP_PASS_COLOR, &stats));
  });
  EXPECT_EQ(2, bound) << "sheared and swept parts";
  const auto is_mine = [](const Pixel& pixel) { return pixel[0] == 127 || pixel[0] == 128; };
  EXPECT_EQ(drawn(pixels), std::count_if(pixels.begin(), pixels.end(), is_mine));
  EXPECT_GT(drawn(pixels), 100);
  kelp_instance by_matrix = instances.c[0], by_pose = instances.c[0];
  float before[16];
  std::memcpy(before, by_matrix.to_world, sizeof before);
  before[12] += 3;
  by_matrix.previous_to_world = before;
  by_pose.previous_pose = instances.c[1].pose;
  const auto draw_one = [&](const kelp_instance& one) {
    return picture(
        [&] { ASSERT_KELP(kelp_renderer_draw(renderer, &c_view, &one, 1, KELP_PASS_COLOR, nullptr)); });
  };
  const auto still = draw_one(instances.c[0]), moved = draw_one(by_matrix), bent = draw_one(by_pose);
  EXPECT_FALSE(still == moved);
  EXPECT_FALSE(still == bent);
  EXPECT_FALSE(moved == bent);
  EXPECT_EQ(drawn(still), drawn(moved));
  EXPECT_EQ(drawn(still), drawn(bent));
  ASSERT_KELP(kelp_renderer_destroy(renderer));
  EXPECT_EQ("", log);
}

TEST_P(CDraw, TraceGlslAndLevels) {
  const BothAssets assets(packFile("distance"));
  const BothInstances instances(assets);
  const kelp_renderer renderer = make();
  ASSERT_KELP(kelp_renderer_add(renderer, assets.c));
  ASSERT_KELP(kelp_renderer_upload(renderer, 1 << 20, nullptr));
  const auto cpp = makeCpp(assets);
  const char* const* strings = nullptr;
  std::uint32_t count = 0;
  ASSERT_KELP(kelp_renderer_get_trace_glsl(renderer, &strings, &count));
  ASSERT_EQ(cpp->traceGlsl().size(), count);
  for (std::uint32_t i = 0; i < count; ++i) EXPECT_STREQ(cpp->traceGlsl()[i], strings[i]);

  const std::string version = desktop() ? "#version 330 core\n" : "#version 300 es\nprecision highp float;\n";
  std::vector<const char*> fragment = {version.c_str()};
  fragment.insert(fragment.end(), strings, strings + count);
  fragment.push_back(
      "out vec4 color;\nvoid main() { color = vec4(kelpBlocked(vec3(0.0), vec3(1.0), 9.0)); }\n");
  const std::string vertex = version + "void main() { gl_Position = vec4(0.0); }\n";
  const char* const vertex_text = vertex.c_str();
  const GLuint program = glCreateProgram();
  for (const GLenum kind : {GL_VERTEX_SHADER, GL_FRAGMENT_SHADER}) {
    const GLuint shader = glCreateShader(kind);
    if (kind == GL_VERTEX_SHADER)
      glShaderSource(shader, 1, &vertex_text, nullptr);
    else
      glShaderSource(shader, static_cast<GLsizei>(fragment.size()), fragment.data(), nullptr);
    glCompileShader(shader);
    glAttachShader(program, shader);
    glDeleteShader(shader);
  }
  glLinkProgram(program);
  GLint linked = 0;
  glGetProgramiv(program, GL_LINK_STATUS, &linked);
  ASSERT_EQ(GL_TRUE, linked);
  gl::View view = look();
  view.quality.pixels_per_voxel = 6;
  const kelp_view c_view = viewOf(view);
  auto stats = sized<kelp_stats>();
  ASSERT_KELP(kelp_renderer_bind_trace(renderer, program, &c_view, instances.c.data(), instances.kCount,
                                       KELP_FIRST_HOST_UNIT, &stats));
  expectStats(cpp->bindTrace(program, view, instances.cpp).value(), stats);
  EXPECT_KELP(KELP_ERROR_MISUSE, kelp_renderer_bind_trace(renderer, program, &c_view, instances.c.data(),
                                                          instances.kCount, 100000, &stats));
  glDeleteProgram(program);

  for (const auto features : {gl::Features::kNone, gl::Features::kDistances}) {
    std::uint64_t bytes = 0;
    ASSERT_KELP(kelp_pool_bytes(assets.c, static_cast<kelp_features>(features), &bytes));
    EXPECT_EQ(gl::poolBytes(*assets.cpp, features), bytes);
  }
  bool levels[3] = {};
  for (int i = 0; i < 400; ++i) {
    const glm::ivec2 pixel(i % 20, i / 20);
    std::int32_t level = -9;
    ASSERT_KELP(kelp_level_at(&c_view, &instances.c[1], 0, pixel.x, pixel.y, &level));
    ASSERT_EQ(gl::levelAt(view, instances.cpp[1], 0, pixel).value_or(KELP_NONE), level);
    levels[level + 1] = true;
  }
  EXPECT_TRUE(levels[1] || levels[2]);
  ASSERT_KELP(kelp_renderer_destroy(renderer));
}

TEST_P(CDraw, AnInstanceThatCannotBeDrawnIsLeftOut) {
  const BothAssets assets(packFile("distance"));
  BothInstances instances(assets);
  auto config = sized<kelp_renderer_options>();
  ASSERT_KELP(kelp_renderer_options_defaults(&config));
  config.get_proc_address = EglContext::getProcAddress;
  kelp_renderer renderer = {};
  ASSERT_KELP(kelp_renderer_create(&config, &renderer));
  ASSERT_KELP(kelp_renderer_add(renderer, assets.c));
  ASSERT_KELP(kelp_renderer_upload(renderer, 1 << 20, nullptr));
  instances.c[1].to_world[5] = std::numeric_limits<float>::quiet_NaN();
  const kelp_view view = viewOf(look());
  auto stats = sized<kelp_stats>();
  ASSERT_KELP(
      kelp_renderer_draw(renderer, &view, instances.c.data(), instances.kCount, KELP_PASS_COLOR, &stats));
  EXPECT_EQ(1u, stats.left_out);
  EXPECT_EQ(1u, stats.first_left_out);
  EXPECT_EQ(kelp_result{KELP_ERROR_MISUSE}, stats.first_left_out_result);
  EXPECT_STRNE("", stats.first_left_out_text);
  ASSERT_KELP(kelp_renderer_destroy(renderer));
}

TEST_P(CDraw, MistakesAreErrors) {
  const BothAssets assets(packFile("distance"));
  const BothInstances instances(assets);
  const kelp_renderer renderer = make(KELP_FEATURE_GRADIENT_ONLY);
  ASSERT_KELP(kelp_renderer_add(renderer, assets.c));
  ASSERT_KELP(kelp_renderer_upload(renderer, 1 << 20, nullptr));
  kelp_view view = viewOf(look());
  const auto draw = [&](kelp_pass pass = KELP_PASS_COLOR) {
    return kelp_renderer_draw(renderer, &view, instances.c.data(), instances.kCount, pass, nullptr);
  };
  EXPECT_KELP(KELP_ERROR_MISUSE, draw(3));
  EXPECT_KELP(KELP_ERROR_MISUSE, draw(-1));
  view.shading = KELP_SHADING_SMOOTH;
  EXPECT_KELP(KELP_ERROR_MISUSE, draw()) << "it is left out";
  view.shading = KELP_SHADING_GRADIENT;
  for (std::int32_t kelp_view::*const field :
       {&kelp_view::shading, &kelp_view::output, &kelp_view::clip_range, &kelp_view::depth_batches,
        &kelp_view::debug}) {
    for (const std::int32_t bad : {-1, 77, 255, 256, 512}) {
      const std::int32_t good = std::exchange(view.*field, bad);
      EXPECT_KELP(KELP_ERROR_MISUSE, draw()) << bad;
      view.*field = good;
    }
  }
  view.struct_size = 8;
  EXPECT_KELP(KELP_ERROR_STRUCT_SIZE, draw());
  view.struct_size = sizeof view;
  auto stats = sized<kelp_stats>();
  stats.struct_size = 5;
  EXPECT_KELP(KELP_ERROR_STRUCT_SIZE, kelp_renderer_upload(renderer, 0, &stats));
  EXPECT_KELP(KELP_ERROR_NULL, kelp_renderer_draw(renderer, nullptr, nullptr, 0, KELP_PASS_COLOR, nullptr));
  EXPECT_KELP(KELP_ERROR_NULL, kelp_renderer_draw(renderer, &view, nullptr, 1, KELP_PASS_COLOR, nullptr));
  EXPECT_KELP(KELP_OK, draw());
  EXPECT_KELP(KELP_ERROR_HANDLE, kelp_renderer_add(renderer, {0}));

  // Its thread alone, until another one takes it.
  const auto everything = [&] {
    const char* const* strings = nullptr;
    std::uint32_t count = 0;
    return std::vector<kelp_result>{
        kelp_renderer_add(renderer, assets.c),
        kelp_renderer_remove(renderer, assets.c),
        kelp_renderer_upload(renderer, 0, nullptr),
        draw(),
        kelp_renderer_get_trace_glsl(renderer, &strings, &count),
        kelp_renderer_bind_trace(renderer, 1, &view, nullptr, 0, KELP_FIRST_HOST_UNIT, nullptr),
        kelp_renderer_abandon(renderer),
        kelp_renderer_destroy(renderer)};
  };
  std::thread([&] {
    for (const kelp_result result : everything()) EXPECT_EQ(kelp_result{KELP_ERROR_WRONG_THREAD}, result);
    EXPECT_KELP(KELP_OK, kelp_renderer_use_here(renderer));
    EXPECT_KELP(KELP_OK, kelp_renderer_abandon(renderer));
  }).join();
  for (const kelp_result result : everything()) EXPECT_EQ(kelp_result{KELP_ERROR_WRONG_THREAD}, result);
  EXPECT_KELP(KELP_OK, kelp_renderer_use_here(renderer));
  EXPECT_KELP(KELP_ERROR_MISUSE, draw()) << "it was abandoned";
  EXPECT_KELP(KELP_OK, kelp_renderer_destroy(renderer));
}

KELP_GL_TESTS(CDraw);

}  // namespace
}  // namespace kelp::test
