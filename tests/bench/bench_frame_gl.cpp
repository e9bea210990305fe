// SPDX-License-Identifier: MIT
#include "bench_frame_gl.h"

#define GL_GLEXT_PROTOTYPES
#include <GL/glcorearb.h>

#include <algorithm>
#include <chrono>
#include <cmath>

#include <glm/gtc/matrix_transform.hpp>

#include "bench_frame_foxes.h"
#include "bench_frame_scene.h"
#include "support/egl_context.h"

namespace kelp::bench {
namespace {

// RGBA8 and 24 bits of depth, bound while it lives.
class Target {
 public:
  explicit Target(const glm::ivec2& size) : size_(size) {
    glGenFramebuffers(1, &framebuffer_);
    glBindFramebuffer(GL_FRAMEBUFFER, framebuffer_);
    glGenRenderbuffers(2, buffers_);
    const GLenum formats[2] = {GL_RGBA8, GL_DEPTH_COMPONENT24},
                 places[2] = {GL_COLOR_ATTACHMENT0, GL_DEPTH_ATTACHMENT};
    for (int i = 0; i < 2; ++i) {
      glBindRenderbuffer(GL_RENDERBUFFER, buffers_[i]);
      glRenderbufferStorage(GL_RENDERBUFFER, formats[i], size.x, size.y);
      glFramebufferRenderbuffer(GL_FRAMEBUFFER, places[i], GL_RENDERBUFFER, buffers_[i]);
    }
    glViewport(0, 0, size.x, size.y);
  }
  ~Target() {
    glDeleteFramebuffers(1, &framebuffer_);
    glDeleteRenderbuffers(2, buffers_);
  }
  Target(const Target&) = delete;
  Target& operator=(const Target&) = delete;

  static void clear() { glClear(GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT); }
  // Pixels that something was drawn to.
  int covered() const {
    std::vector<std::uint8_t> pixels(static_cast<std::size_t>(4 * size_.x * size_.y));
    glReadPixels(0, 0, size_.x, size_.y, GL_RGBA, GL_UNSIGNED_BYTE, pixels.data());
    int count = 0;
    for (std::size_t i = 3; i < pixels.size(); i += 4) count += pixels[i] != 0;
    return count;
  }

