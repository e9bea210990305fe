// SPDX-License-Identifier: MIT
// A reef to look at: the window, its keys, the clock and the loop. Stage draws, Reef lives.
#include "scenery.h"  // OpenGL's header, first

#include <charconv>
#include <cmath>
#include <cstdio>
#include <optional>
#include <string>
#include <string_view>

#include "../write_ppm.h"
#include "reef.h"
#include "stage.h"

namespace underwater {
namespace {

constexpr double kFrame = 1.0 / 30;    // seconds, with --frames
constexpr double kLongest = 0.1;       // seconds: after a longer pause the scene goes on where it was
constexpr float kSwimSpeed = 1.6f;     // meters a second
constexpr float kPixelTurn = 0.004f;   // radians
constexpr float kPlayerRadius = 0.6f;  // meters

const char* const kUsage =
    "usage: underwater PACKS_FOLDER [--plants N] [--size WxH] [--start SECONDS] [--frames N [PICTURE.ppm]]\n"
    "Shows a reef made of kelp_plant, sea_grass, dulse, fish and fusilier, whose packs are in the folder.\n"
    "Drag the mouse to look round, W A S D Q E to swim, C to give the camera back. With --frames it ends "
    "after N\n"
    "frames, a thirtieth of a second apart, and saves the last as a picture.\n";

struct Arguments {
  std::string packs;    // folder
  std::string picture;  // of the last frame; empty: none
  int frames = 0;       // 0: until the window is closed
  int plants = 400;
  double start = 0;            // seconds into the scene
  glm::ivec2 size{1280, 720};  // pixels
};

template <class T>
bool read(std::string_view word, T low, T high, T& value) {
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
  // false for a NaN
  return error == std::errc() && end == word.data() + word.size() && value >= low && value <= high;
}

// The command line, or none if it is not as kUsage says.
std::optional<Arguments> parse(int count, const char* const* words) {
  Arguments a;
  for (int i = 1; i < count; ++i) {
    const std::string_view word = words[i];
    const bool option = word.starts_with("-");
    const std::string_view value = option && i + 1 < count ? words[++i] : "";
    bool good = false;
    if (word == "--plants") {
      good = read(value, 0, 20000, a.plants);
    } else if (word == "--size") {
      const std::size_t by = value.find('x');
      good = by != value.npos && read(value.substr(0, by), 16, 16384, a.size.x) &&
             read(value.substr(by + 1), 16, 16384, a.size.y);
    } else if (word == "--start") {
      good = read(value, 0.0, 1e6, a.start);
    } else if (word == "--frames") {
      good = read(value, 1, 1000000, a.frames);
      if (good && i + 1 < count && words[i + 1][0] != '-') a.picture = words[++i];
    } else if (!option && a.packs.empty() && !word.empty()) {
      a.packs = word;
      good = true;
    }
    if (!good) return std::nullopt;
  }
  if (a.packs.empty()) return std::nullopt;
  return a;
}

// Prints the error. Returns the exit code: 2 for input or output, 4 for graphics, 3 for the pack.
int fail(const std::string& what, const kelp::Error& error) {
  std::fprintf(stderr, "underwater: %s: %s: %s\n", what.c_str(), kelp::toString(error.code), error.detail);
  if (error.code == kelp::ErrorCode::kIo) return 2;
  return error.code == kelp::ErrorCode::kGraphics || error.code == kelp::ErrorCode::kOutOfMemory ? 4 : 3;
}

// Mouse and keys since the last frame.
class Controls {
 public:
  explicit Controls(GLFWwindow* window) : window_(window) { glfwGetCursorPos(window, &mouse_.x, &mouse_.y); }

  void use(Camera& camera, float passed) {
    const glm::dvec2 before = mouse_;
    glfwGetCursorPos(window_, &mouse_.x, &mouse_.y);
    if (held(GLFW_KEY_ESCAPE)) glfwSetWindowShouldClose(window_, GLFW_TRUE);
    if (held(GLFW_KEY_C)) camera.release();
    if (glfwGetMouseButton(window_, GLFW_MOUSE_BUTTON_LEFT) && mouse_ != before)
      camera.look(kPixelTurn * glm::vec2(mouse_ - before));
    const glm::vec3 wish(held(GLFW_KEY_D) - held(GLFW_KEY_A), held(GLFW_KEY_E) - held(GLFW_KEY_Q),
                         held(GLFW_KEY_W) - held(GLFW_KEY_S));
    if (!camera.circling() || wish != glm::vec3(0)) camera.swim(kSwimSpeed * wish, passed);
  }

