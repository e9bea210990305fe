// SPDX-License-Identifier: MIT
// The smallest complete host of kelp: a window, a loop, a loading thread, and triangles of its own.
#define GL_GLEXT_PROTOTYPES
#include <GLFW/glfw3.h>
#include <atomic>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <string_view>
#include <thread>
#include <vector>

#include <glm/gtc/matrix_transform.hpp>

#include "kelp/kelp.hpp"

namespace runtime = kelp::runtime;

// Prints the error and returns the exit code.
static int fail(const char* what, const char* why, int exit_code) {
  std::fprintf(stderr, "game_loop: %s: %s\n", what, why);
  return exit_code;
}

static int failPack(const char* path, const kelp::Error& error) {
  return fail(path, error.detail, error.code == kelp::ErrorCode::kIo ? 2 : 3);
}

// The host's own triangles, a hoop that goes through the voxels: its vertex and its fragment shader.
static const char* const kHoop[] = {
    R"(#version 330 core
uniform mat4 to_clip;
void main() {
  float angle = float(gl_VertexID / 2) * radians(3.75), radius = (gl_VertexID & 1) == 0 ? 0.42 : 0.52;
  gl_Position = to_clip * vec4(radius * vec3(cos(angle), 0.2 * cos(angle), sin(angle)), 1.0);
})",
    "#version 330 core\nout vec4 color; void main() { color = vec4(0.80, 0.05, 0.03, 1.0); }"};

static GLuint makeHoop() {
  const GLuint program = glCreateProgram();
  for (int i = 0; i < 2; ++i) {
    const GLuint shader = glCreateShader(i == 0 ? GL_VERTEX_SHADER : GL_FRAGMENT_SHADER);
    glShaderSource(shader, 1, &kHoop[i], nullptr);
    glCompileShader(shader);
    glAttachShader(program, shader);
  }
  glLinkProgram(program);
  return program;
}

// OpenGL's state is set once: kelp leaves all of it as it was.
static void setState(GLuint program) {
  GLuint no_vertices = 0;
  glGenVertexArrays(1, &no_vertices);
  glBindVertexArray(no_vertices);
  glUseProgram(program);
  glEnable(GL_DEPTH_TEST);
  glEnable(GL_FRAMEBUFFER_SRGB);  // all colors are linear, kelp's too; without sRGB, see View::output
  glClearColor(0.30f, 0.50f, 0.58f, 1);
}

static void drawHoop(GLuint program, const glm::mat4& to_clip) {
  glUniformMatrix4fv(glGetUniformLocation(program, "to_clip"), 1, GL_FALSE, &to_clip[0][0]);
  glDrawArrays(GL_TRIANGLE_STRIP, 0, 194);
}

// A camera that circles around the model.
static kelp::gl::Camera cameraAt(double seconds, const glm::vec3& center, float size,
                                 const glm::ivec2& pixels) {
  const float turn = 0.3f * static_cast<float>(seconds);
  const glm::vec3 eye = center + 1.55f * size * glm::vec3(glm::sin(turn), 0.4f, glm::cos(turn));
  const glm::vec2 shape = glm::max(pixels, 1);
  return {.world_to_eye = glm::lookAt(eye, center, {0, 1, 0}),
          .eye_to_clip = glm::perspectiveFov(0.6f, shape.x, shape.y, 0.05f * size, 10 * size),
          .viewport = pixels};
}

// Reads the voxels that the renderer asks for, until `exit_code` is set. A game would call pump() from its
// jobs.
static void load(runtime::Asset& asset, const char* path, std::atomic<int>& exit_code) {
  while (exit_code == -1) {
    const kelp::Result<bool> more = asset.pump();
    if (!more) {
      exit_code = failPack(path, more.error());
      return;
    }
    if (!*more) std::this_thread::sleep_for(std::chrono::milliseconds(2));
  }
}

static int writePicture(const char* path, const glm::ivec2& size) {
  std::vector<char> row(3u * static_cast<unsigned>(size.x) + 3);  // OpenGL fills up to multiples of 4
  std::ofstream file(path, std::ios::binary);
  file << "P6\n" << size.x << " " << size.y << "\n255\n";
  for (int y = size.y - 1; y >= 0; --y) {
    glReadPixels(0, y, size.x, 1, GL_RGB, GL_UNSIGNED_BYTE, row.data());
    file.write(row.data(), 3 * size.x);
  }
  if (!file.flush()) return fail(path, "the picture cannot be written", 2);
  return 0;
}

