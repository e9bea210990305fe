// SPDX-License-Identifier: MIT
// kelp in a page: a renderer on WebGL 2 and one frame of a pack. tests/ports.sh web links it; without a
// canvas, as under node, it ends with a message.
#include <emscripten/html5.h>
#include <emscripten/html5_webgl.h>

#include <cstdio>

#include "kelp/gl/renderer.h"

int main(int count, char** words) {
  auto file = kelp::FileSource::open(count > 1 ? words[1] : "pack.kelp");
  if (!file) return std::fprintf(stderr, "draw: %s\n", file.error().detail), 2;
  const auto asset = kelp::runtime::Asset::open(file->source());
  if (!asset) return std::fprintf(stderr, "draw: %s\n", asset.error().detail), 3;
  if (const auto loaded = (*asset)->loadAll(); !loaded)
    return std::fprintf(stderr, "draw: %s\n", loaded.error().detail), 3;
  const auto pose = kelp::runtime::Pose::create(**asset);
  if (!pose) return std::fprintf(stderr, "draw: %s\n", pose.error().detail), 4;
  std::printf("draw: %d parts loaded\n", static_cast<int>((*asset)->pack().parts().size()));

  EmscriptenWebGLContextAttributes attributes;
  emscripten_webgl_init_context_attributes(&attributes);
  attributes.majorVersion = 2;
  const EMSCRIPTEN_WEBGL_CONTEXT_HANDLE context = emscripten_webgl_create_context("#canvas", &attributes);
  if (context <= 0) return std::fputs("draw: no WebGL 2 here\n", stderr), 4;
  emscripten_webgl_make_context_current(context);
  kelp::gl::RendererOptions config;
  config.getProcAddress = [](void*, const char* name) { return emscripten_webgl_get_proc_address(name); };
  const auto renderer = kelp::gl::Renderer::create(config);
  if (!renderer) return std::fprintf(stderr, "draw: %s\n", renderer.error().detail), 4;
  if (const auto added = (*renderer)->add(**asset); !added) return 4;
  const kelp::runtime::Instance instance{&**asset, &*pose};
  kelp::gl::View view;
  view.camera.viewport = {300, 150};  // of a canvas that says nothing else
  const auto drawn = (*renderer)->draw(view, instance);
  return drawn ? 0 : 4;
}
