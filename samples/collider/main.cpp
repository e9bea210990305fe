// SPDX-License-Identifier: MIT
// A proxy as a collider: the few triangles that `kelp-dump extract --proxy` writes bend with the model, and
// balls bounce off them. toWorld() moves the proxy's vertices as the voxels move.
#define GL_GLEXT_PROTOTYPES
#define GLFW_INCLUDE_GLCOREARB
#include <GLFW/glfw3.h>

#include <array>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <sstream>
#include <string>
#include <string_view>
#include <vector>

#include <glm/gtc/matrix_transform.hpp>

#include "../write_ppm.h"
#include "kelp/kelp.hpp"

// Plain triangles without lights: `shade` comes from their normal.
static const char* const kShaders[] = {R"(#version 330 core
layout(location = 0) in vec3 place;
uniform mat4 to_clip; uniform vec4 ball;
out vec3 at;
void main() { at = place * ball.w + ball.xyz; gl_Position = to_clip * vec4(at, 1.0); })",
                                       R"(#version 330 core
uniform vec3 color;
in vec3 at; out vec4 result;
void main() {
  vec3 n = normalize(cross(dFdx(at), dFdy(at)));
  result = vec4(color * (0.35 + 0.65 * max(dot(n, normalize(vec3(-0.35, 0.9, 0.55))), 0.0)), 1.0);
})"};

struct Mesh {
  std::vector<glm::vec3> points;  // of a proxy: at rest, object space, meters
  std::vector<unsigned> corners;  // three a triangle
};

// Enough of OBJ for what kelp-dump writes.
static bool readObj(const char* path, Mesh& mesh) {
  std::ifstream file(path);
  for (std::string line; std::getline(file, line);) {
    std::istringstream words(line);
    std::string word;
    words >> word;
    if (word == "v") {
      glm::vec3 p(0);
      words >> p.x >> p.y >> p.z;
      mesh.points.push_back(p);
    } else if (word == "f") {
      for (int i = 0; i < 3 && words >> word; ++i)
        mesh.corners.push_back(unsigned(std::atoi(word.c_str())) - 1);
    }
  }
  for (const unsigned corner : mesh.corners)
    if (corner >= mesh.points.size()) return false;
  return !mesh.corners.empty();
}

static Mesh makeBall() {
  Mesh ball;
  constexpr unsigned kRound = 16, kUp = 8;
  for (unsigned i = 0; i <= kUp; ++i)
    for (unsigned j = 0; j <= kRound; ++j) {
      const float up = 3.14159265f * float(i) / kUp, round = 6.2831853f * float(j) / kRound;
      ball.points.push_back({std::sin(up) * std::cos(round), std::cos(up), std::sin(up) * std::sin(round)});
      if (i == kUp || j == kRound) continue;
      const unsigned a = i * (kRound + 1) + j, b = a + kRound + 1;
      for (const unsigned corner : {a, a + 1, b, b, a + 1, b + 1}) ball.corners.push_back(corner);
    }
  return ball;
}

// The nearest point of a triangle (Ericson, Real-Time Collision Detection, 5.1.5).
static glm::vec3 nearest(const glm::vec3& p, const glm::vec3& a, const glm::vec3& b, const glm::vec3& c) {
  const auto onEdge = [&](const glm::vec3& from, const glm::vec3& to) {
    const glm::vec3 along = to - from;
    return from +
           along * glm::clamp(glm::dot(p - from, along) / glm::max(glm::dot(along, along), 1e-20f), 0.f, 1.f);
  };
  const glm::vec3 n = glm::cross(b - a, c - a);
  const bool inside = glm::dot(glm::cross(b - a, p - a), n) >= 0 &&
                      glm::dot(glm::cross(c - b, p - b), n) >= 0 &&
                      glm::dot(glm::cross(a - c, p - c), n) >= 0;
  if (inside && glm::dot(n, n) > 0) return p - n * (glm::dot(p - a, n) / glm::dot(n, n));
  glm::vec3 best = onEdge(a, b);
  for (const glm::vec3& q : {onEdge(b, c), onEdge(c, a)})
    if (glm::distance(p, q) < glm::distance(p, best)) best = q;
  return best;
}

struct Ball {
  glm::vec3 place, speed{0};
};

