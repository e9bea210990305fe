// SPDX-License-Identifier: MIT
// The smallest honest embedding of kelp: window, context, thread, clock and depth buffer are the host's. Its
// own triangles, a ground and a striped hoop, go through the voxels: both write real depth, so each hides the
// other where it is nearer.
#define GL_GLEXT_PROTOTYPES
#define GLFW_INCLUDE_GLCOREARB
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

#include "kelp/gl/renderer.h"

// Vertices 0 to 3 are the ground, the other 194 the hoop: no vertex buffer needed. scene = reach, height of
// the ground, seconds.
static const char* const kVertexShader = R"(#version 330 core
uniform mat4 to_clip; uniform vec3 scene;
flat out vec3 color; out vec2 across;
void main() {
  across = vec2(gl_VertexID & 1, gl_VertexID >> 1) * 5.0 - 2.5;
  vec3 p = vec3(scene.x * across.x, scene.y, scene.x * across.y);
  color = vec3(0.55, 0.46, 0.30);
  if (gl_VertexID >= 4) {
    float angle = float((gl_VertexID - 4) / 2) * 2.0 * 3.14159265 / 96.0;
    float radius = scene.x * ((gl_VertexID & 1) == 0 ? 0.42 : 0.52);
    vec3 u = vec3(cos(scene.z), 0.2, sin(scene.z)), v = vec3(-sin(scene.z), 0.0, cos(scene.z));
    p = radius * (cos(angle) * u + sin(angle) * v);
    across = vec2(0.0);
    color = (gl_VertexID - 4) / 16 % 2 == 0 ? vec3(0.80, 0.05, 0.03) : vec3(0.90, 0.88, 0.82);
  }
  gl_Position = to_clip * vec4(p, 1.0);
})";
static const char* const kFragmentShader = R"(#version 330 core
flat in vec3 color; in vec2 across; out vec4 result;
void main() {
  result = vec4(mix(color, vec3(0.30, 0.50, 0.58), smoothstep(0.5, 2.4, length(across))), 1.0);
})";

// Compiles the triangles' program and sets all OpenGL state of this host, once: kelp leaves the state as it
// finds it.
static GLuint prepareTriangles() {
  const GLuint program = glCreateProgram();
  for (int i = 0; i < 2; ++i) {
    const GLuint shader = glCreateShader(i == 0 ? GL_VERTEX_SHADER : GL_FRAGMENT_SHADER);
    glShaderSource(shader, 1, i == 0 ? &kVertexShader : &kFragmentShader, nullptr);
    glCompileShader(shader);
    glAttachShader(program, shader);
  }
  glLinkProgram(program);
  glUseProgram(program);
  GLuint no_vertices = 0;
  glGenVertexArrays(1, &no_vertices);
  glBindVertexArray(no_vertices);
  glEnable(GL_DEPTH_TEST);
  glEnable(GL_FRAMEBUFFER_SRGB);  // kelp's colours are linear, as ours are
  glClearColor(0.30f, 0.50f, 0.58f, 1);
  glPixelStorei(GL_PACK_ALIGNMENT, 1);
  return program;
}

// Prints what failed and why. Returns the exit code: 2 for input or output, 4 for graphics, 3 for the pack.
static int fail(const char* what, const kelp::Error& error) {
  std::fprintf(stderr, "game_loop: %s: %s: %s\n", what, kelp::toString(error.code), error.detail);
  return error.code == kelp::ErrorCode::kIo ? 2 : error.code == kelp::ErrorCode::kGraphics ? 4 : 3;
}

static int writePicture(const char* path, const glm::ivec2& size) {
  const std::size_t row = 3u * static_cast<unsigned>(size.x);
  std::vector<char> pixels(row * static_cast<unsigned>(size.y));
  glReadPixels(0, 0, size.x, size.y, GL_RGB, GL_UNSIGNED_BYTE, pixels.data());
  std::ofstream file(path, std::ios::binary);
  file << "P6\n" << size.x << " " << size.y << "\n255\n";
  for (std::size_t at = pixels.size(); at > 0; at -= row)
    file.write(&pixels[at - row], static_cast<std::streamsize>(row));
  return file.flush() ? 0 : fail(path, {kelp::ErrorCode::kIo, "the picture cannot be written"});
}