 private:
  glm::ivec2 size_;
  GLuint framebuffer_ = 0, buffers_[2] = {};
};

struct Frame {
  std::string name;
  const Crowd* crowd;
  int batches;
  gl::Stats stats{};
  int covered = 0;
  std::vector<double> ms{};
};

void measure(gl::Renderer& renderer, const Target& target, const glm::ivec2& size, std::vector<Frame>& frames,
             int rounds) {
  for (int round = -1; round < rounds; ++round) {
    for (Frame& frame : frames) {
      Target::clear();
      glFinish();
      const auto start = std::chrono::steady_clock::now();
      const auto stats = renderer.draw(viewOf(size, frame.batches), frame.crowd->instances);
      glFinish();
      const double ms =
          std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();
      (void)renderer.upload(~std::uint64_t{0});
      if (!stats) {
        std::fprintf(stderr, "bench_frame: %s\n", stats.error().detail);
        return;
      }
      if (round < 0) {
        frame.stats = *stats;
        frame.covered = target.covered();
      } else {
        frame.ms.push_back(ms);
      }
    }
  }
}

// Half of the height of the view at the distance of the plane z.
float halfHeight(float z) { return (10 - z) * std::tan(0.4f); }

}  // namespace

gl::View viewOf(const glm::ivec2& size, int batches) {
  gl::View view;
  view.camera.viewport = size;
  view.camera.eye_to_clip =
      glm::perspective(0.8f, static_cast<float>(size.x) / static_cast<float>(size.y), 0.1f, 200.0f);
  view.camera.world_to_eye = glm::lookAt(glm::vec3(0, 0, 10), glm::vec3(0), glm::vec3(0, 1, 0));
  view.quality.depth_batches = batches;
  return view;
}

void tile(Crowd& crowd, std::size_t from, std::size_t count, int columns, int rows, float z) {
  const float height = 2 * halfHeight(z) / static_cast<float>(rows),
              width = 2 * halfHeight(z) * 4.0f / 3.0f / static_cast<float>(columns);
  for (std::size_t i = 0; i < count; ++i) {
    const int x = static_cast<int>(i) % columns, y = static_cast<int>(i) / columns % rows;
    const glm::vec3 at((static_cast<float>(x) + 0.5f) * width - 0.5f * width * static_cast<float>(columns),
                       static_cast<float>(y) * height - halfHeight(z), z);
    crowd.instances[from + i].to_world =
        glm::scale(glm::translate(glm::mat4(1), at), glm::vec3(std::min(height, width)));
  }
}

namespace {

// In a heap around the origin, each before and behind others.
void heap(Crowd& crowd, float depth, float scale) {
  const std::size_t count = crowd.instances.size();
  for (std::size_t i = 0; i < count; ++i) {
    const float turn = 2.4f * static_cast<float>(i),
                out = std::sqrt((static_cast<float>(i) + 0.5f) / static_cast<float>(count));
    const float z = depth * (static_cast<float>(i * 7 % count) / static_cast<float>(count) - 0.5f);
    glm::mat4 m = glm::translate(
        glm::mat4(1), glm::vec3(2.0f * out * std::cos(turn), 2.0f * out * std::sin(turn) - 0.5f * scale, z));
    m = glm::rotate(m, turn, glm::vec3(0, 1, 0));
    crowd.instances[i].to_world = glm::scale(m, glm::vec3(scale));
  }
}

void print(Report& out, const char* title, const std::vector<Frame>& frames) {
  std::printf(
      "\n%s\n\n| | draws | parts drawn | culled | pixels covered | ms | ratio | ratio for each covered pixel "
      "|\n|---|---|---|---|---|---|---|---|\n",
      title);
  for (const Frame& frame : frames) {
    const double ratio = median(frame.ms) / median(frames[0].ms);
    std::printf("| %s | %u | %u | %u | %d | %.1f | %.2f | %.2f |\n", frame.name.c_str(), frame.stats.draws,
                frame.stats.instances, frame.stats.culled, frame.covered, median(frame.ms), ratio,
                ratio * frames[0].covered / std::max(frame.covered, 1));
    out.add(std::string("gl, ") + title + ", " + frame.name, ratio);
  }
}

void reportHeaps(Report& out, gl::Renderer& renderer, const Library& library, const Target& target,
                 const glm::ivec2& size, int rounds) {
  for (const std::size_t count : {std::size_t{48}, std::size_t{2000}}) {
    Crowd crowd(library, count);
    heap(crowd, count > 100 ? 8.0f : 4.0f, count > 100 ? 0.4f : 3.0f);
    std::vector<Frame> frames;
    for (const int batches : {1, 2, 4, 8, 12, 16})
      frames.push_back({std::to_string(batches) + " batches", &crowd, batches});
    measure(renderer, target, size, frames, rounds);
    print(out, count > 100 ? "2,000 instances in a heap" : "48 instances in a heap", frames);
  }
}

// Of 20 and of 2,000 instances on the same pixels: side by side, and 20 with the other 1,980 behind them.
void reportSmall(Report& out, gl::Renderer& renderer, const Library& library, const Target& target,
                 const glm::ivec2& size, int rounds) {
  Crowd twenty(library, 20), small(library, 2000), behind(library, 2000);
  tile(twenty, 0, 20, 5, 4, 0);
  tile(small, 0, 2000, 50, 40, 0);
  tile(behind, 0, 20, 5, 4, 0);
  for (std::size_t i = 20; i < 2000; ++i) {
    behind.instances[i] = behind.instances[i % 20];
    behind.instances[i].to_world[3].z -= 0.02f * static_cast<float>(i / 20);
    // No farther from the middle on the picture than the one before it.
    const float farther = (10 - behind.instances[i].to_world[3].z) / 10;
    for (int axis = 0; axis < 2; ++axis) behind.instances[i].to_world[3][axis] *= farther;
  }
  std::vector<Frame> frames;
  frames.push_back({"20", &twenty, 1});
  frames.push_back({"2,000 small ones side by side", &small, 1});
  for (const int batches : {1, 8, 16})
    frames.push_back({"20 and 1,980 behind them, " + std::to_string(batches) + " batches", &behind, batches});
  measure(renderer, target, size, frames, rounds);
  print(out, "2,000 instances on the pixels of 20", frames);
}

void reportFoxes(Report& out, gl::Renderer& renderer, const Foxes& foxes, const Target& target,
                 const glm::ivec2& size, int rounds) {
  for (const Library* library : {&foxes.still, &foxes.playing}) (void)renderer.add((*library)[0]);
  (void)renderer.upload(~std::uint64_t{0});
  Crowd still(foxes.still, Foxes::kCount), playing(foxes.playing, Foxes::kCount, foxes.run);
  foxes.place(still);
  foxes.place(playing);
  Crowd resting(foxes.playing, Foxes::kCount, foxes.run);
  foxes.place(resting);
  for (runtime::Instance& instance : resting.instances) instance.pose = nullptr;
  std::vector<Frame> frames;
  frames.push_back({"still, one part each", &still, 1});
  frames.push_back({"the parts of the skin, still", &resting, 1});
  for (const int batches : {1, 4})
    frames.push_back({"running, " + std::to_string(batches) + " batches", &playing, batches});
  measure(renderer, target, size, frames, rounds);
  print(out, "100 foxes side by side", frames);
}

}  // namespace

void reportGl(Report& out, const Foxes* foxes, bool foxes_only, const glm::ivec2& size, int rounds) {
  const test::EglContext context(test::GlApi::kDesktop33);
  if (!context) {
    std::printf("\nNo OpenGL 3.3 by EGL here: frames are not measured.\n");
    return;
  }
  std::printf("\n%s, %d x %d\n", reinterpret_cast<const char*>(glGetString(GL_RENDERER)), size.x, size.y);
  const Target target(size);
  const Library library(1);
  gl::RendererOptions config;
  config.getProcAddress = test::EglContext::getProcAddress;
  const auto renderer = gl::Renderer::create(config);
  if (!renderer) {
    std::fprintf(stderr, "bench_frame: %s\n", renderer.error().detail);
    return;
  }
  if (!foxes_only) {
    for (std::size_t i = 0; i < library.size(); ++i) (void)(*renderer)->add(library[i]);
    (void)(*renderer)->upload(~std::uint64_t{0});
    reportHeaps(out, **renderer, library, target, size, rounds);
    reportSmall(out, **renderer, library, target, size, rounds);
  }
  if (foxes) reportFoxes(out, **renderer, *foxes, target, size, rounds);
}

}  // namespace kelp::bench
