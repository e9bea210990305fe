// SPDX-License-Identifier: MIT
// Voxels among the host's triangles, in every convention of depth: what is written, what hides what, a depth
// texture of the host's that ends rays, a shadow map.
#include <cmath>
#include <cstring>

#include <glm/gtc/matrix_transform.hpp>

#include "depth_canvas.h"

namespace kelp::test {
namespace {

using runtime::Instance;

// Writes KelpSurface::steps, and 255 into alpha.
constexpr char kSteps[] =
    "vec4 kelpSurface(KelpSurface s) { return vec4(vec3(s.steps & 255, s.steps >> 8, 0) / 255.0, 1.0); }\n";

struct Convention {
  const char* name;
  gl::ClipRange range;
  bool reversed;
};
constexpr Convention kConventions[] = {{"standard", gl::ClipRange::kMinusOneToOne, false},
                                       {"reversed", gl::ClipRange::kMinusOneToOne, true},
                                       {"zero to one", gl::ClipRange::kZeroToOne, false},
                                       {"zero to one, reversed", gl::ClipRange::kZeroToOne, true}};

// The view with that convention: reversed ones have their far plane at infinity. Written out, for GLM's own
// depend on macros.
gl::View inConvention(gl::View view, const Convention& convention, float near, float far) {
  const bool zero = convention.range == gl::ClipRange::kZeroToOne;
  glm::mat4& m = view.camera.eye_to_clip;
  m[2][3] = -1;
  if (convention.reversed) {
    m[2][2] = zero ? 0.0f : 1.0f;
    m[3][2] = zero ? near : 2 * near;
  } else {
    m[2][2] = zero ? far / (near - far) : (near + far) / (near - far);
    m[3][2] = (zero ? 1.0f : 2.0f) * far * near / (near - far);
  }
  view.camera.clip_range = convention.range;
  view.camera.reversed_depth = convention.reversed;
  return view;
}

// From the eye through the middle of a pixel; t is the distance before the eye.
runtime::Ray eyeRay(const gl::View& view, int x, int y) {
  const glm::dmat4 to_world = glm::inverse(glm::dmat4(view.camera.world_to_eye));
  const glm::dvec2 at = 2.0 * (glm::dvec2(x, y) + 0.5) / glm::dvec2(view.camera.viewport) - 1.0;
  const glm::dvec4 forward(at.x / double{view.camera.eye_to_clip[0][0]},
                           at.y / double{view.camera.eye_to_clip[1][1]}, -1, 0);
  return {glm::vec3(to_world[3]), glm::vec3(to_world * forward)};
}

// The host's triangles: a square in the world's plane z = `at`, white with alpha 0. Written once a depth
// convention: the host's own matter.
class Square {
 public:
  explicit Square(GlApi api)
      : program_(makeProgram(
            api,
            "uniform mat4 to_clip; uniform float at;\n"
            "void main() { gl_Position = to_clip * vec4(vec2(gl_VertexID & 1, gl_VertexID >> 1) * 2.0 - 1.0, "
            "at, 1.0); }\n",
            "layout(location = 0) out vec4 color;\nvoid main() { color = vec4(1.0, 1.0, 1.0, 0.0); }\n")) {
    glGenVertexArrays(1, &vertices_);
  }
  ~Square() {
    glDeleteProgram(program_);
    glDeleteVertexArrays(1, &vertices_);
  }
  void draw(const gl::View& view, float at) const {
    const glm::mat4 to_clip = view.camera.eye_to_clip * view.camera.world_to_eye;
    glUseProgram(program_);
    glBindVertexArray(vertices_);
    glUniformMatrix4fv(glGetUniformLocation(program_, "to_clip"), 1, GL_FALSE, &to_clip[0][0]);
    glUniform1f(glGetUniformLocation(program_, "at"), at);
    glEnable(GL_DEPTH_TEST);
    glDepthFunc(view.camera.reversed_depth ? GL_GEQUAL : GL_LEQUAL);
    glDrawArrays(GL_TRIANGLE_STRIP, 0, 4);
  }