// One step: falls, and is pushed out of every triangle that it touches. The triangles are few, so all are
// tested; a game gives them to its physics engine.
static int step(Ball& ball, float radius, float seconds, float gravity, const Mesh& mesh,
                const std::vector<glm::vec3>& bent) {
  int touches = 0;
  ball.speed.y -= gravity * seconds;
  ball.place += ball.speed * seconds;
  for (std::size_t i = 0; i < mesh.corners.size(); i += 3) {
    const glm::vec3 p =
        nearest(ball.place, bent[mesh.corners[i]], bent[mesh.corners[i + 1]], bent[mesh.corners[i + 2]]);
    const glm::vec3 away = ball.place - p;
    const float distance = glm::length(away);
    if (!(distance < radius) || distance == 0) continue;
    const glm::vec3 out = away / distance;
    ball.place = p + out * radius;
    ball.speed -= 1.5f * glm::min(glm::dot(ball.speed, out), 0.0f) * out;
    ++touches;
  }
  return touches;
}

static int fail(const char* what, const char* why, int exit_code) {
  return std::fprintf(stderr, "collider: %s: %s\n", what, why), exit_code;
}

// Long: set up once, then a frame, top to bottom, as a reader follows it.
static int run(GLFWwindow* window, const char* path, const char* proxy, int frames, const char* picture) {
  const auto asset = kelp::runtime::Asset::open(path);
  if (!asset) return fail(path, asset.error().detail, asset.error().code == kelp::ErrorCode::kIo ? 2 : 3);
  if (const auto loaded = (*asset)->loadAll(); !loaded) return fail(path, loaded.error().detail, 3);
  Mesh mesh;
  if (!readObj(proxy, mesh)) return fail(proxy, "no triangles; make it by kelp-dump extract --proxy", 2);
  const auto renderer = kelp::gl::Renderer::create(
      {.getProcAddress = [](void*, const char* name) { return (void*)glfwGetProcAddress(name); }});
  if (!renderer) return fail("renderer", renderer.error().detail, 4);
  (*renderer)->add(**asset).value();
  (void)(*renderer)->upload(~std::uint64_t{0}).value();
  kelp::runtime::Pose pose = kelp::runtime::Pose::create(**asset).value();
  const kelp::runtime::Instance instance{asset->get(), &pose};
  const kelp::Box box = bounds(instance);
  const glm::vec3 center = 0.5f * (box.min + box.max), extent = box.max - box.min;
  const float size = glm::length(extent), radius = 0.025f * size;

  const GLuint program = glCreateProgram();
  for (int i = 0; i < 2; ++i) {
    const GLuint shader = glCreateShader(i == 0 ? GL_VERTEX_SHADER : GL_FRAGMENT_SHADER);
    glShaderSource(shader, 1, &kShaders[i], nullptr);
    glCompileShader(shader);
    glAttachShader(program, shader);
  }
  glLinkProgram(program);
  GLuint arrays = 0, buffers[2] = {};
  glGenVertexArrays(1, &arrays);
  glBindVertexArray(arrays);
  glGenBuffers(2, buffers);
  glBindBuffer(GL_ARRAY_BUFFER, buffers[0]);
  glBindBuffer(GL_ELEMENT_ARRAY_BUFFER, buffers[1]);
  glVertexAttribPointer(0, 3, GL_FLOAT, GL_FALSE, 0, nullptr);
  glEnableVertexAttribArray(0);
  glUseProgram(program);
  glEnable(GL_DEPTH_TEST);
  glEnable(GL_FRAMEBUFFER_SRGB);
  glClearColor(0.30f, 0.50f, 0.58f, 1);
  const auto upload = [](const std::vector<glm::vec3>& points, const std::vector<unsigned>& corners) {
    glBufferData(GL_ARRAY_BUFFER, GLsizeiptr(points.size() * sizeof(glm::vec3)), points.data(),
                 GL_STREAM_DRAW);
    glBufferData(GL_ELEMENT_ARRAY_BUFFER, GLsizeiptr(corners.size() * sizeof(unsigned)), corners.data(),
                 GL_STREAM_DRAW);
  };

  const Mesh ball = makeBall();
  std::vector<Ball> balls;
  for (int i = 0; i < 40; ++i) {  // over the model, in a spiral
    const float turn = 2.4f * float(i), out = 0.06f * std::sqrt(float(i)) * glm::min(extent.x, extent.z);
    balls.push_back({{center.x + out * std::cos(turn), box.max.y + (1 + 0.4f * float(i)) * radius,
                      center.z + out * std::sin(turn)}});
  }
  std::vector<glm::vec3> bent(mesh.points.size());
  int touches = 0;
  for (int frame = 1; !glfwWindowShouldClose(window) && (frames == 0 || frame <= frames); ++frame) {
    pose.reset();
    (void)addClip(**asset, 0, frame / 60.0, 1, pose);  // the first clip, if there is one
    for (std::size_t i = 0; i < bent.size(); ++i) bent[i] = toWorld(instance, 0, mesh.points[i]).value();
    for (Ball& b : balls) touches += step(b, radius, 1 / 60.0f, 0.5f * size, mesh, bent);

    glm::ivec2 pixels(0);
    glfwGetFramebufferSize(window, &pixels.x, &pixels.y);
    const glm::vec2 shape = glm::max(pixels, 1);
    // The model to the left, its proxy to the right: what the balls meet.
    const glm::mat4 to_eye =
        glm::lookAt(center + 1.9f * size * glm::vec3(0.3f, 0.25f, 0.9f), center, {0, 1, 0});
    const glm::mat4 projection = glm::perspectiveFov(0.6f, 0.5f * shape.x, shape.y, 0.05f * size, 10 * size);
    glClear(GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT);
    const glm::mat4 to_clip = projection * to_eye;
    glUniformMatrix4fv(glGetUniformLocation(program, "to_clip"), 1, GL_FALSE, &to_clip[0][0]);
    for (const int side : {0, 1}) {
      glViewport(side * pixels.x / 2, 0, pixels.x / 2, pixels.y);
      upload(ball.points, ball.corners);
      glUniform3f(glGetUniformLocation(program, "color"), 0.80f, 0.08f, 0.04f);
      for (const Ball& b : balls) {
        glUniform4f(glGetUniformLocation(program, "ball"), b.place.x, b.place.y, b.place.z, radius);
        glDrawElements(GL_TRIANGLES, GLsizei(ball.corners.size()), GL_UNSIGNED_INT, nullptr);
      }
      if (side == 0) {
        const kelp::gl::View view{.camera = {to_eye, projection, {pixels.x / 2, pixels.y}}};
        (*renderer)->draw(view, instance).value();
        continue;
      }
      upload(bent, mesh.corners);
      glUniform3f(glGetUniformLocation(program, "color"), 0.75f, 0.72f, 0.62f);
      glUniform4f(glGetUniformLocation(program, "ball"), 0, 0, 0, 1);
      glDrawElements(GL_TRIANGLES, GLsizei(mesh.corners.size()), GL_UNSIGNED_INT, nullptr);
    }
    if (frame == frames) {
      std::printf("%zu triangles, %d touches\n", mesh.corners.size() / 3, touches);
      if (const int bad = picture ? writePpm("collider", picture, pixels) : 0) return bad;
    }
    glfwSwapBuffers(window);
    glfwPollEvents();
  }
  return 0;
}

int main(int count, char** words) {
  const int frames = count > 4 && std::string_view(words[3]) == "--frames" ? std::atoi(words[4]) : 0;
  if (count != 3 && (frames <= 0 || count > 6))
    return fail("usage",
                "collider PACK.kelp PROXY.obj [--frames N [PICTURE.ppm]]  (ends after N, saves the last)", 1);
  if (!glfwInit()) return fail("window", "no display: set DISPLAY, or use xvfb-run", 4);
  glfwWindowHint(GLFW_CONTEXT_VERSION_MAJOR, 3);
  glfwWindowHint(GLFW_CONTEXT_VERSION_MINOR, 3);
  glfwWindowHint(GLFW_OPENGL_PROFILE, GLFW_OPENGL_CORE_PROFILE);
  glfwWindowHint(GLFW_SRGB_CAPABLE, GLFW_TRUE);
  GLFWwindow* const window = glfwCreateWindow(1200, 720, "kelp: collider", nullptr, nullptr);
  if (!window) return fail("window", "no OpenGL 3.3 core context: update the graphics driver", 4);
  glfwMakeContextCurrent(window);
  return run(window, words[1], words[2], frames, count == 6 ? words[5] : nullptr);
}
