// SPDX-License-Identifier: MIT
// Rays of the host's own shaders (Renderer::traceGlsl, bindTrace) against the renderer's picture and against
// runtime::raycast.
#include <bit>
#include <cmath>

#include <glm/gtc/matrix_transform.hpp>

#include "depth_canvas.h"
#include "support/voxel_points.h"
#include "swept_pack.h"

namespace kelp::test {
namespace {

using runtime::Instance;

constexpr char kScreen[] =
    "void main() { gl_Position = vec4(gl_VertexID == 1 ? 3.0 : -1.0, gl_VertexID == 2 ? 3.0 : -1.0, 0.0, "
    "1.0); }\n";

class HostTraceTest : public GlTest {
 protected:
  // A program of the host's whose fragment shader, or vertex shader, has kelp's text before its own.
  static GLuint makeTracer(GlApi api, const gl::Renderer& renderer, const std::string& vertex,
                           const std::string& fragment, bool in_vertex = false) {
    std::string text;
    for (const char* string : renderer.traceGlsl()) text += string;
    return makeProgram(api, in_vertex ? text + vertex : vertex, in_vertex ? fragment : text + fragment);
  }
  void drawScreen(GLuint program) const {
    glUseProgram(program);
    glBindVertexArray(vertices_);
    glDisable(GL_DEPTH_TEST);
    glDrawArrays(GL_TRIANGLES, 0, 3);
    glUseProgram(0);
    EXPECT_EQ(glGetError(), GLenum{GL_NO_ERROR});
  }
  void SetUp() override {
    GlTest::SetUp();
    if (IsSkipped()) return;
    glGenVertexArrays(1, &vertices_);
    instances_[0] = {loaded_.asset.get(), &pose_};
    instances_[1] = {swept_.asset.get(), nullptr};
    instances_[1].to_world =
        glm::scale(glm::rotate(glm::translate(glm::mat4(1), glm::vec3(0.7f, 0.1f, -0.6f)), 0.8f,
                               glm::vec3(0.2f, 1, 0.3f)),
                   glm::vec3(-1.3f, 0.9f, 1.1f));
    instances_[1].tint = {0.5f, 1, 0.7f, 1};
    instances_[2] = {loaded_.asset.get(), &pose_};
    instances_[2].to_world = glm::translate(glm::mat4(1), glm::vec3(-1.1f, 0, 0.3f));
    const std::vector<Knot> knots = figureKnots(kFigure6[1]);
    (void)pose_.setKnots(0, knots);
  }

  std::unique_ptr<gl::Renderer> makeBoth(const gl::RendererOptions& config = {}) {
    auto renderer = makeRenderer(*loaded_.asset, nullptr, config);
    EXPECT_TRUE(renderer->add(*swept_.asset));
    EXPECT_TRUE(renderer->upload(~std::uint64_t{0}));
    return renderer;
  }

  std::optional<runtime::Hit> nearest(const runtime::Ray& ray, int* which = nullptr) const {
    std::optional<runtime::Hit> best;
    for (int i = 0; i < 3; ++i) {
      const auto hit = raycast(instances_[i], ray);
      if (!hit || (best && hit->t >= best->t)) continue;
      best = hit;
      if (which) *which = i;
    }
    return best;
  }

