// SPDX-License-Identifier: MIT
// How many bytes of a pack must have come until there is a picture, until half of it is final, and until all
// of it is; and what a frame pays while packs arrive: README.md here.
#include <algorithm>
#include <atomic>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <iterator>
#include <memory>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include <nlohmann/json.hpp>

#include "canvas.h"
#include "kelp/runtime/asset.h"

namespace {

using namespace kelp;
using namespace kelp::test;

constexpr glm::ivec2 kViewport{640, 480};
constexpr std::uint64_t kAllBytes = ~std::uint64_t{0}, kFrameBytes = 1 << 20;

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

// A picture of packs at rest side by side, as far as they are loaded.
class Painter {
 public:
  explicit Painter(std::span<const std::unique_ptr<runtime::Asset>> assets) : canvas_(kViewport) {
    gl::RendererOptions config;
    config.getProcAddress = EglContext::getProcAddress;
    renderer_ = expect(gl::Renderer::create(config), "a renderer");
    Box all{glm::vec3(0), glm::vec3(0)};
    for (const auto& asset : assets) {
      if (!renderer_->add(*asset)) fail("the packs do not fit");
      runtime::Instance& instance = instances_.emplace_back();
      instance.asset = asset.get();
      const Box box = bounds(instance);
      const float scale = 1 / glm::distance(box.min, box.max);  // all are of one size
      instance.to_world = glm::mat4(scale);
      instance.to_world[3] = glm::vec4(glm::vec3(all.max.x, 0, 0) - scale * box.min, 1);
      all.max = glm::max(all.max, bounds(instance).max);
    }
    const glm::vec3 center = 0.5f * all.max;
    view_ = lookAt(canvas_, center + 0.9f * glm::length(all.max) * glm::vec3(0.5f, 0.4f, 0.7f), center);
  }
  gl::Stats upload(std::uint64_t most) { return expect(renderer_->upload(most), "an upload"); }
  std::vector<Pixel> draw() {
    canvas_.clear();
    if (!renderer_->draw(view_, instances_)) fail("it cannot be drawn");
    return canvas_.pixels();
  }

