// SPDX-License-Identifier: MIT
#include "exercise_renderer.h"

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <optional>
#include <vector>

#include <glm/gtc/matrix_transform.hpp>

#include "kelp/formats/page.h"
#include "kelp/gl/renderer.h"
#include "kelp/runtime/level.h"
#include "kelp/streaming/page_access.h"
#include "support/fake_gl.h"

using namespace kelp;

namespace {

[[noreturn]] void fault(const char* what) {
  std::fprintf(stderr, "FAULT: %s\n", what);
  std::abort();
}

// The pool's content, as shaders/instance.glsl has it, for the only asset of a renderer: from the first row
// on that is somebody's.
void checkPool(const test::FakeGl& fake, const runtime::Asset& asset, bool distances) {
  const std::vector<std::uint32_t>& words = fake.pool().words;
  const auto holds = [&words](std::uint64_t at, std::span<const std::uint32_t> wanted) {
    return at <= words.size() && wanted.size() <= words.size() - at &&
           std::equal(wanted.begin(), wanted.end(), words.begin() + static_cast<std::ptrdiff_t>(at));
  };
  constexpr std::uint64_t kWords = 4;  // of a level in the table
  std::uint64_t table = 1024 + 9 * asset.pack().palette().size();
  for (int p = 0; p < static_cast<int>(asset.pack().parts().size()); ++p) {
    const Part& part = asset.pack().parts()[static_cast<std::size_t>(p)];
    for (int l = 0; l < part.levels; ++l, table += kWords) {
      if (table + kWords > words.size()) fault("the tables lie beyond the pool");
      const std::uint64_t cells_at = words[table], pages_at = words[table + 1];
      const bool complete = words[table + 2] >> 31;
      const bool cage = !part.cages.empty() && cells_at > 0;
      if ((words[table + 3] > 0) != cage) fault("a cage is missing, or where none belongs");
      if (cage && !holds(words[table + 3], part.cages[static_cast<std::size_t>(l)].words))
        fault("the pool holds another cage");
      if (cells_at == 0) continue;
      const runtime::Level* level = asset.level(p, l);
      if (!level) fault("the pool holds a level that is not in memory");
      if (!holds(cells_at, level->cells)) fault("the pool holds other cells");
      for (std::uint32_t page = 0; page < level->pages.size(); ++page) {
        const std::uint64_t at = pages_at + page < words.size() ? words[pages_at + page] : 0;
        if (at == 0 && complete) fault("a page of a level that is complete is not there");
        if (at == 0) continue;
        const runtime::PinnedPage pinned = runtime::PageAccess::pin(asset, {p, l}, page, 0);
        if (pinned && !holds(at, pinned.words())) fault("the pool holds another page");
      }
    }
    const int fields = distances && asset.loadsDistances() ? asset.pack().distanceLevels(p) : 0;
    for (int l = 0; l < fields; ++l, table += kWords) {
      if (table + kWords > words.size()) fault("the tables of distances lie beyond the pool");
      if (words[table] == 0) continue;
      const runtime::Level* level = asset.distances(p, l);
      if (!level) fault("the pool holds distances that are not in memory");
      if (!holds(words[table], level->cells)) fault("the pool holds other cells of distances");
      std::vector<std::uint32_t> codes(level->codes.size() / 4);
      std::memcpy(codes.data(), level->codes.data(), level->codes.size());
      for (std::size_t page = 0; page < level->pages.size(); ++page) {
        const std::uint64_t entry = words[table + 1] + page, at = entry < words.size() ? words[entry] : 0;
        const PageInfo& of = level->pages[page];
        if (at != 0 && !holds(at, std::span(codes).subspan(128 * of.first_slot, 128 * of.count)))
          fault("the pool holds other distances");
      }
    }
    if (part.fog) table += 6 + static_cast<std::uint64_t>(part.levels) + 3 * part.fog->ramp.size();
  }
}

// Bends each part by a share of its height, as far as it stays monotone.
void bend(float share, runtime::Pose& pose) {
  for (int part = 0; part < pose.parts(); ++part) {
    std::vector<Knot> knots(pose.knots(part).begin(), pose.knots(part).end());
    for (Knot& knot : knots) knot.position.x += share * knot.at;
    (void)pose.setKnots(part, knots);
  }
  pose.clamp();
}

// A camera that sees the instance from a multiple of its own size away.
gl::View viewOf(const runtime::Instance& instance, float distance) {
  const Box box = runtime::bounds(instance);
  const glm::vec3 middle = 0.5f * (box.min + box.max);
  const float size = std::max(glm::length(box.max - box.min), 1e-6f);
  gl::View view;
  view.camera.viewport = {640, 480};
  view.camera.world_to_eye =
      glm::lookAt(middle + size * distance * glm::vec3(0.5f, 0.3f, 1), middle, glm::vec3(0, 1, 0));
  view.camera.eye_to_clip = glm::perspective(0.8f, 4.0f / 3, 0.01f * size, 100 * size);
  return view;
}

}  // namespace