 private:
  int held(int key) const { return glfwGetKey(window_, key) == GLFW_PRESS; }

  GLFWwindow* window_;
  glm::dvec2 mouse_{0};
};

// Once a second, in the title: how long a frame takes, and what is in it.
class Title {
 public:
  explicit Title(GLFWwindow* window) : window_(window) {}

  void tell(double seconds, const kelp::gl::Stats& stats) {
    ++frames_;
    if (seconds - told_ < 1) return;
    char text[160];
    std::snprintf(text, sizeof text,
                  "kelp: underwater - %.1f ms, %u drawn, %u culled, %u draws, %.1f MiB on the GPU",
                  1e3 * (seconds - told_) / frames_, stats.instances, stats.culled, stats.draws,
                  static_cast<double>(stats.gpu_bytes) / (1 << 20));
    glfwSetWindowTitle(window_, text);
    told_ = seconds;
    frames_ = 0;
  }

 private:
  GLFWwindow* window_;
  double told_ = glfwGetTime();
  int frames_ = 0;
};

int run(GLFWwindow* window, const Arguments& arguments) {
  std::string wrong;
  const auto library = Library::open(arguments.packs, wrong);
  if (!library) return fail(wrong, library.error());
  const auto reef = Reef::grow(**library, arguments.plants, arguments.start);
  if (!reef) return fail("scene", reef.error());
  const auto stage = Stage::build(**library);
  if (!stage) return fail("scene", stage.error());

  Camera camera;
  Controls controls(window);
  Title title(window);
  double seconds = arguments.start, last = glfwGetTime();
  bool running = arguments.frames == 0;  // with --frames the scene waits for its voxels
  for (int frame = 0;
       !glfwWindowShouldClose(window) && (arguments.frames == 0 || frame < arguments.frames);) {
    glfwPollEvents();
    const double now = glfwGetTime(), passed = arguments.frames > 0 ? kFrame : glm::min(now - last, kLongest);
    last = now;
    controls.use(camera, static_cast<float>(passed));
    if (camera.circling()) camera.circle(seconds);
    (*reef)->update(seconds, running ? static_cast<float>(passed) : 0.0f, {camera.at(), kPlayerRadius});

    glm::ivec2 viewport;
    glfwGetFramebufferSize(window, &viewport.x, &viewport.y);
    const bool all_read = (*library)->idle();
    if (viewport.x * viewport.y > 0) {  // not minimized
      const auto drawn = (*stage)->draw(camera, seconds, viewport, (*reef)->instances());
      if (!drawn) return fail("scene", drawn.error());
      (*library)->ask();
      title.tell(now, *drawn);
      const bool complete = all_read && drawn->pending == 0;
      if (complete) ++frame;  // frames count while all the voxels are there
      running = arguments.frames == 0 || complete;
      if (running) seconds += passed;
      if (frame == arguments.frames && !arguments.picture.empty()) {
        if (const int bad = writePpm("underwater", arguments.picture.c_str(), viewport)) return bad;
      }
    }
    glfwSwapBuffers(window);
  }
  return (*library)->damaged() ? 3 : 0;
}

}  // namespace
}  // namespace underwater

int main(int count, char** words) {
  const std::optional<underwater::Arguments> arguments = underwater::parse(count, words);
  if (!arguments) return std::fputs(underwater::kUsage, stderr), 1;
  if (!glfwInit()) return std::fputs("underwater: no display: set DISPLAY, or use xvfb-run\n", stderr), 4;
  glfwWindowHint(GLFW_CONTEXT_VERSION_MAJOR, 3);
  glfwWindowHint(GLFW_CONTEXT_VERSION_MINOR, 3);
  glfwWindowHint(GLFW_OPENGL_PROFILE, GLFW_OPENGL_CORE_PROFILE);
  glfwWindowHint(GLFW_SRGB_CAPABLE, GLFW_TRUE);
  GLFWwindow* const window =
      glfwCreateWindow(arguments->size.x, arguments->size.y, "kelp: underwater", nullptr, nullptr);
  if (!window)
    return std::fputs("underwater: no OpenGL 3.3 core context: update the graphics driver\n", stderr), 4;
  glfwMakeContextCurrent(window);
  const int exit_code = underwater::run(window, *arguments);
  glfwTerminate();
  return exit_code;
}
