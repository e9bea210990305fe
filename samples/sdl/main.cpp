// SPDX-License-Identifier: MIT
// kelp in a game loop of SDL2: 200 plants, each with a pose of its own. A click turns a plant red and hangs a
// small one on its socket "tip". If the pack is baked again meanwhile, the new one takes the old one's place.
#include <SDL.h>
#include <SDL_opengl.h>

#include <filesystem>
#include <string_view>
#include <thread>

#include <glm/gtc/matrix_transform.hpp>

#include "../write_ppm.h"
#include "kelp/kelp.h"

namespace runtime = kelp::runtime;
constexpr int kPlants = 200;
constexpr glm::ivec2 kSize(960, 720);

static int say(const char* what, const char* why, int exit_code = 0) {
  return std::fprintf(stderr, "sdl: %s: %s\n", what, why), exit_code;
}

struct Meadow {
  std::unique_ptr<runtime::Asset> asset;
  std::vector<runtime::Pose> poses;
  std::vector<runtime::Instance> instances;  // the plants; then, what hangs on them
  int tip = -1;                              // socket
  glm::vec3 size{0};                         // of a plant
  std::jthread loader;                       // ends before the asset does
};

// Null: the pack cannot be used; the reason has been said.
static std::unique_ptr<Meadow> grow(const char* path, kelp::gl::Renderer& renderer) {
  auto opened = runtime::Asset::open(path);
  if (!opened) return say(path, opened.error().detail), nullptr;
  auto meadow = std::make_unique<Meadow>();
  runtime::Asset& asset = *(meadow->asset = *std::move(opened));
  renderer.add(asset).value();
  const auto tip = findSocket(asset, "tip");
  tip ? meadow->tip = *tip : say(path, tip.error().detail);
  const kelp::Box box = bounds(runtime::Instance{&asset});
  meadow->size = box.max - box.min;
  const float apart = 1.1f * glm::max(meadow->size.x, meadow->size.z);
  for (int i = 0; i < kPlants; ++i) meadow->poses.push_back(runtime::Pose::create(asset).value());
  for (int i = 0; i < kPlants; ++i) {
    const glm::mat4 at = glm::translate(glm::mat4(1), apart * glm::vec3(i % 20 - 10, 0, -i / 20));
    meadow->instances.push_back({&asset, &meadow->poses[i], glm::rotate(at, 2.4f * i, {0, 1, 0})});
  }
  meadow->loader = std::jthread([&asset](const std::stop_token& stop) {
    while (!stop.stop_requested())
      if (const auto more = asset.pump(); !more || !*more) SDL_Delay(2);
  });
  return meadow;
}

static void animate(Meadow& meadow, double seconds) {
  meadow.instances.resize(kPlants);
  for (int i = 0; i < kPlants; ++i) {
    meadow.poses[i].reset();
    (void)addClip(*meadow.asset, 0, seconds + 0.37 * i, 1, meadow.poses[i]);
    if (meadow.instances[i].tint.r == 1 || meadow.tip < 0) continue;
    const glm::mat4 tip = socketToWorld(meadow.instances[i], meadow.tip);
    meadow.instances.push_back({meadow.asset.get(), nullptr, glm::scale(tip, glm::vec3(0.3f)), {1, 4, 9, 1}});
  }
}

static int run(SDL_Window* window, const char* path, int frames, const char* picture) {
  const auto functionOf = [](void*, const char* name) { return SDL_GL_GetProcAddress(name); };
  const auto renderer = kelp::gl::Renderer::create({.getProcAddress = functionOf}).value();
  std::unique_ptr<Meadow> now = grow(path, *renderer), next;
  if (!now) return std::filesystem::exists(path) ? 3 : 2;
  std::error_code absent;
  auto written = std::filesystem::last_write_time(path, absent);
  for (int frame = 0;;) {
    const auto time = std::filesystem::last_write_time(path, absent);
    if (!absent && !next && std::exchange(written, time) != time) next = grow(path, *renderer);
    const auto sent = renderer->upload(4 << 20).value();
    if (next && sent.pending == 0) {  // coarse voxels are there, so no frame is without plants
      renderer->remove(*now->asset);
      now = std::move(next);
      say(path, "the new pack is shown");
    }
    const float far = 10 * glm::max(now->size.x, now->size.z) + now->size.y;
    const glm::vec3 eye = far * glm::vec3(0, 0.35f, 0.9f);
    const glm::mat4 to_eye = glm::lookAt(eye, far * glm::vec3(0, 0.02f, -0.3f), {0, 1, 0});
    const glm::mat4 to_clip = glm::perspective(0.9f, 4.0f / 3, 0.02f * far, 9 * far);
    for (SDL_Event event; SDL_PollEvent(&event);) {
      if (event.type == SDL_QUIT) return 0;
      if (event.type != SDL_MOUSEBUTTONDOWN) continue;
      const glm::vec2 at(event.button.x / 480.0f - 1, 1 - event.button.y / 360.0f);
      const glm::vec4 end = glm::inverse(to_clip * to_eye) * glm::vec4(at, 1, 1);
      const auto hit = raycast(now->instances, {eye, glm::vec3(end / end.w) - eye});
      if (hit) now->instances[hit->instance].tint = {4, 0.1f, 0.1f, 1};
    }
    animate(*now, 0.001 * static_cast<double>(SDL_GetTicks64()));
    glClearColor(0.58f, 0.74f, 0.78f, 1);
    glClear(GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT);
    kelp::gl::View view;
    view.camera = {to_eye, to_clip, kSize};
    view.output = kelp::gl::Output::kDisplay;  // the window encodes nothing
    renderer->draw(view, now->instances).value();
    if (sent.pending == 0 && ++frame == frames) return picture ? writePpm("sdl", picture, kSize) : 0;
    SDL_GL_SwapWindow(window);
  }
}

int main(int count, char** words) {
  const int frames = count > 3 && std::string_view(words[2]) == "--frames" ? std::atoi(words[3]) : 0;
  if (count != 2 && (frames <= 0 || count > 5))
    return say("usage", "sdl PACK.kelp [--frames N [PICTURE.ppm]]", 1);
  if (SDL_Init(SDL_INIT_VIDEO) != 0) return say("window", SDL_GetError(), 4);
  SDL_GL_SetAttribute(SDL_GL_CONTEXT_PROFILE_MASK, SDL_GL_CONTEXT_PROFILE_CORE);
  SDL_GL_SetAttribute(SDL_GL_CONTEXT_MAJOR_VERSION, 3);
  SDL_GL_SetAttribute(SDL_GL_CONTEXT_MINOR_VERSION, 3);
  SDL_Window* const window = SDL_CreateWindow("kelp: sdl", 0, 0, kSize.x, kSize.y, SDL_WINDOW_OPENGL);
  if (!window || !SDL_GL_CreateContext(window)) return say("window", SDL_GetError(), 4);
  return run(window, words[1], frames, count == 5 ? words[4] : nullptr);
}