 private:
  GLuint program_ = 0, vertices_ = 0;
};

// A depth texture that the host has drawn its scene into.
class HostDepth {
 public:
  HostDepth(glm::ivec2 size, GLenum format) {
    glGenTextures(1, &texture_);
    glBindTexture(GL_TEXTURE_2D, texture_);
    glTexImage2D(GL_TEXTURE_2D, 0, static_cast<GLint>(format), size.x, size.y, 0, GL_DEPTH_COMPONENT,
                 format == GL_DEPTH_COMPONENT32F  ? GL_FLOAT
                 : format == GL_DEPTH_COMPONENT16 ? GL_UNSIGNED_SHORT
                                                  : GL_UNSIGNED_INT,
                 nullptr);
    // as shadow maps are left, and worse
    glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, GL_LINEAR_MIPMAP_LINEAR);
    glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_COMPARE_MODE, GL_COMPARE_REF_TO_TEXTURE);
    glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_COMPARE_FUNC, GL_LEQUAL);
    glBindTexture(GL_TEXTURE_2D, 0);
    glGenFramebuffers(1, &framebuffer_);
    glBindFramebuffer(GL_FRAMEBUFFER, framebuffer_);
    glFramebufferTexture2D(GL_FRAMEBUFFER, GL_DEPTH_ATTACHMENT, GL_TEXTURE_2D, texture_, 0);
    const GLenum none = GL_NONE;
    glDrawBuffers(1, &none);
    glReadBuffer(GL_NONE);
    EXPECT_EQ(glCheckFramebufferStatus(GL_FRAMEBUFFER), GLenum{GL_FRAMEBUFFER_COMPLETE});
  }
  ~HostDepth() {
    glDeleteFramebuffers(1, &framebuffer_);
    glDeleteTextures(1, &texture_);
  }
  HostDepth(const HostDepth&) = delete;
  HostDepth& operator=(const HostDepth&) = delete;

  void bind() const {
    glBindFramebuffer(GL_FRAMEBUFFER, framebuffer_);
    glClear(GL_DEPTH_BUFFER_BIT);
  }
  GLuint texture() const { return texture_; }

 private:
  GLuint texture_ = 0, framebuffer_ = 0;
};

class CompositionTest : public GlTest {
 protected:
  // Sets the context up for a convention; false where it cannot have it.
  bool begin(const Convention& convention) {
    glClearDepthf(convention.reversed ? 0.0f : 1.0f);
    using ClipControl = void (*)(GLenum, GLenum);
    const auto clip_control =
        reinterpret_cast<ClipControl>(eglGetProcAddress(desktop() ? "glClipControl" : "glClipControlEXT"));
    const bool there = clip_control && hasClipControl();
    const bool zero = convention.range == gl::ClipRange::kZeroToOne;
    if (there) clip_control(GL_LOWER_LEFT, zero ? GL_ZERO_TO_ONE : GL_NEGATIVE_ONE_TO_ONE);
    return there || !zero;
  }
  bool hasClipControl() const {
    GLint major = 0, minor = 0, count = 0;
    glGetIntegerv(GL_MAJOR_VERSION, &major);
    glGetIntegerv(GL_MINOR_VERSION, &minor);
    if (desktop() && 10 * major + minor >= 45) return true;
    glGetIntegerv(GL_NUM_EXTENSIONS, &count);
    for (GLint i = 0; i < count; ++i) {
      const auto* name = reinterpret_cast<const char*>(glGetStringi(GL_EXTENSIONS, static_cast<GLuint>(i)));
      if (std::strcmp(name, desktop() ? "GL_ARB_clip_control" : "GL_EXT_clip_control") == 0) return true;
    }
    return false;
  }

  const LoadedAsset loaded_{packOf(ballClump({60, 80, 50}, 20, 2))};
  const Instance instance_{loaded_.asset.get(), nullptr};
};

