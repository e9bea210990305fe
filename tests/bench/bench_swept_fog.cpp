// SPDX-License-Identifier: MIT
// Swept fog beside the same fog sheared, in poses that both can make, and swept alone where it curls: the
// processor's time for a frame, all threads together, drawn in turns.
#define GL_GLEXT_PROTOTYPES
#include <GL/glcorearb.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <fstream>
#include <iterator>
#include <memory>
#include <string>
#include <vector>

#include <glm/gtc/matrix_transform.hpp>

#include "kelp/gl/renderer.h"
#include "kelp/runtime/pose.h"
#include "reference/sweep_trials.h"
#include "support/egl_context.h"
#include "support/fog_pack.h"

namespace {

using namespace kelp;
using namespace kelp::test;

constexpr glm::ivec2 kPicture(320, 240);

[[noreturn]] void stop(const std::string& what) {
  std::fprintf(stderr, "bench_swept_fog: %s\n", what.c_str());
  std::exit(1);
}

// The pack with another rig, on the GPU.
class Bent {
 public:
  Bent(std::span<const std::byte> pack, const reference::SweepRig& rig, Bend bend) {
    const MemorySource from(pack);
    const Sink sink{[](void* user, std::span<const std::byte> more) {
                      auto& all = *static_cast<std::vector<std::byte>*>(user);
                      all.insert(all.end(), more.begin(), more.end());
                      return true;
                    },
                    &bytes_};
    RawRig rest{rig.knots};
    rest.bend = bend;
    rest.roll = bend == Bend::kSweep ? rig.roll : 0;
    if (const auto written = writeRigs(from.source(), {"", {rest}, {}, {}}, sink); !written)
      stop(rig.name + ": " + written.error().detail);
    memory_ = std::make_unique<MemorySource>(bytes_);
    auto opened = runtime::Asset::open(memory_->source());
    if (!opened || !(*opened)->loadAll()) stop("the pack cannot be read");
    asset_ = *std::move(opened);
    gl::Config config;
    config.getProcAddress = [](void*, const char* name) {
      return reinterpret_cast<void*>(eglGetProcAddress(name));
    };
    config.gpu_budget = gl::poolBytes(*asset_) + (std::uint64_t{8} << 20);
    config.secondary_rays = true;
    auto renderer = gl::Renderer::create(config);
    if (!renderer || !(*renderer)->add(*asset_) || !(*renderer)->upload(~std::uint64_t{0}))
      stop("the renderer does not take the pack");
    renderer_ = *std::move(renderer);
  }

  gl::View view() const {
    const Box box = runtime::bounds(instance());
    const glm::vec3 middle = 0.5f * (box.min + box.max);
    const float reach = glm::length(box.max - box.min);
    gl::View view;
    view.camera.viewport = kPicture;
    view.camera.world_to_eye =
        glm::lookAt(middle + 0.85f * reach * glm::vec3(0.35f, 0.2f, 0.9f), middle, glm::vec3(0, 1, 0));
    view.camera.eye_to_clip = glm::perspective(
        0.9f, static_cast<float>(kPicture.x) / static_cast<float>(kPicture.y), 0.01f * reach, 3 * reach);
    view.quality.pixels_per_voxel = 0;
    return view;
  }
  // Milliseconds of all processors.
  double draw(const gl::View& view) const {
    const runtime::Instance one = instance();
    glClear(GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT);
    glFinish();
    const double start = now();
    if (!renderer_->draw(view, {&one, 1}, gl::Pass::kFog)) stop("kelp does not draw");
    glFinish();
    return now() - start;
  }

 private:
  runtime::Instance instance() const { return {asset_.get(), nullptr}; }
  static double now() {
    timespec time{};
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &time);
    return 1e3 * static_cast<double>(time.tv_sec) + 1e-6 * static_cast<double>(time.tv_nsec);
  }

  std::vector<std::byte> bytes_;
  std::unique_ptr<MemorySource> memory_;
  std::unique_ptr<runtime::Asset> asset_;
  std::unique_ptr<gl::Renderer> renderer_;
};

int covered() {
  std::vector<glm::vec4> pixels(static_cast<std::size_t>(kPicture.x * kPicture.y));
  glReadPixels(0, 0, kPicture.x, kPicture.y, GL_RGBA, GL_FLOAT, pixels.data());
  return static_cast<int>(
      std::count_if(pixels.begin(), pixels.end(), [](const glm::vec4& p) { return p.a > 0; }));
}

