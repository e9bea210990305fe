// SPDX-License-Identifier: MIT
// kelp in a game of SDL2. A click makes a plant red; when the pack's file changes, the new pack takes over.
#include <SDL.h>
#include <SDL_opengl.h>

#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <memory>
#include <string_view>
#include <thread>
#include <vector>

#include <glm/gtc/matrix_transform.hpp>

#include "../write_ppm.h"
#include "kelp/kelp.hpp"

namespace fs = std::filesystem;
namespace runtime = kelp::runtime;

constexpr int kPlants = 200;
constexpr glm::ivec2 kSize(960, 720);
const glm::vec3 kEye(0, 6, 12);
const glm::mat4 kToEye = glm::lookAt(kEye, glm::vec3(0, 0.5f, -3), {0, 1, 0});
const glm::mat4 kToClip = glm::perspective(0.8f, 4.0f / 3, 0.5f, 50.0f);

static void say(const char* what, const char* text) { std::fprintf(stderr, "sdl: %s: %s\n", what, text); }

static int fail(const char* what, const char* why, int exit_code) {
  say(what, why);
  return exit_code;
}

// All that belongs to a pack.
struct Meadow {
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

// Reads the voxels that the renderer asks for.
static void load(const std::stop_token& stop, runtime::Asset& asset, const char* path) {
  while (!stop.stop_requested()) {
    const kelp::Result<bool> more = asset.pump();
    if (!more) {
      say(path, more.error().detail);
      continue;
    }
    if (!*more) SDL_Delay(2);
  }
}

// Null, with a line on stderr, if the pack cannot be used.
static std::unique_ptr<Meadow> grow(const char* path, kelp::gl::Renderer& renderer) {
  auto opened = runtime::Asset::open(path);
  if (!opened) {
    say(path, opened.error().detail);
    return nullptr;
  }
  if (const auto added = renderer.add(**opened); !added) {
    say(path, added.error().detail);
    return nullptr;
  }
  std::unique_ptr<Meadow> meadow(new Meadow{renderer, *std::move(opened)});
  runtime::Asset& asset = *meadow->asset;

  if (const auto tip = findSocket(asset, "tip"))
    meadow->tip = *tip;
  else
    say(path, tip.error().detail);  // lists the sockets that there are
  meadow->red.assign(asset.pack().palette().size(), {.base_color = {0.9f, 0.1f, 0.05f, 1}});
  const auto [low, high] = bounds(runtime::Instance{&asset});
  meadow->scale = 1 / glm::max(high.x - low.x, high.z - low.z);
  for (int i = 0; i < kPlants; ++i) {
    meadow->poses[i] = runtime::Pose::create(asset).value();
    const glm::mat4 at = glm::translate(glm::mat4(1), glm::vec3(i % 20 - 9.5f, 0, -i / 20));
    meadow->instances.push_back(
        {.asset = &asset, .pose = &meadow->poses[i], .to_world = glm::scale(at, glm::vec3(meadow->scale))});
  }
  meadow->loader = std::jthread([&asset, path](const std::stop_token& stop) { load(stop, asset, path); });
  return meadow;
}

// Poses the plants, and hangs a small copy on each one's tip.
static void move(Meadow& meadow, double seconds) {
  const bool has_clip = !meadow.asset->pack().clips().empty();
  meadow.instances.resize(kPlants);
  for (int i = 0; i < kPlants; ++i) {
    runtime::Pose& pose = meadow.poses[i];
    pose.reset();
    if (has_clip) addClip(*meadow.asset, 0, seconds + 0.37 * i, 1, pose).value();
    if (meadow.tip < 0) continue;
    const glm::mat4 tip = socketToWorld(meadow.instances[i], meadow.tip).value();
    const glm::mat4 at = glm::scale(tip, glm::vec3(0.25f * meadow.scale));
    meadow.instances.push_back({.asset = meadow.asset.get(), .to_world = at, .tint = {1, 4, 9, 1}});
  }
}

// Makes the plant under the pixel red.
static void click(Meadow& meadow, int x, int y) {
  const glm::vec3 at(x, kSize.y - y, 1);
  const glm::vec3 ray = glm::unProject(at, kToEye, kToClip, glm::ivec4(0, 0, kSize)) - kEye;
  const auto hit = raycast(std::span(meadow.instances).first(kPlants), {kEye, ray});
  if (hit) meadow.instances[hit->instance].palette = meadow.red;
}

// False: the game ends.
static bool handleEvents(Meadow& meadow) {
  for (SDL_Event event; SDL_PollEvent(&event);) {
    if (event.type == SDL_QUIT) return false;
    if (event.type == SDL_MOUSEBUTTONDOWN) click(meadow, event.button.x, event.button.y);
  }
  return true;
}

static void draw(kelp::gl::Renderer& renderer, const Meadow& meadow) {
  glClearColor(0.58f, 0.74f, 0.78f, 1);
  glClear(GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT);
  // kDisplay: the window encodes nothing.
  const kelp::gl::View view{.camera = {kToEye, kToClip, kSize}, .output = kelp::gl::Output::kDisplay};
  renderer.draw(view, meadow.instances).value();
}

// The time of the last change of a file.
class Watched {
 public:
  explicit Watched(const char* path) : path_(path), written_(fs::last_write_time(path, absent_)) {}

