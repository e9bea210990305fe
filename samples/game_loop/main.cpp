// SPDX-License-Identifier: MIT
// The smallest honest host of kelp: window, context, thread, clock and depth buffer are its own.
// samples/README.md lists the lines that are kelp's.
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

#include "kelp/kelp.h"

static int fail(const char* what, const char* why, int exit_code) {
  return std::fprintf(stderr, "game_loop: %s: %s\n", what, why), exit_code;
}

static int writePicture(const char* path, const glm::ivec2& size) {
  std::vector<char> row(3u * static_cast<unsigned>(size.x));
  std::ofstream file(path, std::ios::binary);
  file << "P6\n" << size.x << " " << size.y << "\n255\n";
  glPixelStorei(GL_PACK_ALIGNMENT, 1);
  for (int y = size.y - 1; y >= 0; --y) {
    glReadPixels(0, y, size.x, 1, GL_RGB, GL_UNSIGNED_BYTE, row.data());
    file.write(row.data(), static_cast<std::streamsize>(row.size()));
  }
  return file.flush() ? 0 : fail(path, "the picture cannot be written", 2);
}

static void* functionOf(void*, const char* name) { return reinterpret_cast<void*>(glfwGetProcAddress(name)); }

static int run(GLFWwindow* window, const char* path, int frames, const char* picture) {
  const auto asset = kelp::runtime::Asset::open(path);  // in an instant: no voxels yet
  if (!asset) return fail(path, asset.error().detail, asset.error().code == kelp::ErrorCode::kIo ? 2 : 3);
  const auto renderer = kelp::gl::Renderer::create({.getProcAddress = functionOf}).value();
  renderer->add(**asset).value();
  kelp::runtime::Pose pose = kelp::runtime::Pose::create(**asset).value();
  const kelp::runtime::Instance instance{asset->get(), &pose};
  const kelp::Box box = bounds(instance);  // at rest
  const glm::vec3 extent = box.max - box.min, centre = 0.5f * (box.min + box.max);
  const float size = glm::length(extent);
  glEnable(GL_FRAMEBUFFER_SRGB);  // kelp's colours are linear; too dark? See View::output.
  glClearColor(0.30f, 0.50f, 0.58f, 1);
  std::atomic<int> exit_code = -1;  // -1: goes on
  std::thread loader([&] {          // a game would call pump() from its jobs
    while (exit_code == -1) {
      const auto more = (*asset)->pump();  // reads the voxels that the renderer asks for
      if (!more) exit_code = fail(path, more.error().detail, 3);
      if (more && !*more) std::this_thread::sleep_for(std::chrono::milliseconds(2));
    }
  });
  for (int frame = 0; exit_code == -1;) {
    const double seconds = glfwGetTime();
    const float turn = 0.3f * static_cast<float>(seconds);
    glm::ivec2 pixels(0);
    glfwGetFramebufferSize(window, &pixels.x, &pixels.y);
    const glm::vec3 eye = centre + 1.55f * size * glm::vec3(glm::sin(turn), 0.4f, glm::cos(turn));
    const glm::mat4 to_eye = glm::lookAt(eye, centre, {0, 1, 0});
    const float aspect = static_cast<float>(pixels.x) / static_cast<float>(glm::max(pixels.y, 1));
    const glm::mat4 projection = glm::perspective(0.6f, glm::max(aspect, 1e-3f), 0.05f * size, 10.0f * size);
    pose.reset();
    (void)addClip(**asset, 0, seconds, 1, pose);          // the first clip, if there is one
    const auto sent = renderer->upload(4 << 20).value();  // bytes that this frame may spend
    glViewport(0, 0, pixels.x, pixels.y);
    glClear(GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT);
    // Here a game draws its own: kelp writes real depth, so the nearer of both is seen.
    kelp::gl::View view;
    view.camera = {to_eye, projection, pixels};
    renderer->draw(view, {&instance, 1}).value();
    renderer->draw(view, {&instance, 1}, kelp::gl::Pass::kFog).value();  // smoke, over all that is opaque
    if (sent.pending == 0) ++frame;  // frames count from when all the voxels are there that are to be seen
    const bool last = frame == frames && frames > 0;
    if (last || glfwWindowShouldClose(window))
      exit_code = last && picture ? writePicture(picture, pixels) : 0;
    glfwSwapBuffers(window);
    glfwPollEvents();
  }
  loader.join();
  return exit_code;
}

int main(int count, char** words) {
  const int frames = count > 3 && std::string_view(words[2]) == "--frames" ? std::atoi(words[3]) : 0;
  if (count != 2 && (frames <= 0 || count > 5))
    return std::fputs("usage: game_loop PACK.kelp [--frames N [PICTURE.ppm]]  (saves the last)\n", stderr), 1;
  if (!glfwInit()) return fail("window", "no display: set DISPLAY, or use xvfb-run", 4);
  glfwWindowHint(GLFW_CONTEXT_VERSION_MAJOR, 3);
  glfwWindowHint(GLFW_CONTEXT_VERSION_MINOR, 3);
  glfwWindowHint(GLFW_OPENGL_PROFILE, GLFW_OPENGL_CORE_PROFILE);
  glfwWindowHint(GLFW_SRGB_CAPABLE, GLFW_TRUE);
  GLFWwindow* const window = glfwCreateWindow(960, 720, "kelp: game_loop", nullptr, nullptr);
  if (!window) return fail("window", "no OpenGL 3.3 core context: update the graphics driver", 4);
  glfwMakeContextCurrent(window);
  const int exit_code = run(window, words[1], frames, count == 5 ? words[4] : nullptr);
  glfwTerminate();
  return exit_code;
}
