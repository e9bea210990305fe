// SPDX-License-Identifier: MIT
// Occlusion and soft shadows from distances beside eight cast rays: how long a frame takes longer, and how
// far from 256 rays in double precision the light is. README.md here.
#include <chrono>
#include <cstdio>
#include <fstream>
#include <iterator>
#include <string>

#include <glm/gtc/matrix_transform.hpp>

#include "canvas.h"
#include "kelp/formats/raw_level.h"
#include "kelp/runtime/pose.h"
#include "light_truth.h"
#include "support/poses.h"

namespace {

using namespace kelp;
using namespace kelp::test;

constexpr glm::ivec2 kViewport(480, 400);
constexpr int kFrames = 15, kPixels = 6000;

[[noreturn]] void fail(const std::string& what) {
  std::fprintf(stderr, "bench_shading: %s\n", what.c_str());
  std::exit(1);
}

template <class T>
T expect(Result<T> result, const char* what) {
  if (!result) fail(std::string(what) + ": " + result.error().detail);
  return *std::move(result);
}

fields::Occupancy voxelsOf(const Pack& pack) {
  const RawLevel raw = expect(readRawLevel(pack, 0, 0), "a level");
  return fields::occupancyOf(raw, pack.parts()[0].size);
}

std::unique_ptr<gl::Renderer> rendererOf(const runtime::Asset& asset, const char* surface) {
  gl::Config config;
  config.getProcAddress = EglContext::getProcAddress;
  config.surface_glsl = surface;
  config.distances = true;
  config.log = [](void*, const char* text) { std::fputs(text, stderr); };
  auto renderer = expect(gl::Renderer::create(config), "a renderer");
  if (!renderer->add(asset) || !renderer->upload(~std::uint64_t{0})) fail("the pack does not fit");
  return renderer;
}

// One picture and the least time of several.
struct Drawn {
  std::vector<Pixel> pixels;
  double seconds = 1e9;
};
Drawn draw(gl::Renderer& renderer, const Canvas& canvas, const gl::View& view,
           const runtime::Instance& instance) {
  Drawn drawn;
  for (int i = 0; i < kFrames; ++i) {
    canvas.clear();
    glFinish();
    const auto start = std::chrono::steady_clock::now();
    if (!renderer.draw(view, {&instance, 1})) fail("it cannot be drawn");
    glFinish();
    drawn.seconds = std::min(drawn.seconds,
                             std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count());
  }
  drawn.pixels = canvas.pixels();
  return drawn;
}

void measure(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  const std::string text(std::istreambuf_iterator<char>(file), {});
  if (text.empty()) fail(path + ": cannot be read");
  const MemorySource memory(std::as_bytes(std::span(text)));
  runtime::Options options;
  options.distance_level = 0;
  const auto asset = expect(runtime::Asset::open(memory.source(), options), "the pack");
  if (!asset->loadAll()) fail("the pack cannot be read");
  const fields::Occupancy volume = voxelsOf(asset->pack());
  const auto visible = rendererOf(*asset, kVisible), eight = rendererOf(*asset, kEightSunRays);
  const Canvas canvas(kViewport);
  for (const std::size_t i : {0u, 1u, 3u}) {
    runtime::Pose pose = expect(runtime::Pose::create(*asset), "a pose");
    if (!pose.setKnots(0, figureKnots(kFigure6[i]))) fail("the pose is refused");
    const runtime::Instance instance{asset.get(), &pose};
    const Box box = bounds(instance);
    const glm::vec3 centre = 0.5f * (box.min + box.max);
    gl::View view =
        lookAt(canvas, centre + 0.9f * glm::distance(box.min, box.max) * glm::vec3(0.5f, 0.4f, 0.7f), centre);
    view.light.sun_direction = {0.3f, 0.8f, 0.4f};
    view.quality.occlusion_reach = kReach;
    const double plain = draw(*visible, canvas, view, instance).seconds;
    LightPictures pictures;
    view.quality.occlusion_rays = 8;
    const Drawn rays = draw(*visible, canvas, view, instance);
    view.quality.occlusion_rays = 0;
    view.quality.occlusion = true;
    const double occlusion = draw(*visible, canvas, view, instance).seconds;
    view.quality.occlusion = false;
    view.quality.self_shadow = true;  // one ray
    const double one_ray = draw(*visible, canvas, view, instance).seconds;
    view.quality.self_shadow = false;
    view.quality.soft_shadows = kSunDegrees;
    const double soft = draw(*visible, canvas, view, instance).seconds;
    view.quality.occlusion = true;
    const Drawn both = draw(*visible, canvas, view, instance);
    view.quality.soft_shadows = 0;
    view.quality.occlusion = false;
    const Drawn sun_rays = draw(*eight, canvas, view, instance);
    pictures.rays = rays.pixels;
    pictures.sun_rays = sun_rays.pixels;
    pictures.distances = both.pixels;
    const LightErrors errors = measureLight(volume, instance, view, pictures, kPixels);
    std::printf("%s, %s: plain %.1f ms\n", path.c_str(), kFigure6[i].name, 1e3 * plain);
    std::printf("  occlusion %.2f of the time of 8 rays (%.1f ms), error %.4f beside %.4f of %.3f\n",
                (occlusion - plain) / (rays.seconds - plain), 1e3 * (rays.seconds - plain),
                errors.sky.distances, errors.sky.rays, errors.sky.shade);
    std::printf(
        "  sun       %.2f of the time of 8 rays (%.1f ms; one: %.1f), error %.4f beside %.4f of %.3f\n",
        (soft - plain) / (sun_rays.seconds - plain), 1e3 * (sun_rays.seconds - plain),
        1e3 * (one_ray - plain), errors.sun.distances, errors.sun.rays, errors.sun.shade);
  }
}

}  // namespace

int main(int count, char** arguments) {
  if (count < 2) fail("usage: bench_shading PACK...");
  const EglContext context(GlApi::kDesktop33);
  if (!context) fail("no EGL device gives a context of OpenGL 3.3");
  for (int i = 1; i < count; ++i) measure(arguments[i]);
}
