// SPDX-License-Identifier: MIT
// A jelly that falls on a plate: a soft body between kelp's nodes (soft_body.cpp), pushed by the mouse.
#define GL_GLEXT_PROTOTYPES
#define GLFW_INCLUDE_GLCOREARB
#include <GLFW/glfw3.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <memory>
#include <string_view>

#include <glm/gtc/matrix_transform.hpp>

#include "../write_ppm.h"
#include "soft_body.h"

namespace runtime = kelp::runtime;

static constexpr float kFrame = 1 / 60.0f;
static constexpr float kHeight = 0.35f, kTilt = 0.3f;  // of the fall: meters, radians

static int fail(const char* what, const char* why, int exit_code) {
  return std::fprintf(stderr, "jelly: %s: %s\n", what, why), exit_code;
}

struct Stage {
  std::unique_ptr<runtime::Asset> jelly, plate;
  int part = 0;  // of the jelly, with a cage
  glm::mat4 under{1};
};

// 0, or the exit code.
static int load(const char* path, std::unique_ptr<runtime::Asset>& asset) {
  runtime::AssetOptions options;
  options.distance_level = 0;
  auto opened = runtime::Asset::open(path, options);
  if (!opened) return fail(path, opened.error().detail, opened.error().code == kelp::ErrorCode::kIo ? 2 : 3);
  asset = *std::move(opened);
  if (const auto loaded = asset->loadAll(); !loaded) return fail(path, loaded.error().detail, 3);
  if (!asset->loadsDistances()) return fail(path, "has no distances; bake it without --no-distance", 3);
  return 0;
}

static int load(char** paths, Stage& stage) {
  if (const int bad = load(paths[0], stage.jelly)) return bad;
  if (const int bad = load(paths[1], stage.plate)) return bad;
  const auto parts = stage.jelly->pack().parts();
  while (stage.part < int(parts.size()) && parts[std::size_t(stage.part)].cages.empty()) ++stage.part;
  if (stage.part == int(parts.size())) return fail(paths[0], "has no cage; bake it with --bend cage", 3);
  // The plate's upper side, where it is met, is where the jelly's lower side is at rest.
  const auto [low, high] = bounds(runtime::Instance{stage.plate.get()});
  const glm::vec3 above(0.5f * (low.x + high.x), high.y + 1, 0.5f * (low.z + high.z));
  const auto hit = raycast(runtime::Instance{stage.plate.get()}, {above, {0, -1, 0}});
  const glm::vec3 top = hit ? hit->position : high;
  const auto of_jelly = bounds(runtime::Instance{stage.jelly.get()});
  const glm::vec3 foot(0.5f * (of_jelly.min.x + of_jelly.max.x), of_jelly.min.y,
                       0.5f * (of_jelly.min.z + of_jelly.max.z));
  stage.under = glm::translate(glm::mat4(1), foot - top);
  return 0;
}

// Without a window: ten seconds of falling and wobbling, then a push. tests/samples/check_jelly.py reads it.
static int measure(const Stage& stage) {
  SoftBody body(*stage.jelly, stage.part);
  const runtime::Instance plate{.asset = stage.plate.get(), .to_world = stage.under};
  std::printf("%zu nodes, %zu edges, %.2f kg\n", body.nodes(), body.edges(), body.mass());
  body.drop(kHeight, kTilt);
  double least = body.energy(), rise = 0;
  const double fallen = body.mass() * 9.81 * double(kHeight);
  for (int frame = 1; frame <= 600; ++frame) {
    body.step(kFrame, plate, std::nullopt);
    const double energy = body.energy();
    rise = std::max(rise, (energy - least) / fallen);
    least = std::min(least, energy);
    if (frame % 60 == 0)
      std::printf("%2d s: energy %.4f J, strain %.2f voxels\n", frame / 60, energy, body.strain());
  }
  std::printf("energy rose by %.2f %% of that of the fall; strain at rest %.2f voxels\n", 100 * rise,
              body.strain());
  for (int frame = 0; frame < 30; ++frame) {
    const glm::vec3 above(0, 0.23f - 0.002f * float(frame), 0);
    body.step(kFrame, plate, runtime::Sphere{body.middle() + above, 0.1f});
  }
  std::printf("pushed: strain %.2f voxels", body.strain());
  for (int frame = 0; frame < 180; ++frame) body.step(kFrame, plate, std::nullopt);
  std::printf(", three seconds later %.2f\n", body.strain());
  return 0;
}

static double now() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}
static double median(std::vector<double>& times) {
  std::sort(times.begin(), times.end());
  return times.empty() ? 0 : 1000 * times[times.size() / 2];
}

// The ball with which the mouse pushes: on the line of sight, as far away as the body's middle.
static std::optional<runtime::Sphere> fingerOf(GLFWwindow* window, const glm::mat4& to_clip,
                                               const glm::vec3& eye, const SoftBody& body) {
  if (glfwGetMouseButton(window, GLFW_MOUSE_BUTTON_LEFT) != GLFW_PRESS) return std::nullopt;
  glm::dvec2 at(0);
  glm::ivec2 size(0);
  glfwGetCursorPos(window, &at.x, &at.y);
  glfwGetWindowSize(window, &size.x, &size.y);
  const glm::vec2 on_screen = 2.0f * glm::vec2(at) / glm::vec2(glm::max(size, 1)) - 1.0f;
  const glm::vec4 far = glm::inverse(to_clip) * glm::vec4(on_screen.x, -on_screen.y, 1, 1);
  const glm::vec3 along = glm::normalize(glm::vec3(far) / far.w - eye);
  return runtime::Sphere{eye + glm::dot(body.middle() - eye, along) * along, 0.07f};
}