TEST_P(CompositionTest, DepthIsTheProjectionOfTheHitInEveryConvention) {
  const DepthCanvas canvas(GetParam(), {160, 120}, GL_DEPTH_COMPONENT32F);
  const auto renderer = makeRenderer(*loaded_.asset, kVoxelSurface);
  int seen = 0;
  for (const Convention& convention : kConventions) {
    if (!begin(convention)) continue;
    SCOPED_TRACE(convention.name);
    ++seen;
    const gl::View view =
        inConvention(lookAt(canvas.size(), {0.6f, 0.7f, 1.3f}, {0, 0.5f, 0}), convention, 0.125f, 20.0f);
    canvas.clear();
    ASSERT_TRUE(renderer->draw(view, {&instance_, 1}));
    const std::vector<Pixel> pixels = canvas.pixels();
    const std::vector<float> depths = canvas.depths();
    const glm::dmat4 to_clip = glm::dmat4(view.camera.eye_to_clip) * glm::dmat4(view.camera.world_to_eye);
    const double low = convention.range == gl::ClipRange::kZeroToOne ? 0 : -1;
    int hits = 0, one_sided = 0, other = 0;
    for (int i = 0; i < 160 * 120; ++i) {
      const auto at = static_cast<std::size_t>(i);
      const runtime::Ray ray = eyeRay(view, i % 160, i / 160);
      const auto hit = raycast(instance_, ray);
      hits += hit.has_value();
      one_sided += hit.has_value() != (pixels[at][3] != 0);
      if (!hit || pixels[at][3] == 0) {
        if (pixels[at][3] == 0) {
          ASSERT_EQ(depths[at], convention.reversed ? 0.0f : 1.0f);
        }
        continue;
      }
      const glm::dvec4 clip =
          to_clip * glm::dvec4(glm::dvec3(ray.origin) + double{hit->t} * glm::dvec3(ray.direction), 1);
      // As deep as 1/256 voxel, which a ray may enter a solid unnoticed, is at this distance; and float32's
      // own steps.
      const double step = 1.0 / 256 / 80 * 20.0 / 19.875 * 0.125 / (double{hit->t} * double{hit->t}) + 1.2e-7;
      other += std::abs((clip.z / clip.w - low) / (1 - low) - double{depths[at]}) > step;
    }
    EXPECT_GT(hits, 2000);
    EXPECT_LE(one_sided, hits / 500);
    EXPECT_LE(other, hits / 200);
  }
  EXPECT_GE(seen, 2);
}

TEST_P(CompositionTest, TrianglesAndVoxelsHideEachOtherInEveryConvention) {
  const DepthCanvas canvas(GetParam(), {160, 120}, GL_DEPTH_COMPONENT32F);
  const auto renderer = makeRenderer(*loaded_.asset, kVoxelSurface);
  const Square square(GetParam());
  const float plane = 0.05f;  // through the middle of the model
  for (const Convention& convention : kConventions) {
    if (!begin(convention)) continue;
    const gl::View view =
        inConvention(lookAt(canvas.size(), {0.6f, 0.7f, 1.3f}, {0, 0.5f, 0}), convention, 0.125f, 20.0f);
    for (const bool square_first : {true, false}) {
      SCOPED_TRACE(std::string(convention.name) + (square_first ? ", square first" : ", voxels first"));
      canvas.clear();
      if (square_first) square.draw(view, plane);
      ASSERT_TRUE(renderer->draw(view, {&instance_, 1}));
      if (!square_first) square.draw(view, plane);
      const std::vector<Pixel> pixels = canvas.pixels();
      int in_front = 0, behind = 0, wrong = 0;
      for (int i = 0; i < 160 * 120; ++i) {
        const auto hit = raycast(instance_, eyeRay(view, i % 160, i / 160));
        if (!hit || std::abs(hit->position.z - plane) < 1e-3f) continue;
        const bool voxel_expected = hit->position.z > plane;
        voxel_expected ? ++in_front : ++behind;
        wrong += (pixels[static_cast<std::size_t>(i)][3] != 0) != voxel_expected;
      }
      EXPECT_GT(in_front, 500);
      EXPECT_GT(behind, 300);
      EXPECT_LE(wrong, 2);
    }
  }
}

TEST_P(CompositionTest, TheDepthPassWritesTheColorPassesDepthAndNoColor) {
  const Canvas canvas({160, 120});
  const auto renderer = makeRenderer(*loaded_.asset, kVoxelSurface);
  const gl::View view = lookAt(canvas, {0.8f, 0.9f, 1.8f}, {0, 0.5f, 0});
  ASSERT_TRUE(renderer->draw(view, {&instance_, 1}));
  const std::vector<Pixel> alone = canvas.pixels();
  const std::vector<float> depth_alone = desktop() ? canvas.depths() : std::vector<float>();

  canvas.clear();
  ASSERT_TRUE(renderer->draw(view, {&instance_, 1}, gl::Pass::kDepth));
  for (const Pixel& pixel : canvas.pixels()) ASSERT_EQ(pixel, Pixel{});
  if (desktop()) {
    EXPECT_EQ(canvas.depths(), depth_alone);
  }
  ASSERT_TRUE(renderer->draw(view, {&instance_, 1}));
  EXPECT_EQ(canvas.pixels(), alone);
}