 private:
  Canvas canvas_;
  std::unique_ptr<gl::Renderer> renderer_;
  std::vector<runtime::Instance> instances_;
  gl::View view_;
};

// The canvas is cleared to zeros, the surface is opaque.
bool isCovered(const Pixel& pixel) { return pixel[3] != 0; }

std::string read(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  std::string text(std::istreambuf_iterator<char>(file), {});
  if (text.empty()) fail(path + ": cannot be read");
  return text;
}

std::vector<std::unique_ptr<runtime::Asset>> open(const Source& source) {
  std::vector<std::unique_ptr<runtime::Asset>> assets;
  assets.push_back(expect(runtime::Asset::open(source), "the pack"));
  return assets;
}

nlohmann::json measure(const std::string& path) {
  const std::string text = read(path);
  const std::span<const std::byte> bytes = std::as_bytes(std::span(text));

  // The final picture.
  const MemorySource whole(bytes);
  const auto all = open(whole.source());
  if (!all[0]->loadAll()) fail("the pack cannot be read");
  Painter final_painter(all);
  while (final_painter.upload(kAllBytes).pending > 0) continue;
  const std::vector<Pixel> last = final_painter.draw();
  std::size_t covered = 0;
  for (const Pixel& pixel : last) covered += isCovered(pixel);

  // Step by step, as the renderer asks for it.
  Counted counted{MemorySource(bytes)};
  const auto asset = open(counted.source());
  Painter painter(asset);
  std::uint64_t first = 0, half = 0, complete = 0, drawn_at = 0;
  const std::uint64_t step = std::max<std::uint64_t>(bytes.size() / 256, 1024);
  while (complete == 0) {
    const bool loaded = expect(asset[0]->pump(), "a page");
    if (loaded && counted.bytes < drawn_at + step && first > 0) continue;
    drawn_at = counted.bytes;
    const bool pending = painter.upload(kAllBytes).pending > 0;
    const std::vector<Pixel> now = painter.draw();
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

// Milliseconds of some calls, sorted.
class Times {
 public:
  template <class Call>
  auto take(const Call& call) {
    const auto before = std::chrono::steady_clock::now();
    auto result = call();
    times_.push_back(
        std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - before).count());
    return result;
  }
  std::size_t count() const { return times_.size(); }
  void finish(std::size_t count) {
    times_.resize(count);
    std::sort(times_.begin(), times_.end());
  }
  double share(std::size_t percent) const { return times_[(times_.size() - 1) * percent / 100]; }
  std::string text() const {
    char text[96];
    std::snprintf(text, sizeof text, "%.2f ms (median), %.2f (99 %%), %.2f (longest)", share(50), share(99),
                  share(100));
    return text;
  }
  nlohmann::json json() const {
    return {{"median", share(50)}, {"percent_99", share(99)}, {"most", share(100)}};
  }

 private:
  std::vector<double> times_;
};

// All packs at once: a thread reads and decodes what the renderer asks for, while the other draws and uploads
// at most kFrameBytes a frame. What upload() takes of each frame is kelp's share of its time; whole frames,
// finished by OpenGL, beside those of the same picture when nothing arrives any more.
nlohmann::json measureFrames(const std::vector<std::string>& paths) {
  std::vector<std::string> texts;
  for (const std::string& path : paths) texts.push_back(read(path));
  std::vector<MemorySource> sources;
  for (const std::string& text : texts) sources.emplace_back(std::as_bytes(std::span(text)));
  std::vector<std::unique_ptr<runtime::Asset>> assets;
  for (const MemorySource& source : sources)
    assets.push_back(expect(runtime::Asset::open(source.source()), "a pack"));
  Painter painter(assets);
  (void)painter.draw();  // makes the programs
  std::atomic<bool> stop = false, idle = false;
  std::thread reader([&] {
    while (!stop) {
      bool more = false;
      for (const auto& asset : assets) more = expect(asset->pump(), "a page") || more;
      idle = !more;
      if (!more) std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
  });
  constexpr std::size_t kQuiet = 10, kAfter = 60;
  Times uploads, frames, after;
  std::uint64_t most = 0, sum = 0;
  const auto frame = [&] {
    const gl::Stats stats = uploads.take([&] { return painter.upload(kFrameBytes); });
    (void)painter.draw();
    return stats;
  };
  for (std::size_t quiet = 0; quiet < kQuiet;) {
    const gl::Stats stats = frames.take(frame);
    most = std::max(most, stats.bytes_uploaded);
    sum += stats.bytes_uploaded;
    quiet = idle && stats.pending == 0 && stats.bytes_uploaded == 0 ? quiet + 1 : 0;
  }
  stop = true;
  reader.join();
  const std::size_t count = frames.count() - kQuiet;  // then nothing was left to do
  while (after.count() < kAfter) after.take(frame);
  uploads.finish(count);
  frames.finish(count);
  after.finish(kAfter);
  std::printf("%zu packs in %zu frames: %llu bytes uploaded, at most %llu a frame\n", paths.size(), count,
              static_cast<unsigned long long>(sum), static_cast<unsigned long long>(most));
  std::printf("  upload()      %s\n  whole frames  %s\n  and later     %s\n", uploads.text().c_str(),
              frames.text().c_str(), after.text().c_str());
  return {{"packs", paths},           {"frames", count},        {"bytes", sum},         {"most_bytes", most},
          {"upload", uploads.json()}, {"whole", frames.json()}, {"later", after.json()}};
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
  rows.push_back(measureFrames({arguments + from, arguments + count}));
  if (!out.empty()) std::ofstream(out) << rows.dump(1) << "\n";
}
