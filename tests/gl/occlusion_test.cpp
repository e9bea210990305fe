// SPDX-License-Identifier: MIT
// Voxels and the host's triangles hide each other; the depth pass writes what the color pass writes.
#include <cmath>

#include <glm/gtc/matrix_transform.hpp>

#include "canvas.h"

namespace kelp::test {
namespace {

using runtime::Instance;

// Draws a square in the world's plane z = depth, in one color, with an ordinary program.
class Square {
 public:
  explicit Square(bool es) {
    const std::string version = es ? "#version 300 es\nprecision highp float;\n" : "#version 330 core\n";
    const std::string vertex = version +
                               "uniform mat4 to_clip; uniform float depth;\n"
                               "void main() { vec2 p = vec2(gl_VertexID & 1, gl_VertexID >> 1) * 8.0 - 4.0;\n"
                               "  gl_Position = to_clip * vec4(p, depth, 1.0); }\n";
    const std::string fragment =
        version + "out vec4 color;\nvoid main() { color = vec4(1.0, 1.0, 1.0, 0.0); }\n";
    program_ = glCreateProgram();
    for (const auto& [kind, text] :
         {std::pair{GL_VERTEX_SHADER, vertex}, std::pair{GL_FRAGMENT_SHADER, fragment}}) {
      const GLuint shader = glCreateShader(static_cast<GLenum>(kind));
      const char* source = text.c_str();
      glShaderSource(shader, 1, &source, nullptr);
      glCompileShader(shader);
      glAttachShader(program_, shader);
      glDeleteShader(shader);
    }
    glLinkProgram(program_);
    glGenVertexArrays(1, &vertices_);
  }
  ~Square() {
    glDeleteProgram(program_);
    glDeleteVertexArrays(1, &vertices_);
  }

  void draw(const gl::View& view, float depth) const {
    const glm::mat4 to_clip = view.camera.eye_to_clip * view.camera.world_to_eye;
    glUseProgram(program_);
    glBindVertexArray(vertices_);
    glUniformMatrix4fv(glGetUniformLocation(program_, "to_clip"), 1, GL_FALSE, &to_clip[0][0]);
    glUniform1f(glGetUniformLocation(program_, "depth"), depth);
    glEnable(GL_DEPTH_TEST);
    glDrawArrays(GL_TRIANGLE_STRIP, 0, 4);
  }

 private:
  GLuint program_ = 0;
  GLuint vertices_ = 0;
};

class OcclusionTest : public GlTest {
 protected:
  const LoadedAsset loaded_{packOf(ballClump({60, 80, 50}, 20, 2))};
  const Instance instance_{loaded_.asset.get(), nullptr};
};

TEST_P(OcclusionTest, TrianglesAndVoxelsHideEachOther) {
  const Canvas canvas({160, 120});
  const auto renderer = makeRenderer(*loaded_.asset, kVoxelSurface);
  const Square square(!desktop());
  const gl::View view = lookAt(canvas, {0.8f, 0.9f, 1.8f}, {0, 0.5f, 0});
  const float plane = 0.05f;  // through the middle of the model
  for (const bool square_first : {true, false}) {
    canvas.clear();
    if (square_first) square.draw(view, plane);
    ASSERT_TRUE(renderer->draw(view, {&instance_, 1}));
    if (!square_first) square.draw(view, plane);
    const std::vector<Pixel> pixels = canvas.pixels();
    int in_front = 0, behind = 0, wrong = 0;
    for (int y = 0; y < 120; ++y) {
      for (int x = 0; x < 160; ++x) {
        const runtime::Ray ray = pixelRay(view, x, y);
        const auto hit = raycast(instance_, ray);
        if (!hit || std::abs(hit->position.z - plane) < 1e-3f) continue;
        const bool voxel_expected = hit->position.z > plane;  // the eye looks from +z
        voxel_expected ? ++in_front : ++behind;
        wrong += (pixels[static_cast<std::size_t>(160 * y + x)][3] != 0) != voxel_expected;
      }
    }
    EXPECT_GT(in_front, 500);
    EXPECT_GT(behind, 300);
    EXPECT_LE(wrong, 2) << "square first: " << square_first;
  }
}

TEST_P(OcclusionTest, TheDepthPassWritesTheColorPassesDepthAndNoColor) {
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

TEST_P(OcclusionTest, OverlappingInstancesShowTheNearest) {
  const Canvas canvas({160, 120});
  const auto renderer = makeRenderer(*loaded_.asset, kVoxelSurface);
  Instance both[2] = {instance_, instance_};
  both[1].to_world =
      glm::rotate(glm::translate(glm::mat4(1), glm::vec3(0.2f, 0.1f, -0.1f)), 1.0f, glm::vec3(0, 1, 0));
  const gl::View view = lookAt(canvas, {0.8f, 0.9f, 1.8f}, {0, 0.5f, 0});
  ASSERT_TRUE(renderer->draw(view, both));
  const std::vector<Pixel> one_way = canvas.pixels();
  std::swap(both[0], both[1]);
  canvas.clear();
  ASSERT_TRUE(renderer->draw(view, both));
  EXPECT_EQ(canvas.pixels(), one_way);
}

TEST_P(OcclusionTest, DepthFollowsTheHostsDepthRange) {
  const Canvas canvas({80, 60});
  // The depth written, in 24 bits: OpenGL ES reads no depth buffer.
  const auto renderer = makeRenderer(
      *loaded_.asset,
      "vec4 kelpSurface(KelpSurface s) {\n"
      "  uint d = uint(gl_FragDepth * 16777215.0 + 0.5);\n"
      "  return vec4(float(d & 255u), float((d >> 8u) & 255u), float(d >> 16u), 255.0) / 255.0;\n"
      "}\n");
  const gl::View view = lookAt(canvas, {0.8f, 0.9f, 1.8f}, {0, 0.5f, 0}, 0.5f, 5.0f);
  const auto drawnDepths = [&] {
    canvas.clear();
    EXPECT_TRUE(renderer->draw(view, {&instance_, 1}));
    std::vector<float> depths;
    for (const Pixel& p : canvas.pixels())
      depths.push_back(p[3] ? static_cast<float>(p[0] + 256 * p[1] + 65536 * p[2]) / 16777215.0f : -1.0f);
    return depths;
  };
  const std::vector<float> whole = drawnDepths();
  glDepthRangef(0.25f, 0.75f);
  const std::vector<float> half = drawnDepths();
  int seen = 0;
  for (std::size_t i = 0; i < whole.size(); ++i) {
    if (whole[i] < 0) continue;
    ++seen;
    ASSERT_NEAR(half[i], 0.25f + 0.5f * whole[i], 1e-6f);
    // Against the projection: 1 - n / w over 1 - n / f.
    const auto hit = raycast(instance_, pixelRay(view, static_cast<int>(i % 80), static_cast<int>(i / 80)));
    ASSERT_TRUE(hit);
    const float w = -(view.camera.world_to_eye * glm::vec4(hit->position, 1)).z;
    ASSERT_NEAR(whole[i], (1 - 0.5f / w) / (1 - 0.5f / 5.0f), 1e-4f);
  }
  EXPECT_GT(seen, 300);
}

KELP_GL_TESTS(OcclusionTest);

}  // namespace
}  // namespace kelp::test
