// SPDX-License-Identifier: MIT
// How many bytes of a pack must have come until there is a picture, until half of it is final, and until all
// of it is: README.md here.
#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <iterator>
#include <memory>
#include <string>
#include <utility>

#include <nlohmann/json.hpp>

#include "canvas.h"
#include "kelp/runtime/asset.h"

namespace {

using namespace kelp;
using namespace kelp::test;

constexpr glm::ivec2 kViewport{640, 480};

[[noreturn]] void fail(const std::string& text) {
  std::fprintf(stderr, "%s\n", text.c_str());
  std::exit(1);
}
template <class T>
T expect(Result<T> result, const char* what) {
  if (!result) fail(std::string(what) + ": " + result.error().detail);
  return *std::move(result);
}

// Counts what is read of a pack in memory.
struct Counted {
  MemorySource memory;
  std::uint64_t bytes = 0;

  Source source() {
    return {[](void* user, std::uint64_t offset, std::span<std::byte> into) {
              Counted& self = *static_cast<Counted*>(user);
              self.bytes += into.size();
              const Source all = self.memory.source();
              return all.read(all.user, offset, into);
            },
            this, memory.source().size};
  }
};

// A picture of the pack at rest, as far as it is loaded.
class Painter {
 public:
  explicit Painter(const runtime::Asset& asset) : asset_(asset), canvas_(kViewport) {
    gl::Config config;
    config.getProcAddress = EglContext::getProcAddress;
    renderer_ = expect(gl::Renderer::create(config), "a renderer");
    if (!renderer_->add(asset)) fail("the pack does not fit");
    instance_.asset = &asset;
    const Box box = bounds(instance_);
    const glm::vec3 centre = 0.5f * (box.min + box.max);
    view_ = lookAt(canvas_, centre + 0.9f * glm::distance(box.min, box.max) * glm::vec3(0.5f, 0.4f, 0.7f),
                   centre);
  }
  // Draws what is there. pending: whether the renderer wants more.
  std::vector<Pixel> draw(bool& pending) {
    const auto uploaded = renderer_->upload(~std::uint64_t{0});
    if (!uploaded) fail("the pack cannot be uploaded");
    pending = uploaded->pending > 0;
    canvas_.clear();
    if (!renderer_->draw(view_, {&instance_, 1})) fail("it cannot be drawn");
    return canvas_.pixels();
  }

 private:
  const runtime::Asset& asset_;
  Canvas canvas_;
  std::unique_ptr<gl::Renderer> renderer_;
  runtime::Instance instance_;
  gl::View view_;
};

// The canvas is cleared to zeros, the surface is opaque.
bool isCovered(const Pixel& pixel) { return pixel[3] != 0; }

nlohmann::json measure(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  const std::string text(std::istreambuf_iterator<char>(file), {});
  if (text.empty()) fail(path + ": cannot be read");
  const std::span<const std::byte> bytes = std::as_bytes(std::span(text));

  // The final picture.
  const MemorySource whole(bytes);
  const auto all = expect(runtime::Asset::open(whole.source()), "the pack");
  if (!all->loadAll()) fail("the pack cannot be read");
  bool pending = true;
  Painter final_painter(*all);
  std::vector<Pixel> last;
  while (pending) last = final_painter.draw(pending);
  std::size_t covered = 0;
  for (const Pixel& pixel : last) covered += isCovered(pixel);

  // Step by step, as the renderer asks for it.
  Counted counted{MemorySource(bytes)};
  const auto asset = expect(runtime::Asset::open(counted.source()), "the pack");
  Painter painter(*asset);
  std::uint64_t first = 0, half = 0, complete = 0, drawn_at = 0;
  const std::uint64_t step = std::max<std::uint64_t>(bytes.size() / 256, 1024);
  while (complete == 0) {
    const bool loaded = expect(asset->pump(), "a page");
    if (loaded && counted.bytes < drawn_at + step && first > 0) continue;
    drawn_at = counted.bytes;
    const std::vector<Pixel> now = painter.draw(pending);
    std::size_t shown = 0, final_ones = 0;
    for (std::size_t i = 0; i < now.size(); ++i) {
      shown += isCovered(now[i]);
      final_ones += isCovered(last[i]) && now[i] == last[i];
    }
    if (first == 0 && shown > 0) first = counted.bytes;
    if (half == 0 && 2 * final_ones >= covered) half = counted.bytes;
    if (final_ones == covered && shown == covered) complete = counted.bytes;
    if (!loaded && !pending && complete == 0) fail(path + ": the picture never becomes the final one");
  }
  std::printf("%-40s %9zu bytes: first picture %8llu, half final %8llu, all final %8llu\n", path.c_str(),
              bytes.size(), static_cast<unsigned long long>(first), static_cast<unsigned long long>(half),
              static_cast<unsigned long long>(complete));
  return {{"pack", path}, {"bytes", bytes.size()}, {"first", first}, {"half", half}, {"all", complete}};
}

}  // namespace

int main(int count, char** arguments) {
  std::string out;
  int from = 1;
  if (count > 3 && std::string(arguments[1]) == "--json") out = arguments[2], from = 3;
  if (from >= count) fail("usage: bench_stream [--json FILE] PACK...");
  const EglContext context(GlApi::kDesktop33);
  if (!context) fail("no EGL device gives a context of OpenGL 3.3");
  nlohmann::json rows = nlohmann::json::array();
  for (int i = from; i < count; ++i) rows.push_back(measure(arguments[i]));
  if (!out.empty()) std::ofstream(out) << rows.dump(1) << "\n";
}
