// SPDX-License-Identifier: MIT
// kelp-render: packs, poses, a picture. The one place where errors become exit codes.
#include <cstdio>
#include <exception>
#include <new>

#include <fmt/format.h>

#include "camera.h"
#include "canvas.h"
#include "headless_context.h"
#include "kelp/console/console.h"
#include "options.h"
#include "picture.h"
#include "png_file.h"
#include "render_error.h"
#include "scene.h"
#include "views.h"

namespace kelp::render {
namespace {

Exit exitOf(ErrorCode code) {
  switch (code) {
    case ErrorCode::kIo: return kIo;
    case ErrorCode::kUnsupportedVersion:
    case ErrorCode::kUnsupportedFeature: return kUnsupported;
    case ErrorCode::kMisuse:
    case ErrorCode::kOutOfMemory:
    case ErrorCode::kGraphics: return kFailure;
    default: return kInvalid;
  }
}

const char* remedyOf(ErrorCode code) {
  switch (exitOf(code)) {
    case kIo: return "check the disk and the file's permissions";
    case kUnsupported: return "use a newer version of kelp";
    case kFailure: return code == ErrorCode::kOutOfMemory ? "free memory, or bake with a lower resolution" : "please report this as a fault of kelp-render";
    default: return "check it with kelp-dump verify, or bake it again";
  }
}

// OUT.png, or OUT_0001.png and so on.
std::string frameName(const Options& options, int frame) {
  if (options.frames == 1) return options.output;
  return fmt::format("{}_{:04}.png", options.output.substr(0, options.output.size() - 4), frame + 1);
}

void run(const Options& options) {
  std::vector<std::string> inputs;
  for (const Item& item : options.items) inputs.push_back(item.pack);
  for (int frame = 0; frame < options.frames; ++frame) checkPng(frameName(options, frame), inputs);
  Scene scene(options);
  const bool turntable = scene.duration() == 0;
  const auto pose = [&](int frame) { scene.pose(scene.duration() * frame / options.frames); };

  // The camera sees every frame; with a clip the models at rest too, so that pictures of single moments have one framing.
  Framing framing(options.yaw, options.pitch, turntable ? options.frames : 1, static_cast<double>(options.size.x) / options.size.y);
  const auto addOutlines = [&] {
    for (const runtime::Instance& instance : scene.instances()) addOutline(instance, framing);
  };
  if (!turntable) addOutlines();
  for (int frame = 0; frame < (turntable ? 1 : options.frames); ++frame) {
    pose(frame);
    addOutlines();
  }
  const Camera camera(framing);
  const ViewStyle style = styleOf(options.view, camera);

  const HeadlessContext context;
  Canvas canvas(options.samples * options.size, style.colors, context.es());
  gl::Config config;
  config.getProcAddress = HeadlessContext::getProcAddress;
  config.surface_glsl = style.surface.empty() ? nullptr : style.surface.c_str();
  config.secondary_rays = options.shadows || options.occlusion > 0;
  config.log = [](void*, const char* text) { std::fputs(text, stderr); };
  // Room for every voxel, in whole layers of 4 MiB: a picture has no frame rate to keep.
  config.gpu_budget = std::uint64_t{8} << 20;
  for (const auto& [path, pack] : scene.packs()) config.gpu_budget += gl::poolBytes(*pack.asset);
  const auto renderer = checkPack("OpenGL", gl::Renderer::create(config));
  for (const auto& [path, pack] : scene.packs()) checkPack(path, renderer->add(*pack.asset));
  checkPack("OpenGL", renderer->upload(~std::uint64_t{0}));

  gl::View view;
  view.viewport = options.samples * options.size;
  view.shading = options.shading;
  view.self_shadow = options.shadows;
  view.occlusion_rays = options.occlusion;
  if (options.level) {
    view.finest_level = *options.level;
    view.pixels_per_voxel = 0;
  }
  for (int frame = 0; frame < options.frames; ++frame) {
    pose(frame);
    camera.apply(turntable ? frame : 0, view);
    canvas.clear();
    checkPack("OpenGL", renderer->draw(view, scene.instances()));
    if (style.colors) checkPack("OpenGL", renderer->draw(view, scene.instances(), gl::Pass::kFog));
    writePng(frameName(options, frame),
             resolve(canvas.read(), options.size, options.samples, style.colors, options.background.value_or(style.background)));
  }
}

int complain(Exit code, const std::string& message) {
  std::fprintf(stderr, "kelp-render: %s\n", console::oneLine(message).c_str());
  return code;
}

}  // namespace

void failPack(const std::string& path, const Error& error) {
  std::string message = path + ": ";
  if (error.offset != Error::kNoOffset) message += fmt::format("byte {}: ", error.offset);
  message += toString(error.code);
  if (*error.detail) message += fmt::format(" ({})", error.detail);
  throw RenderError(exitOf(error.code), fmt::format("{}; {}", message, remedyOf(error.code)));
}

}  // namespace kelp::render

int main(int argc, char** argv) {
  using namespace kelp::render;
  kelp::console::prepareStreams();
  try {
    if (const auto options = parseOptions(argc, argv)) run(*options);
    return kOk;
  } catch (const RenderError& error) {
    return complain(error.exit, error.what());
  } catch (const std::bad_alloc&) {
    return complain(kFailure, "out of memory; lower --size or --samples, or bake with a lower resolution");
  } catch (const std::exception& error) {
    return complain(kFailure, std::string("unexpected: ") + error.what() + "; please report this as a fault of kelp-render");
  }
}