struct Options {
  int frames = 0, explode = 0;  // frames; 0: never
  const char* picture = nullptr;
};

// Long: set up once, then a frame, top to bottom, as a reader follows it.
static int run(GLFWwindow* window, const Stage& stage, const Options& options) {
  const auto renderer = kelp::gl::Renderer::create(
      {.getProcAddress = [](void*, const char* name) { return (void*)glfwGetProcAddress(name); },
       .log = [](void*, const char* text) { std::fputs(text, stderr); }});
  if (!renderer) return fail("renderer", renderer.error().detail, 4);
  (*renderer)->add(*stage.jelly).value();
  (*renderer)->add(*stage.plate).value();
  (void)(*renderer)->upload(~std::uint64_t{0}).value();
  glEnable(GL_DEPTH_TEST);
  glEnable(GL_FRAMEBUFFER_SRGB);
  glClearColor(0.30f, 0.50f, 0.58f, 1);

  SoftBody body(*stage.jelly, stage.part);
  body.drop(kHeight, kTilt);
  runtime::Pose pose = runtime::Pose::create(*stage.jelly).value();
  const runtime::Instance instances[] = {{.asset = stage.jelly.get(), .pose = &pose},
                                         {.asset = stage.plate.get(), .to_world = stage.under}};
  const runtime::Instances plate(instances[1]);
  std::vector<double> stepping, calling, drawing;  // seconds
  int left_out = 0;                                // frames
  for (int frame = 1; !glfwWindowShouldClose(window) && (options.frames == 0 || frame <= options.frames);
       ++frame) {
    glm::ivec2 pixels(0);
    glfwGetFramebufferSize(window, &pixels.x, &pixels.y);
    const glm::vec2 shape = glm::max(pixels, 1);
    const glm::vec3 eye(0.25f, 0.5f, 1.05f), at(0, 0.15f, 0);
    const kelp::gl::View view{.camera = {glm::lookAt(eye, at, {0, 1, 0}),
                                         glm::perspectiveFov(0.75f, shape.x, shape.y, 0.05f, 10.0f), pixels}};
    const glm::mat4 to_clip = view.camera.eye_to_clip * view.camera.world_to_eye;
    if (glfwGetKey(window, GLFW_KEY_SPACE) == GLFW_PRESS) body.drop(kHeight, kTilt);
    if (frame == options.explode) body.fling(1e12f);

    const double begin = now();
    body.step(kFrame, plate, fingerOf(window, to_clip, eye, body));
    body.write(pose);
    const double stepped = now();
    glViewport(0, 0, pixels.x, pixels.y);
    glClear(GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT);
    glFinish();
    const double cleared = now();
    const kelp::gl::Stats stats = (*renderer)->draw(view, instances).value();
    const double called = now();
    glFinish();
    stepping.push_back(stepped - begin);
    calling.push_back(called - cleared);
    drawing.push_back(now() - called);

    // The solver exploded. kelp leaves the jelly out, draws the plate, and says why once, by `log`. The game
    // begins again after half a second.
    left_out += stats.left_out > 0;
    if (stats.left_out > 0 && left_out % 30 == 0) body.drop(kHeight, kTilt);
    if (frame == options.frames) {
      std::printf("step %.2f ms, draw() with its uploads %.2f ms, until it is drawn %.2f ms (medians)\n",
                  median(stepping), median(calling), median(drawing));
      std::printf("left out of %d frames, energy %.3f J, strain %.2f voxels\n", left_out, body.energy(),
                  body.strain());
      if (const int bad = options.picture ? writePpm("jelly", options.picture, pixels) : 0) return bad;
    }
    glfwSwapBuffers(window);
    glfwPollEvents();
  }
  return 0;
}

int main(int count, char** words) {
  Options options;
  bool good = count >= 3, measures = false;
  for (int i = 3; i < count && good; ++i) {
    const std::string_view word = words[i];
    if (word == "--measure" && count == 4) {
      measures = true;
    } else if (word == "--explode" && i + 1 < count) {
      good = (options.explode = std::atoi(words[++i])) > 0;
    } else if (word == "--frames" && i + 1 < count) {
      good = (options.frames = std::atoi(words[++i])) > 0;
      if (i + 1 < count && words[i + 1][0] != '-') options.picture = words[++i];
    } else {
      good = false;
    }
  }
  if (!good)
    return fail("usage",
                "jelly JELLY.kelp PLATE.kelp [--measure | [--explode FRAME] [--frames N [PICTURE.ppm]]]  "
                "(--measure: without a window)",
                1);
  Stage stage;
  if (const int bad = load(words + 1, stage)) return bad;
  if (measures) return measure(stage);
  if (!glfwInit()) return fail("window", "no display: set DISPLAY, or use xvfb-run", 4);
  glfwWindowHint(GLFW_CONTEXT_VERSION_MAJOR, 3);
  glfwWindowHint(GLFW_CONTEXT_VERSION_MINOR, 3);
  glfwWindowHint(GLFW_OPENGL_PROFILE, GLFW_OPENGL_CORE_PROFILE);
  glfwWindowHint(GLFW_SRGB_CAPABLE, GLFW_TRUE);
  GLFWwindow* const window = glfwCreateWindow(640, 480, "kelp: jelly", nullptr, nullptr);
  if (!window) return fail("window", "no OpenGL 3.3 core context: update the graphics driver", 4);
  glfwMakeContextCurrent(window);
  return run(window, stage, options);
}