  bool hasChanged() {
    const auto time = fs::last_write_time(path_, absent_);
    if (absent_ || time == written_) return false;
    written_ = time;
    return true;
  }

 private:
  const char* path_;
  std::error_code absent_;
  fs::file_time_type written_;
};

static int run(SDL_Window* window, const char* path, int frames, const char* picture) {
  const auto functionOf = [](void*, const char* name) { return SDL_GL_GetProcAddress(name); };
  const auto created = kelp::gl::Renderer::create({.getProcAddress = functionOf});
  if (!created) return fail("renderer", created.error().detail, 4);
  kelp::gl::Renderer& renderer = **created;
  Watched file(path);
  std::unique_ptr<Meadow> meadow = grow(path, renderer);
  if (!meadow) return fs::exists(path) ? 3 : 2;

  std::unique_ptr<Meadow> next;  // takes over when its voxels are there
  int frame = 0;
  while (handleEvents(*meadow)) {
    if (file.hasChanged()) next = grow(path, renderer);
    const bool complete = renderer.upload(4 << 20).value().pending == 0;  // the voxels of both
    if (next && complete && next->asset->residentLevel(0)) {
      meadow = std::move(next);
      say(path, "the new pack is shown");
    }
    move(*meadow, 0.001 * SDL_GetTicks());
    draw(renderer, *meadow);
    if (complete && ++frame == frames) return picture ? writePpm("sdl", picture, kSize) : 0;
    SDL_GL_SwapWindow(window);
  }
  return 0;
}

int main(int count, char** words) {
  const int frames = count > 3 && std::string_view(words[2]) == "--frames" ? std::atoi(words[3]) : 0;
  if (count != 2 && (frames <= 0 || count > 5))
    return fail("usage", "sdl PACK.kelp [--frames N [PICTURE.ppm]]", 1);
  if (SDL_Init(SDL_INIT_VIDEO) != 0) return fail("window", SDL_GetError(), 4);
  SDL_GL_SetAttribute(SDL_GL_CONTEXT_PROFILE_MASK, SDL_GL_CONTEXT_PROFILE_CORE);
  SDL_GL_SetAttribute(SDL_GL_CONTEXT_MAJOR_VERSION, 3);
  SDL_GL_SetAttribute(SDL_GL_CONTEXT_MINOR_VERSION, 3);
  SDL_Window* const window = SDL_CreateWindow("kelp: sdl", 0, 0, kSize.x, kSize.y, SDL_WINDOW_OPENGL);
  if (!window || !SDL_GL_CreateContext(window)) return fail("window", SDL_GetError(), 4);
  return run(window, words[1], frames, count == 5 ? words[4] : nullptr);
}