static int run(GLFWwindow* window, const char* path, int frames, const char* picture) {
  auto file = kelp::FileSource::open(path);
  if (!file) return fail(path, file.error());
  const auto asset = kelp::runtime::Asset::open(file->source());  // in an instant: no voxels yet
  if (!asset) return fail(path, asset.error());
  auto pose = kelp::runtime::Pose::create(**asset);
  if (!pose) return fail(path, pose.error());

  kelp::gl::Config config;
  config.getProcAddress = [](void*, const char* name) {
    return reinterpret_cast<void*>(glfwGetProcAddress(name));
  };
  const auto renderer = kelp::gl::Renderer::create(config);
  if (!renderer) return fail("renderer", renderer.error());
  if (const auto added = (*renderer)->add(**asset); !added) return fail(path, added.error());
  const kelp::runtime::Instance instance{&**asset, &*pose};
  const kelp::Box box = bounds(instance);  // at rest
  const glm::vec3 extent = box.max - box.min, centre = 0.5f * (box.min + box.max);
  const GLuint triangles = prepareTriangles();
  std::atomic<bool> quit = false;
  std::atomic<int> exit_code = 0;
  // reads the voxels that the renderer asks for; a game would call pump() from its jobs
  std::thread loader([&] {
    while (exit_code == 0 && !quit) {
      const kelp::Result<bool> more = (*asset)->pump();
      if (!more) exit_code = fail(path, more.error());
      if (more && !*more) std::this_thread::sleep_for(std::chrono::milliseconds(2));
    }
  });

  for (int frame = 0; exit_code == 0 && !glfwWindowShouldClose(window) && (frames == 0 || frame < frames);) {
    const double seconds = glfwGetTime();
    pose->reset();
    if (!(*asset)->pack().clips().empty()) (void)addClip(**asset, 0, seconds, 1.0f, *pose);
    const auto sent = (*renderer)->upload(4 << 20);  // bytes that this frame may spend
    kelp::gl::View view;
    glfwGetFramebufferSize(window, &view.camera.viewport.x, &view.camera.viewport.y);
    const float size = glm::length(extent), now = static_cast<float>(seconds), turn = 0.3f * now;
    view.camera.world_to_eye = glm::lookAt(centre + 1.55f * size * glm::vec3(glm::sin(turn), 0.4f, glm::cos(turn)),
                                    centre, {0, 1, 0});
    const glm::vec2 pixels = glm::max(view.camera.viewport, 1);
    view.camera.eye_to_clip = glm::perspective(0.6f, pixels.x / pixels.y, 0.05f * size, 10.0f * size);
    glViewport(0, 0, view.camera.viewport.x, view.camera.viewport.y);
    glClear(GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT);
    const glm::mat4 to_clip = view.camera.eye_to_clip * glm::translate(view.camera.world_to_eye, centre);
    glUniformMatrix4fv(glGetUniformLocation(triangles, "to_clip"), 1, GL_FALSE, &to_clip[0][0]);
    glUniform3f(glGetUniformLocation(triangles, "scene"), glm::max(extent.x, extent.z), -0.48f * extent.y,
                now);
    for (const glm::ivec2 strip : {glm::ivec2(0, 4), glm::ivec2(4, 194)})
      glDrawArrays(GL_TRIANGLE_STRIP, strip.x, strip.y);
    auto drawn = (*renderer)->draw(view, {&instance, 1});
    // smoke and clouds, over all that is opaque
    if (drawn) drawn = (*renderer)->draw(view, {&instance, 1}, kelp::gl::Pass::kFog);
    if (!sent || (!drawn && view.camera.viewport.x * view.camera.viewport.y > 0))
      exit_code = fail(path, sent ? drawn.error() : sent.error());
    // frames count from when all the voxels are there that are to be seen
    if (sent && sent->pending == 0) ++frame;
    if (frame == frames && picture) exit_code = writePicture(picture, view.camera.viewport);
    glfwSwapBuffers(window);
    glfwPollEvents();
  }
  quit = true;
  loader.join();
  return exit_code;
}

int main(int count, char** words) {
  const bool once = count >= 4 && std::string_view(words[2]) == "--frames" && std::atoi(words[3]) > 0;
  if (count != 2 && !(once && count <= 5))
    return std::fputs(
               "usage: game_loop PACK.kelp [--frames N [PICTURE.ppm]]  (ends after N, saves the last)\n",
               stderr),
           1;
  if (!glfwInit())
    return fail("window", {kelp::ErrorCode::kGraphics, "no display: set DISPLAY, or use xvfb-run"});
  glfwWindowHint(GLFW_CONTEXT_VERSION_MAJOR, 3);
  glfwWindowHint(GLFW_CONTEXT_VERSION_MINOR, 3);
  glfwWindowHint(GLFW_OPENGL_PROFILE, GLFW_OPENGL_CORE_PROFILE);
  glfwWindowHint(GLFW_SRGB_CAPABLE, GLFW_TRUE);
  GLFWwindow* const window = glfwCreateWindow(960, 720, "kelp: game_loop", nullptr, nullptr);
  if (!window)
    return fail("window",
                {kelp::ErrorCode::kGraphics, "no OpenGL 3.3 core context: update the graphics driver"});
  glfwMakeContextCurrent(window);
  const int exit_code =
      run(window, words[1], once ? std::atoi(words[3]) : 0, once && count == 5 ? words[4] : nullptr);
  glfwTerminate();
  return exit_code;
}