void run(std::span<const std::byte> pack, int frames, bool shadows, const std::string& only) {
  const EglContext context(GlApi::kDesktop33);
  if (!context) stop("no OpenGL 3.3 here");
  GLuint framebuffer, buffers[2];
  glGenFramebuffers(1, &framebuffer);
  glGenRenderbuffers(2, buffers);
  glBindFramebuffer(GL_FRAMEBUFFER, framebuffer);
  const GLenum formats[2] = {GL_RGBA32F, GL_DEPTH_COMPONENT24},
               places[2] = {GL_COLOR_ATTACHMENT0, GL_DEPTH_ATTACHMENT};
  for (int i = 0; i < 2; ++i) {
    glBindRenderbuffer(GL_RENDERBUFFER, buffers[i]);
    glRenderbufferStorage(GL_RENDERBUFFER, formats[i], kPicture.x, kPicture.y);
    glFramebufferRenderbuffer(GL_FRAMEBUFFER, places[i], GL_RENDERBUFFER, buffers[i]);
  }
  glViewport(0, 0, kPicture.x, kPicture.y);

  const MemorySource source(pack);
  const auto opened = Pack::open(source.source());
  if (!opened || opened->parts().size() != 1 || opened->parts()[0].kind != PartKind::kFog)
    stop("not a pack of one fog part");
  const glm::ivec3 size = opened->parts()[0].size;
  std::printf("%d x %d x %d, %d x %d, %s\n", size.x, size.y, size.z, kPicture.x, kPicture.y,
              reinterpret_cast<const char*>(glGetString(GL_RENDERER)));
  for (const reference::SweepRig& rig : reference::namedSweeps(size)) {
    if (!checkSweep(rig.knots, size, rig.roll) || rig.name.find(only) == std::string::npos) continue;
    const bool both = checkKnots(rig.knots) && rig.roll == 0;
    std::vector<std::unique_ptr<Bent>> bents;
    bents.push_back(std::make_unique<Bent>(pack, rig, Bend::kSweep));
    if (both) bents.push_back(std::make_unique<Bent>(pack, rig, Bend::kShear));
    for (const bool shadow : {false, true}) {
      if (shadow && !shadows) continue;
      std::vector<double> times[2];
      double median[2] = {}, share[2] = {};
      for (int frame = 0; frame < frames; ++frame) {
        for (std::size_t i = 0; i < bents.size(); ++i) {
          gl::View view = bents[i]->view();
          view.quality.self_shadow = shadow;
          times[i].push_back(bents[i]->draw(view));
          share[i] = covered();
        }
      }
      for (std::size_t i = 0; i < bents.size(); ++i) {
        std::nth_element(times[i].begin(), times[i].begin() + frames / 2, times[i].end());
        median[i] = times[i][static_cast<std::size_t>(frames / 2)];
      }
      std::printf("%-12s %-10s swept %8.1f ms, %5.2f us a covered pixel", rig.name.c_str(),
                  shadow ? "shadow" : "no shadow", median[0], 1e3 * median[0] / share[0]);
      if (both)
        std::printf("; sheared %8.1f ms, %5.2f us: %.2fx a pixel", median[1], 1e3 * median[1] / share[1],
                    median[0] / share[0] / (median[1] / share[1]));
      std::printf("\n");
    }
  }
}

}  // namespace

int main(int argc, char** argv) {
  std::vector<std::byte> pack;
  int frames = 5;
  bool shadows = false;
  std::string pose;
  for (int i = 1; i < argc; ++i) {
    const std::string argument = argv[i];
    if (argument == "--frames" && i + 1 < argc) {
      frames = std::max(1, std::atoi(argv[++i]));
    } else if (argument == "--pose" && i + 1 < argc) {
      pose = argv[++i];
    } else if (argument == "--shadows") {
      shadows = true;
    } else if (argument == "--help" || argument[0] == '-') {
      std::puts(
          "bench_swept_fog [PACK] [--frames N] [--pose NAME] [--shadows]: the fog of PACK, or puffs, swept "
          "and sheared");
      return argument == "--help" ? 0 : 1;
    } else {
      std::ifstream file(argument, std::ios::binary);
      const std::string text{std::istreambuf_iterator<char>(file), {}};
      const auto bytes = std::as_bytes(std::span(text));
      pack.assign(bytes.begin(), bytes.end());
    }
  }
  if (pack.empty()) pack = bytesOf(fogPack(fogOf({64, 160, 64}, puffs), 0.08f));
  run(pack, frames, shadows, pose);
}