// Draws until the window is closed, or `frames` frames with all voxels. Then saves the last one as `picture`,
// if there is a name.
static int play(GLFWwindow* window, const char* path, runtime::Asset& asset, kelp::gl::Renderer& renderer,
                int frames, const char* picture) {
  runtime::Pose pose = runtime::Pose::create(asset).value();  // value(): an error ends the program
  const runtime::Instance instance{.asset = &asset, .pose = &pose};
  const auto [low, high] = bounds(instance);
  const glm::vec3 center = 0.5f * (low + high);
  const glm::vec3 extent = high - low;
  const float size = glm::length(extent);
  const float reach = glm::max(extent.x, extent.z);
  const GLuint hoop = makeHoop();
  setState(hoop);

  std::atomic<int> exit_code = -1;  // -1: goes on
  std::thread loader([&] { load(asset, path, exit_code); });
  int frame = 0;
  while (exit_code == -1) {
    const double now = glfwGetTime();
    glm::ivec2 pixels(0);
    glfwGetFramebufferSize(window, &pixels.x, &pixels.y);
    const kelp::gl::View view{.camera = cameraAt(now, center, size, pixels)};
    glViewport(0, 0, pixels.x, pixels.y);
    glClear(GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT);

    const glm::mat4 to_clip = view.camera.eye_to_clip * view.camera.world_to_eye;
    drawHoop(hoop, glm::scale(glm::translate(to_clip, center), glm::vec3(reach)));

    pose.reset();
    if (!asset.pack().clips().empty()) addClip(asset, 0, now, 1, pose).value();
    const kelp::gl::Stats uploaded = renderer.upload(4 << 20).value();
    if (uploaded.pending == 0) ++frame;  // counts while all voxels are there
    renderer.draw(view, instance).value();
    renderer.draw(view, instance, kelp::gl::Pass::kFog).value();  // smoke, over all that is opaque

    if (glfwWindowShouldClose(window)) exit_code = 0;
    if (frames > 0 && frame == frames) exit_code = picture ? writePicture(picture, pixels) : 0;
    glfwSwapBuffers(window);
    glfwPollEvents();
  }
  loader.join();
  return exit_code;
}

static int run(GLFWwindow* window, const char* path, runtime::Asset& asset, int frames, const char* picture) {
  const auto renderer = kelp::gl::Renderer::create({.getProcAddress = [](void*, const char* name) {
    return reinterpret_cast<void*>(glfwGetProcAddress(name));
  }});
  if (!renderer) return fail("renderer", renderer.error().detail, 4);
  (*renderer)->add(asset).value();
  return play(window, path, asset, **renderer, frames, picture);
}

int main(int count, char** words) {
  const int frames = count > 3 && std::string_view(words[2]) == "--frames" ? std::atoi(words[3]) : 0;
  if (count != 2 && (frames <= 0 || count > 5))
    return fail("usage", "game_loop PACK.kelp [--frames N [PICTURE.ppm]]  (ends after N, saves the last)", 1);
  const auto asset = runtime::Asset::open(words[1]);  // in an instant: no voxels yet
  if (!asset) return failPack(words[1], asset.error());

  if (!glfwInit()) return fail("window", "no display: set DISPLAY, or use xvfb-run", 4);
  glfwWindowHint(GLFW_CONTEXT_VERSION_MAJOR, 3);
  glfwWindowHint(GLFW_CONTEXT_VERSION_MINOR, 3);
  glfwWindowHint(GLFW_OPENGL_PROFILE, GLFW_OPENGL_CORE_PROFILE);
  glfwWindowHint(GLFW_SRGB_CAPABLE, GLFW_TRUE);
  GLFWwindow* const window = glfwCreateWindow(960, 720, "kelp: game_loop", nullptr, nullptr);
  if (!window) return fail("window", "no OpenGL 3.3 core context: update the graphics driver", 4);
  glfwMakeContextCurrent(window);
  return run(window, words[1], **asset, frames, count == 5 ? words[4] : nullptr);
}
