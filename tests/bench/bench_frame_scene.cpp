// SPDX-License-Identifier: MIT
#include "bench_frame_scene.h"

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <utility>

#include "support/cage_pack.h"
#include "support/test_pack.h"

namespace kelp::bench {
namespace {

// A plant: three blades around a stem, so that most of the box is empty, as in real ones.
fields::Occupancy blades(const glm::ivec3& size, int which) {
  fields::Occupancy volume;
  volume.size = size;
  volume.solid.assign(static_cast<std::size_t>(size.x * size.y * size.z), 0);
  const glm::vec2 middle(0.5f * static_cast<float>(size.x), 0.5f * static_cast<float>(size.z));
  for (int z = 0; z < size.z; ++z) {
    for (int y = 0; y < size.y; ++y) {
      const float height = static_cast<float>(y) / static_cast<float>(size.y);
      for (int x = 0; x < size.x; ++x) {
        const glm::vec2 p = glm::vec2(static_cast<float>(x), static_cast<float>(z)) + 0.5f - middle;
        bool solid = false;
        for (int blade = 0; blade < 3; ++blade) {
          const float angle = 2.1f * static_cast<float>(blade + which) + 0.3f * static_cast<float>(which);
          const glm::vec2 along(std::cos(angle), std::sin(angle));
          const glm::vec2 from = p - height * 0.35f * middle.x * along;
          const float across = std::abs(along.x * from.y - along.y * from.x),
                      out = std::abs(glm::dot(along, from));
          solid = solid || (across < 1.2f && out < (1.05f - height) * 0.55f * middle.x);
        }
        volume.solid[static_cast<std::size_t>(x + size.x * (y + size.y * z))] = solid;
      }
    }
  }
  return volume;
}

struct Kind {
  glm::ivec3 size;
  int knots;
  int periods;  // of waves on each vector that moves: two vectors a knot but the first
};
constexpr Kind kKinds[] = {{{24, 48, 24}, 2, 1}, {{32, 64, 28}, 2, 2}, {{40, 40, 40}, 3, 1},
                           {{48, 58, 48}, 3, 2}, {{38, 64, 32}, 4, 3}, {{42, 64, 22}, 4, 1},
                           {{25, 64, 18}, 4, 1}, {{49, 64, 51}, 4, 3}};

RawPack packOf(const Kind& kind, int which, int parts, Bend bend) {
  RawPack pack;
  pack.info_json = "{}";
  pack.palette = {Material{{0.2f, 0.5f, 0.15f, 1}, {0, 0, 0}, 0, 0.8f}};
  RawClip clip;
  clip.name = "sway";
  clip.duration = 4;
  for (int p = 0; p < parts; ++p) {
    std::vector<Knot> knots;
    for (int k = 0; k < kind.knots; ++k) {
      const float at = static_cast<float>(k) / static_cast<float>(kind.knots - 1);
      knots.push_back({at, {0.05f * at, at, 0}, {0.05f, 1, 0}});
      for (int wave = 0; k > 0 && wave < kind.periods; ++wave) {
        const float period = 2.0f + 0.7f * static_cast<float>(wave), phase = 0.13f * static_cast<float>(k);
        const glm::vec3 push = 0.1f / static_cast<float>(wave + 1) * at * glm::vec3(1, 0, 0.4f);
        const auto part = static_cast<std::uint32_t>(p), knot = static_cast<std::uint32_t>(k);
        clip.waves.push_back({part, knot, kelp::Target::kKnotOffset, push, period, phase});
        clip.waves.push_back({part, knot, kelp::Target::kKnotTangent, 1.5f * push, period, phase});
      }
    }
    pack.parts.push_back(
        test::partOf(blades(kind.size, which), std::move(knots), "part " + std::to_string(p)));
    pack.parts.back().bend = bend;
    for (int axis = 0; axis < 3; ++axis)
      pack.parts.back().to_object[3][axis] += axis == 1 ? 0.0f : 0.2f * static_cast<float>(p);
  }
  pack.clips.push_back(clip);
  return pack;
}

}  // namespace

Library::Library(int parts, Bend bend, bool slender, int cell) {
  for (Kind kind : kKinds) {
    if (slender) kind.size = {14, cell > 0 ? 128 : 64, 14}, kind.knots = 4;
    RawPack pack = packOf(kind, static_cast<int>(assets_.size()) + 1, parts, bend);
    add(cell > 0 ? test::caged(std::move(pack), cell) : pack);
  }
}

Library::Library(const RawPack& pack) { add(pack); }

void Library::add(const RawPack& pack) {
  Loaded& fresh = assets_.emplace_back();
  fresh.bytes = test::bytesOf(pack);
  fresh.source = std::make_unique<MemorySource>(fresh.bytes);
  auto opened = runtime::Asset::open(fresh.source->source());
  if (!opened || !(*opened)->loadAll()) {
    std::fprintf(stderr, "bench_frame: the benchmark's own pack does not open\n");
    std::exit(4);
  }
  fresh.asset = *std::move(opened);
}

std::size_t Library::knots() const {
  std::size_t all = 0;
  for (const Loaded& loaded : assets_) {
    for (const Part& part : loaded.asset->pack().parts()) all += part.knots.size();
  }
  return all;
}

std::size_t Library::waves() const {
  std::size_t all = 0;
  for (const Loaded& loaded : assets_) all += loaded.asset->pack().clips()[0].waves.size();
  return all;
}

Crowd::Crowd(const Library& assets, std::size_t count, int which_clip) : library(assets), clip(which_clip) {
  for (std::size_t i = 0; i < count; ++i)
    poses.push_back(*runtime::Pose::create(library[i % library.size()]));
  for (std::size_t i = 0; i < count; ++i) {
    runtime::Instance& instance = instances.emplace_back();
    instance.asset = &library[i % library.size()];
    instance.pose = &poses[i];
  }
  update();
}

void Crowd::update() {
  seconds += 1.0 / 60;
  for (std::size_t i = 0; i < poses.size(); ++i) {
    poses[i].reset();
    (void)runtime::addClip(*instances[i].asset, clip, seconds + 0.37 * static_cast<double>(i), 1.0f,
                           poses[i]);
  }
}

void Crowd::writeNodes() {
  if (nodes.empty()) {
    for (std::size_t i = 0; i < library.size(); ++i) {
      const std::span<const glm::vec3> bent = std::as_const(poses[i]).nodes(0);
      nodes.emplace_back(bent.begin(), bent.end());
    }
  }
  for (std::size_t i = 0; i < poses.size(); ++i)
    std::ranges::copy(nodes[i % nodes.size()], poses[i].nodes(0).begin());
}

double median(std::vector<double> values) {
  std::nth_element(values.begin(), values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2),
                   values.end());
  return values[values.size() / 2];
}

}  // namespace kelp::bench