// With the depth of the scene known, the picture stays as it is, to the pixel, whatever the format of the
// depth and the part of its range.
TEST_P(CompositionTest, TheScenesDepthChangesNoPicture) {
  const Square square(GetParam());
  const auto renderer = makeRenderer(*loaded_.asset, kVoxelSurface);
  const float plane = 0.05f;
  for (const GLenum format : {GL_DEPTH_COMPONENT16, GL_DEPTH_COMPONENT24, GL_DEPTH_COMPONENT32F}) {
    const HostDepth scene({160, 120}, format);
    const DepthCanvas canvas(GetParam(), {160, 120}, format);
    for (const Convention& convention : kConventions) {
      if (!begin(convention)) continue;
      for (const glm::vec2 range : {glm::vec2(0, 1), glm::vec2(0.25f, 0.5f), glm::vec2(0.9f, 0.95f)}) {
        SCOPED_TRACE(std::string(convention.name) + " " + std::to_string(format) + " from " +
                     std::to_string(range.x));
        gl::View view =
            inConvention(lookAt(canvas.size(), {0.6f, 0.7f, 1.3f}, {0, 0.5f, 0}), convention, 0.5f, 20.0f);
        glDepthRangef(range.x, range.y);
        GLint framebuffer = 0;
        glGetIntegerv(GL_FRAMEBUFFER_BINDING, &framebuffer);
        scene.bind();
        square.draw(view, plane);
        glBindFramebuffer(GL_FRAMEBUFFER, static_cast<GLuint>(framebuffer));
        std::vector<Pixel> pictures[2];
        for (const bool known : {false, true}) {
          view.scene_depth = known ? scene.texture() : 0;
          canvas.clear();
          square.draw(view, plane);
          ASSERT_TRUE(renderer->draw(view, {&instance_, 1}));
          pictures[known] = canvas.pixels();
        }
        EXPECT_EQ(pictures[0], pictures[1]);
      }
    }
  }
  glDepthRangef(0, 1);
}

// Rays end at the scene: without a depth buffer's help nothing is drawn behind it, and the voxels before it
// take no more steps.
TEST_P(CompositionTest, TheScenesDepthEndsRays) {
  const Square square(GetParam());
  const auto renderer = makeRenderer(*loaded_.asset, kSteps);
  const float plane = 0.05f;
  const HostDepth scene({160, 120}, GL_DEPTH_COMPONENT24);
  const Canvas canvas({160, 120});
  for (const Convention& convention : kConventions) {
    if (!begin(convention)) continue;
    SCOPED_TRACE(convention.name);
    gl::View view =
        inConvention(lookAt(canvas.size(), {0.6f, 0.7f, 1.3f}, {0, 0.5f, 0}), convention, 0.5f, 20.0f);
    GLint framebuffer = 0;
    glGetIntegerv(GL_FRAMEBUFFER_BINDING, &framebuffer);
    scene.bind();
    square.draw(view, plane);
    glBindFramebuffer(GL_FRAMEBUFFER, static_cast<GLuint>(framebuffer));
    std::vector<Pixel> pictures[2];
    for (const bool known : {false, true}) {
      view.scene_depth = known ? scene.texture() : 0;
      canvas.clear();
      ASSERT_TRUE(renderer->draw(view, {&instance_, 1}));
      pictures[known] = canvas.pixels();
    }
    long steps[2] = {};
    int wrong = 0, before = 0, behind = 0;
    for (int i = 0; i < 160 * 120; ++i) {
      const Pixel& whole = pictures[0][static_cast<std::size_t>(i)];
      const Pixel& ended = pictures[1][static_cast<std::size_t>(i)];
      steps[0] += whole[0] + 256 * whole[1];
      steps[1] += ended[0] + 256 * ended[1];
      const auto hit = raycast(instance_, eyeRay(view, i % 160, i / 160));
      if (!hit || std::abs(hit->position.z - plane) < 2e-3f) continue;
      const bool in_front = hit->position.z > plane;
      in_front ? ++before : ++behind;
      wrong += (ended[3] != 0) != in_front || (in_front && ended != whole);
    }
    EXPECT_GT(before, 500);
    EXPECT_GT(behind, 300);
    EXPECT_LE(wrong, 2);
    EXPECT_LT(steps[1], steps[0]);
  }
}

