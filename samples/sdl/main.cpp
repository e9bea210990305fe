// SPDX-License-Identifier: MIT
// kelp in a game of SDL2. A click makes a plant red; when the pack's file changes, the new pack takes over.
#include <SDL.h>
#include <SDL_opengl.h>

#include <filesystem>
#include <string_view>
#include <thread>

#include <glm/gtc/matrix_transform.hpp>

#include "../write_ppm.h"
#include "kelp/kelp.hpp"

namespace runtime = kelp::runtime;
constexpr int kPlants = 200;
constexpr glm::ivec2 kSize(960, 720);
const glm::vec3 kEye(0, 6, 12);
const glm::mat4 kToEye = glm::lookAt(kEye, glm::vec3(0, 0.5f, -3), {0, 1, 0});
const glm::mat4 kToClip = glm::perspective(0.8f, 4.0f / 3, 0.5f, 50.0f);

static int say(const char* what, const char* why, int exit_code) {
  return std::fprintf(stderr, "sdl: %s: %s\n", what, why), exit_code;
}

struct Meadow {  // all that belongs to a pack
  kelp::gl::Renderer& renderer;
  std::unique_ptr<runtime::Asset> asset;
  std::vector<runtime::Pose> poses = std::vector<runtime::Pose>(kPlants);
  std::vector<runtime::Instance> instances = {};  // the plants, then what hangs on them
  std::vector<kelp::Material> red = {};           // in place of the pack's palette
  float scale = 1;                                // of a plant
  int tip = -1;                                   // socket
  std::jthread loader = {};                       // ends before the asset does
  ~Meadow() { renderer.remove(*asset); }
};

static std::unique_ptr<Meadow> grow(const char* path, kelp::gl::Renderer& renderer) {
  auto opened = runtime::Asset::open(path);
  const auto added = opened ? renderer.add(**opened) : opened.error();
  if (!added) return say(path, added.error().detail, 0), nullptr;
  std::unique_ptr<Meadow> meadow(new Meadow{renderer, *std::move(opened)});
  runtime::Asset& asset = *meadow->asset;
  const auto tip = findSocket(asset, "tip");
  tip ? meadow->tip = *tip : say(path, tip.error().detail, 0);  // lists the sockets that there are
  meadow->red.assign(asset.pack().palette().size(), {.base_color = {0.9f, 0.1f, 0.05f, 1}});
  const auto [low, high] = bounds(runtime::Instance{&asset});
  meadow->scale = 1 / glm::max(high.x - low.x, high.z - low.z);
  for (int i = 0; i < kPlants; ++i) {
    meadow->poses[i] = runtime::Pose::create(asset).value();
    const glm::mat4 at = glm::translate(glm::mat4(1), glm::vec3(i % 20 - 9.5f, 0, -i / 20));
    meadow->instances.push_back({&asset, &meadow->poses[i], glm::scale(at, glm::vec3(meadow->scale))});
  }
  meadow->loader = std::jthread([&asset, path](const std::stop_token& stop) {
    while (!stop.stop_requested()) {
      const auto more = asset.pump();
      if (!more) say(path, more.error().detail, 0);
      if (more && !*more) SDL_Delay(2);
    }
  });
  return meadow;
}

static void move(Meadow& meadow, double seconds) {
  meadow.instances.resize(kPlants);
  for (int i = 0; i < kPlants; ++i) {
    meadow.poses[i].reset();
    (void)addClip(*meadow.asset, 0, seconds + 0.37 * i, 1, meadow.poses[i]);  // if there is a clip
    if (meadow.tip < 0) continue;
    const glm::mat4 tip = socketToWorld(meadow.instances[i], meadow.tip).value();
    const glm::mat4 at = glm::scale(tip, glm::vec3(0.25f * meadow.scale));
    meadow.instances.push_back({.asset = meadow.asset.get(), .to_world = at, .tint = {1, 4, 9, 1}});
  }
}

static int run(SDL_Window* window, const char* path, int frames, const char* picture) {
  const auto functionOf = [](void*, const char* name) { return SDL_GL_GetProcAddress(name); };
  const auto renderer = kelp::gl::Renderer::create({.getProcAddress = functionOf});
  if (!renderer) return say("renderer", renderer.error().detail, 4);
  std::error_code absent;
  auto written = std::filesystem::last_write_time(path, absent);
  std::unique_ptr<Meadow> meadow = grow(path, **renderer), next;
  if (!meadow) return std::filesystem::exists(path) ? 3 : 2;
  for (int frame = 0;;) {
    const auto time = std::filesystem::last_write_time(path, absent);
    if (!absent && std::exchange(written, time) != time) next = grow(path, **renderer);
    const bool complete = (*renderer)->upload(4 << 20).value().pending == 0;  // the rest of next is, too
    if (next && complete && next->asset->residentLevel(0))
      meadow = std::move(next), say(path, "the new pack is shown", 0);
    for (SDL_Event event; SDL_PollEvent(&event);) {
      if (event.type == SDL_QUIT) return 0;
      if (event.type != SDL_MOUSEBUTTONDOWN) continue;
      const glm::vec3 at(event.button.x, kSize.y - event.button.y, 1);
      const glm::vec3 ray = glm::unProject(at, kToEye, kToClip, glm::ivec4(0, 0, kSize)) - kEye;
      const auto hit = raycast(std::span(meadow->instances).first(kPlants), {kEye, ray});
      if (hit) meadow->instances[hit->instance].palette = meadow->red;
    }
    move(*meadow, 0.001 * SDL_GetTicks());
    glClearColor(0.58f, 0.74f, 0.78f, 1);
    glClear(GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT);
    const kelp::gl::View view{.camera = {kToEye, kToClip, kSize}, .output = kelp::gl::Output::kDisplay};
    (*renderer)->draw(view, meadow->instances).value();  // kDisplay: the window encodes nothing
    if (complete && ++frame == frames) return picture ? writePpm("sdl", picture, kSize) : 0;
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