void exerciseRenderer(std::unique_ptr<runtime::Asset> asset, std::uint64_t choice,
                      const Allocator& allocator) {
  test::FakeGl fake;
  fake.keeps_texels = true;
  fake.depth_bits = choice & 1 ? 24 : 0;
  if (choice & 2) fake.version = "4.6 fake";
  fake.out_of_memory = choice / 4 % 32 == 0;
  test::FakeGl::current() = &fake;
  gl::RendererOptions config;
  config.getProcAddress = &test::FakeGl::getProcAddress;
  config.gpu_budget = choice / 128 % 2 ? 64 * 4096 : 96 * 4096;
  const bool distances = choice / 4096 % 2;
  config.features = (choice / 256 % 2 ? gl::Features::kSecondaryRays : gl::Features::kNone) |
                    (distances ? gl::Features::kDistances : gl::Features::kNone);
  config.allocator = allocator;
  auto created = gl::Renderer::create(config);
  if (!created || !(*created)->add(*asset)) return;
  gl::Renderer& renderer = **created;

  auto pose = runtime::Pose::create(*asset, allocator);
  if (pose) bend(0.3f, *pose);
  const runtime::Instance straight{asset.get()};
  runtime::Instance bent{asset.get(), pose ? &*pose : nullptr};
  bent.to_world[3] = glm::vec4(0.5f, 0.25f, 0, 1);
  const runtime::Instance both[] = {straight, bent};
  const std::uint64_t max_bytes = choice / 512 % 2 ? 4096 : 65536;
  for (int frame = 0; frame < 6; ++frame) {
    for (int i = 0; i < 4; ++i) static_cast<void>(asset->pump());
    if (const auto stats = renderer.upload(frame == 4 ? 0 : max_bytes)) {
      if (stats->bytes_uploaded > max_bytes) fault("an upload of more than its budget");
      if (stats->gpu_bytes > config.gpu_budget) fault("more than gpu_budget");
    }
    checkPool(fake, *asset, distances);
    gl::View view = viewOf(straight, frame < 3 ? 0.6f : 40.0f);
    view.quality.depth_batches = 1 + frame % 3;
    view.quality.shading = static_cast<gl::Shading>(frame % 3);
    view.quality.soft_shadows = distances && frame % 2 ? 1.0f : 0.0f;
    view.quality.occlusion = distances && frame % 3 == 0;
    static_cast<void>(renderer.draw(view, std::span(both).first(static_cast<std::size_t>(1 + frame % 2))));
    static_cast<void>(renderer.draw(view, both, frame % 2 ? gl::Pass::kFog : gl::Pass::kDepth));
    static_cast<void>(renderer.bindTrace(1, view, both));
    const std::optional<int> level = gl::levelAt(view, bent, 0, {320, 240});
    if (level && *level >= asset->pack().parts()[0].levels) fault("a level that is not there");
  }
  switch (choice / 1024 % 4) {
    case 0:
      renderer.remove(*asset);
      break;
    case 1:
      renderer.abandon();
      break;
    case 2:
      asset.reset();
      break;
    default:
      return;
  }
  static_cast<void>(renderer.upload(max_bytes));
  if (renderer.draw(viewOf({}, 1), both)) fault("an asset that the renderer does not know is drawn");
}