  const LoadedAsset loaded_{packOf(ballClump({60, 80, 50}, 20, 2))};
  const LoadedAsset swept_{sweptPackOf(ballClump({60, 80, 50}, 20, 2), 5)};  // an S
  runtime::Pose pose_ = *runtime::Pose::create(*loaded_.asset);
  Instance instances_[3];
  GLuint vertices_ = 0;
};

// Primary rays traced by the host look as draw() draws: the same look, shadows and occlusion too.
TEST_P(HostTraceTest, PrimaryRaysGiveThePictureThatIsDrawn) {
  const Canvas canvas({160, 120});
  gl::RendererOptions config;
  config.features = gl::Features::kSecondaryRays;
  const auto renderer = makeBoth(config);
  const GLuint program =
      makeTracer(GetParam(), *renderer, kScreen,
                 "uniform mat4 to_world; uniform vec2 size;\n"
                 "layout(location = 0) out vec4 color;\n"
                 "void main() {\n"
                 "  vec2 at = 2.0 * gl_FragCoord.xy / size - 1.0;\n"
                 "  vec4 near = to_world * vec4(at, -1.0, 1.0), far = to_world * vec4(at, 1.0, 1.0);\n"
                 "  vec3 origin = near.xyz / near.w;\n"
                 "  KelpSceneHit hit = kelpTrace(origin, far.xyz / far.w - origin, 1.0);\n"
                 "  color = hit.found ? kelpSurface(hit.surface) : vec4(0.0);\n"
                 "}\n");
  ASSERT_NE(program, 0u);
  gl::View view = lookAt(canvas, {0.6f, 1.1f, 2.6f}, {0, 0.5f, 0}, 0.5f, 10.0f);
  view.quality.self_shadow = true;
  for (const gl::Shading shading : {gl::Shading::kGradient, gl::Shading::kFaces, gl::Shading::kSmooth}) {
    view.quality.shading = shading;
    canvas.clear();
    ASSERT_TRUE(renderer->draw(view, instances_));
    const std::vector<Pixel> drawn = canvas.pixels();
    canvas.clear();
    const auto bound = renderer->bindTrace(program, view, instances_, 5);
    ASSERT_TRUE(bound) << bound.error().detail;
    EXPECT_EQ(bound->instances, 3u);
    const glm::mat4 to_world = glm::inverse(view.camera.eye_to_clip * view.camera.world_to_eye);
    glUseProgram(program);
    glUniformMatrix4fv(glGetUniformLocation(program, "to_world"), 1, GL_FALSE, &to_world[0][0]);
    glUniform2f(glGetUniformLocation(program, "size"), 160, 120);
    drawScreen(program);
    const std::vector<Pixel> traced = canvas.pixels();
    int covered = 0, different = 0;
    for (std::size_t i = 0; i < drawn.size(); ++i) {
      covered += drawn[i][3] != 0;
      bool near = true;
      for (std::size_t c = 0; c < 4; ++c) near = near && std::abs(drawn[i][c] - traced[i][c]) <= 2;
      different += !near;
    }
    EXPECT_GT(covered, 2000);
    EXPECT_LE(different, covered / 100);  // edges, of voxels and of shadows
  }
  glDeleteProgram(program);
}

// Rays from anywhere to anywhere: distance, place, normal, voxel, instance; and kelpBlocked.
TEST_P(HostTraceTest, RandomRaysAgreeWithTheCpu) {
  const auto renderer = makeBoth();
  constexpr int kSide = 96;
  const GLuint program =
      makeTracer(GetParam(), *renderer, kScreen,
                 "uniform highp sampler2D origins; uniform highp sampler2D directions;\n"
                 "layout(location = 0) out uvec4 first; layout(location = 1) out uvec4 second;\n"
                 "void main() {\n"
                 "  vec4 o = texelFetch(origins, ivec2(gl_FragCoord.xy), 0), d = texelFetch(directions, "
                 "ivec2(gl_FragCoord.xy), 0);\n"
                 "  KelpSceneHit hit = kelpTrace(o.xyz, d.xyz, d.w);\n"
                 "  uint tags = (hit.found ? 1u : 0u) | (kelpBlocked(o.xyz, d.xyz, d.w) ? 2u : 0u);\n"
                 "  first = uvec4(tags, floatBitsToUint(hit.t), 0u, 0u);\n"
                 "  second = uvec4(0u);\n"
                 "  if (hit.found) {\n"
                 "    first = uvec4(tags | uint(hit.surface.instance << 8), floatBitsToUint(hit.t), "
                 "floatBitsToUint(hit.surface.position.xy));\n"
                 "    second = floatBitsToUint(vec4(hit.surface.normal, hit.surface.position.z));\n"
                 "  }\n"
                 "}\n");
  ASSERT_NE(program, 0u);
  std::mt19937 random(5);
  std::uniform_real_distribution<float> unit(-1, 1);
  std::vector<glm::vec4> origins, directions;
  for (int i = 0; i < kSide * kSide; ++i) {
    const glm::vec3 from(2.5f * unit(random), 1.5f * unit(random) + 0.5f, 2.0f * unit(random));
    const glm::vec3 to(1.0f * unit(random), 0.5f * unit(random) + 0.5f, 0.8f * unit(random));
    glm::vec3 direction = (1.2f + unit(random)) * (to - from);
    if (i % 16 < 3) direction[i % 16] = 0;  // along the axes' planes
    origins.emplace_back(from, 0);
    directions.emplace_back(direction, i % 7 == 0 ? 0.4f : 3.0f);
  }
  GLuint names[4] = {};
  glGenTextures(4, names);
  for (int i = 0; i < 4; ++i) {
    glActiveTexture(GL_TEXTURE0 + static_cast<GLenum>(i));
    glBindTexture(GL_TEXTURE_2D, names[i]);
    if (i < 2)
      glTexImage2D(GL_TEXTURE_2D, 0, GL_RGBA32F, kSide, kSide, 0, GL_RGBA, GL_FLOAT,
                   i ? directions.data() : origins.data());
    else
      glTexImage2D(GL_TEXTURE_2D, 0, GL_RGBA32UI, kSide, kSide, 0, GL_RGBA_INTEGER, GL_UNSIGNED_INT, nullptr);
    for (const GLenum filter : {GL_TEXTURE_MIN_FILTER, GL_TEXTURE_MAG_FILTER})
      glTexParameteri(GL_TEXTURE_2D, filter, GL_NEAREST);
  }
  GLuint framebuffer = 0;
  glGenFramebuffers(1, &framebuffer);
  glBindFramebuffer(GL_FRAMEBUFFER, framebuffer);
  const GLenum buffers[] = {GL_COLOR_ATTACHMENT0, GL_COLOR_ATTACHMENT1};
  for (const GLenum i : {0u, 1u})
    glFramebufferTexture2D(GL_FRAMEBUFFER, buffers[i], GL_TEXTURE_2D, names[2 + i], 0);
  glDrawBuffers(2, buffers);
  glViewport(0, 0, kSide, kSide);
  ASSERT_EQ(glCheckFramebufferStatus(GL_FRAMEBUFFER), GLenum{GL_FRAMEBUFFER_COMPLETE});

  const gl::View view = lookAt({64, 64}, {9, 9, 9}, {18, 18, 18});  // that looks away from everything
  ASSERT_TRUE(renderer->bindTrace(program, view, instances_));
  glUseProgram(program);
  glUniform1i(glGetUniformLocation(program, "directions"), 1);
  drawScreen(program);
  using Words = std::array<std::uint32_t, 4>;
  std::vector<Words> first(kSide * kSide), second(kSide * kSide);
  glReadPixels(0, 0, kSide, kSide, GL_RGBA_INTEGER, GL_UNSIGNED_INT, first.data());
  glReadBuffer(GL_COLOR_ATTACHMENT1);
  glReadPixels(0, 0, kSide, kSide, GL_RGBA_INTEGER, GL_UNSIGNED_INT, second.data());

  int hits = 0, one_sided = 0, other = 0, blocked_wrong = 0, per_instance[3] = {};
  for (std::size_t i = 0; i < first.size(); ++i) {
    int which = -1;
    const auto hit = nearest({origins[i], directions[i], directions[i].w}, &which);
    const bool found = first[i][0] & 1u;
    hits += hit.has_value();
    one_sided += found != hit.has_value();
    blocked_wrong += found != ((first[i][0] >> 1 & 1u) != 0);
    if (!hit || !found) continue;
    ++per_instance[which];
    const float t = std::bit_cast<float>(first[i][1]);
    const glm::vec3 position(std::bit_cast<float>(first[i][2]), std::bit_cast<float>(first[i][3]),
                             std::bit_cast<float>(second[i][3]));
    const glm::vec3 normal(std::bit_cast<float>(second[i][0]), std::bit_cast<float>(second[i][1]),
                           std::bit_cast<float>(second[i][2]));
    const float length = glm::length(glm::vec3(directions[i]));
    other += static_cast<int>(first[i][0] >> 8) != which || std::abs(t - hit->t) * length > 1e-4f ||
             glm::distance(position, hit->position) > 1e-4f ||
             // a ray that starts in a solid meets no surface
             (t > 0 && glm::distance(normal, hit->normal) > 1e-2f);
  }
  EXPECT_GT(hits, 2000);
  for (const int count : per_instance) EXPECT_GT(count, 300);
  EXPECT_LE(one_sided, hits / 500);
  EXPECT_LE(other, hits / 200);
  EXPECT_EQ(blocked_wrong, 0);
  glDeleteFramebuffers(1, &framebuffer);
  glDeleteTextures(4, names);
  glDeleteProgram(program);
}

// In a vertex shader: a triangle that stands where its ray ends.
TEST_P(HostTraceTest, VertexShadersTraceToo) {
  const Canvas canvas({64, 64});
  const auto renderer = makeBoth();
  const GLuint program = makeTracer(
      GetParam(), *renderer,
      "uniform vec3 origin; uniform vec3 direction; flat out vec4 found;\n"
      "void main() {\n"
      "  KelpSceneHit hit = kelpTrace(origin, direction, 10.0);\n"
      "  found = vec4(hit.found ? hit.t / 10.0 : 1.0, kelpBlocked(origin, direction, 10.0) ? 1.0 : 0.0, 0.0, "
      "1.0);\n"
      "  gl_Position = vec4(gl_VertexID == 1 ? 3.0 : -1.0, gl_VertexID == 2 ? 3.0 : -1.0, 0.0, 1.0);\n"
      "}\n",
      "flat in vec4 found; layout(location = 0) out vec4 color;\nvoid main() { color = found; }\n", true);
  ASSERT_NE(program, 0u);
  ASSERT_TRUE(renderer->bindTrace(program, lookAt(canvas, {0, 0.5f, 3}, {0, 0.5f, 0}), instances_));
  glUseProgram(program);
  const glm::vec3 target = voxelToWorld(instances_[0], 0, {30, 40, 25});
  for (const glm::vec3 from : {glm::vec3(0.4f, 0.6f, 3), glm::vec3(0, 9, 0.5f)}) {
    const glm::vec3 direction = glm::normalize(target - from);
    const auto hit = nearest({from, direction, 10.0f});
    ASSERT_TRUE(hit);
    glUseProgram(program);
    glUniform3f(glGetUniformLocation(program, "origin"), from.x, from.y, from.z);
    glUniform3f(glGetUniformLocation(program, "direction"), direction.x, direction.y, direction.z);
    drawScreen(program);
    const Pixel pixel = canvas.pixels()[0];
    EXPECT_NEAR(pixel[0] / 255.0f * 10.0f, hit->t, 0.025f);
    EXPECT_EQ(pixel[1], 255);
  }
  glDeleteProgram(program);
}

TEST_P(HostTraceTest, RefusesMisuseAndKeepsTheState) {
  const Canvas canvas({64, 64});
  const auto renderer = makeBoth();
  const GLuint program = makeTracer(GetParam(), *renderer, kScreen,
                                    "layout(location = 0) out vec4 color;\nvoid main() { color = "
                                    "vec4(kelpBlocked(vec3(0.0), vec3(1.0), 1.0)); }\n");
  ASSERT_NE(program, 0u);
  const gl::View view = lookAt(canvas, {0, 0.5f, 3}, {0, 0.5f, 0});
  const auto refused = [&](GLuint to, const gl::View& with, int unit) {
    const auto result = renderer->bindTrace(to, with, instances_, unit);
    return !result && result.error().code == ErrorCode::kMisuse;
  };
  GLint units = 0;
  glGetIntegerv(GL_MAX_COMBINED_TEXTURE_IMAGE_UNITS, &units);
  EXPECT_TRUE(refused(0, view, 4));
  EXPECT_TRUE(refused(program, view, -1));
  EXPECT_TRUE(refused(program, view, units - 1));
  gl::View wrong = view;
  wrong.camera.viewport.x = -1;
  EXPECT_TRUE(refused(program, wrong, 4));
  wrong = view;
  wrong.quality.occlusion_rays = 17;
  EXPECT_TRUE(refused(program, wrong, 4));
  wrong.quality.occlusion_rays = 4;
  EXPECT_TRUE(refused(program, wrong, 4));  // without RendererOptions::secondary_rays
  wrong.quality.occlusion_rays = 0;
  wrong.quality.occlusion_reach = 0;
  EXPECT_TRUE(refused(program, wrong, 4));

  glUseProgram(program);
  glActiveTexture(GL_TEXTURE2);
  ASSERT_TRUE(renderer->bindTrace(program, view, instances_, units - 2));
  GLint now = 0;
  glGetIntegerv(GL_CURRENT_PROGRAM, &now);
  EXPECT_EQ(static_cast<GLuint>(now), program);
  glGetIntegerv(GL_ACTIVE_TEXTURE, &now);
  EXPECT_EQ(now, GL_TEXTURE2);
  // Nothing to meet: nothing is met.
  const auto none = renderer->bindTrace(program, view, {});
  ASSERT_TRUE(none);
  EXPECT_EQ(none->instances, 0u);
  drawScreen(program);
  EXPECT_EQ(canvas.pixels()[0][0], 0);
  renderer->abandon();
  EXPECT_TRUE(refused(program, view, 4));
  glDeleteProgram(program);
}

KELP_GL_TESTS(HostTraceTest);

}  // namespace
}  // namespace kelp::test