// A shadow map: the depth pass from the sun, read in the host's surface function through View::bind, against
// shadow rays on the CPU.
TEST_P(CompositionTest, AShadowMapReachesTheVoxels) {
  struct Host {
    glm::mat4 world_to_sun{1};
    GLuint map = 0;
    int calls = 0;
  } host;
  const auto renderer =
      makeRenderer(*loaded_.asset,
                   "uniform highp sampler2DShadow host_map;\n"
                   "uniform mat4 host_to_sun;\n"
                   "vec4 kelpSurface(KelpSurface s) {\n"
                   "  vec3 at = 0.5 + 0.5 * (host_to_sun * vec4(s.position, 1.0)).xyz;\n"
                   "  return vec4(texture(host_map, vec3(at.xy, at.z - 0.01)), 0.0, 0.0, 1.0);\n"
                   "}\n");
  const auto bind = [](void* user, std::uint32_t program) {
    auto& known = *static_cast<Host*>(user);
    ++known.calls;
    glUniformMatrix4fv(glGetUniformLocation(program, "host_to_sun"), 1, GL_FALSE, &known.world_to_sun[0][0]);
    glUniform1i(glGetUniformLocation(program, "host_map"), gl::kFirstHostUnit + 1);
    glActiveTexture(GL_TEXTURE0 + gl::kFirstHostUnit + 1);
    glBindTexture(GL_TEXTURE_2D, known.map);
  };
  const glm::vec3 sun = glm::normalize(glm::vec3(0.5f, 0.8f, 0.4f));
  const Convention& standard = kConventions[0];
  ASSERT_TRUE(begin(standard));

  const HostDepth map({512, 512}, GL_DEPTH_COMPONENT24);
  glBindTexture(GL_TEXTURE_2D, map.texture());
  for (const GLenum filter : {GL_TEXTURE_MIN_FILTER, GL_TEXTURE_MAG_FILTER})
    glTexParameteri(GL_TEXTURE_2D, filter, GL_NEAREST);
  glBindTexture(GL_TEXTURE_2D, 0);
  host.map = map.texture();
  gl::View from_sun =
      orthographic({512, 512}, glm::vec3(0, 0.5f, 0) + 2.0f * sun, {0, 0.5f, 0}, 0.8f, 1.0f, 3.0f);
  from_sun.bind = bind;
  from_sun.bind_user = &host;
  map.bind();
  glViewport(0, 0, 512, 512);
  ASSERT_TRUE(renderer->draw(from_sun, {&instance_, 1}, gl::Pass::kDepth));
  host.world_to_sun = from_sun.camera.eye_to_clip * from_sun.camera.world_to_eye;

  const Canvas canvas({160, 120});
  gl::View view = lookAt(canvas, {0.6f, 0.7f, 1.3f}, {0, 0.5f, 0});
  view.bind = bind;
  view.bind_user = &host;
  canvas.clear();
  ASSERT_TRUE(renderer->draw(view, {&instance_, 1}));
  EXPECT_EQ(host.calls, 2);
  EXPECT_EQ(glGetError(), GLenum{GL_NO_ERROR});
  const std::vector<Pixel> pixels = canvas.pixels();
  int lit = 0, dark = 0, wrong = 0;
  for (int i = 0; i < 160 * 120; ++i) {
    const auto hit = raycast(instance_, pixelRay(view, i % 160, i / 160));
    if (!hit || pixels[static_cast<std::size_t>(i)][3] == 0) continue;
    // The bias of 0.01 is of a range of 2 meters.
    const bool shaded = raycast(instance_, {hit->position + 0.02f * sun, sun}).has_value();
    shaded ? ++dark : ++lit;
    wrong += (pixels[static_cast<std::size_t>(i)][0] > 127) == shaded;
  }
  EXPECT_GT(lit, 500);
  EXPECT_GT(dark, 500);
  EXPECT_LE(wrong, (lit + dark) / 40);  // edges: a texel of the map is 3 mm, a pixel 11
}

KELP_GL_TESTS(CompositionTest);

}  // namespace
}  // namespace kelp::test
