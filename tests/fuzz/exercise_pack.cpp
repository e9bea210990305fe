// SPDX-License-Identifier: MIT
#include "exercise_pack.h"

#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <utility>
#include <vector>

#include "exercise_renderer.h"
#include "input_folder.h"
#include "kelp/formats/level.h"
#include "kelp/formats/verify.h"
#include "kelp/runtime/distance.h"
#include "kelp/runtime/instance.h"
#include "kelp/runtime/soft_body.h"
#include "kelp/runtime/spring.h"
#include "raw_of_pack.h"

using namespace kelp;

namespace {

// A host whose memory or whose reader gives out after so many calls.
struct FailingHost {
  std::uint64_t allocations_left = ~std::uint64_t{0}, reads_left = ~std::uint64_t{0};
  Source inner;

  static void* allocate(void* user, std::size_t bytes) {
    auto& self = *static_cast<FailingHost*>(user);
    return self.allocations_left-- == 0 ? nullptr : std::malloc(bytes);
  }
  static void deallocate(void*, void* memory, std::size_t) { std::free(memory); }
  static Read read(void* user, std::uint64_t offset, std::span<std::byte> bytes) {
    auto& self = *static_cast<FailingHost*>(user);
    return self.reads_left-- != 0 ? self.inner.read(self.inner.user, offset, bytes) : Read::kFailed;
  }
};

void report(void*, const Issue& issue) {
  // every issue has its words
  if (std::strlen(toString(issue.id)) == 0 || std::strlen(toString(issue.error.code)) == 0 ||
      !issue.error.detail)
    std::abort();
}

// Every query of distances, at two places. An answer is a number, or an error where it may be one.
void askDistances(const runtime::Instance& instance) {
  const Box box = runtime::bounds(instance);
  const glm::vec3 size = box.max - box.min, middle = 0.5f * (box.min + box.max);
  const float radius = 0.1f * glm::length(size);
  const std::span<const runtime::Instance> list(&instance, 1);
  for (const float away : {0.2f, 1.5f}) {
    const glm::vec3 point = middle + away * size;
    const auto found = runtime::distance(instance, point);
    if (found && (std::isnan(found->bound) || std::isnan(found->away.x))) std::abort();
    const auto closest = runtime::closestPoint(instance, point, away > 1 ? runtime::kFarAway : radius);
    if (closest && std::isnan(closest->distance)) std::abort();
    static_cast<void>(runtime::overlaps(instance, runtime::Sphere{point, radius}));
    static_cast<void>(runtime::overlaps(instance, runtime::Capsule{point, middle, radius}));
    static_cast<void>(
        runtime::overlaps(list, runtime::OrientedBox{middle, 0.2f * size, {1, 2, 3, 4}}, {&box, 1}));
    const auto cast = runtime::sphereCast(list, point, middle - size, 0.1f * radius);
    if (cast && !(cast->t >= 0 && cast->t <= 1)) std::abort();
  }
}

// Questions that a game asks each frame.
void ask(const runtime::Instance& instance) {
  const Box box = runtime::bounds(instance);
  const glm::vec3 middle = 0.5f * (box.min + box.max);
  for (int i = 0; i < 8; ++i) {
    const glm::vec3 corner(i & 1 ? box.max.x : box.min.x, i & 2 ? box.max.y : box.min.y,
                           i & 4 ? box.max.z : box.min.z);
    runtime::raycast(instance, {corner, middle - corner}, i % 3);
  }
  const std::span<const Part> parts = instance.asset->pack().parts();
  for (int part = 0; part < static_cast<int>(parts.size()); ++part) {
    const Part& of = parts[static_cast<std::size_t>(part)];
    const glm::vec3 rest = of.to_object * glm::vec4(0.3f * glm::vec3(of.size), 1);
    static_cast<void>(runtime::frameAt(instance, part, rest));
    if (const auto world = runtime::toWorld(instance, part, rest)) runtime::toRest(instance, part, *world);
  }
  constexpr std::size_t kMostParts = 4;  // a search that gives up takes some milliseconds a part
  if (parts.size() <= kMostParts) askDistances(instance);
}

// At rest; then all clips at a moment, also one beyond their ends, half way back to rest, pushed and blown;
// where an instance may stand.
void playAndAsk(runtime::Asset& asset, std::uint64_t choice) {
  constexpr double kMoments[] = {0.3, 0, -7.25, 1e9 + 0.1, 1e300, -1e300, 5e-324, 1e-38};
  constexpr float kScales[] = {1, -1, 1e-6f, 1e6f};
  runtime::Instance instance{&asset};
  ask(instance);
  auto rest = runtime::Pose::create(asset), pose = runtime::Pose::create(asset);
  if (!rest || !pose) return;
  const double moment = kMoments[choice % 8];
  for (int clip = 0; clip < static_cast<int>(asset.pack().clips().size()); ++clip) {
    if (runtime::addClip(asset, clip, moment, choice / 8 % 2 == 0 ? 1.0f : 0.3f, *pose)) pose->clamp();
  }
  if (choice / 16 % 4 == 0 && !pose->blend(*rest, 0.5f)) std::abort();
  if (choice / 64 % 4 == 0) {
    auto spring = runtime::Spring::create(asset);
    for (int part = 0; spring && part < spring->parts(); ++part) {
      static_cast<void>(spring->push(part, {30, 0, 1e20f}));
      static_cast<void>(spring->setWind(part, {0, 3, -5}));
      static_cast<void>(spring->pushAway(
          instance, glm::vec3(asset.pack().parts()[static_cast<std::size_t>(part)].to_object[3]), 0.5f));
      static_cast<void>(spring->step(static_cast<float>(moment)));
      for (const runtime::Swing& swing : spring->knots(part))
        for (int i = 0; i < 3; ++i)
          if (!std::isfinite(swing.offset[i]) || !std::isfinite(swing.velocity[i])) std::abort();
    }
    if (spring && spring->addTo(*pose)) pose->clamp();
    for (int part = 0; part < pose->parts(); ++part) {
      std::vector<float> volumes(std::as_const(*pose).nodes(part).size());
      if (!runtime::nodeEdges(asset, part)) std::abort();
      static_cast<void>(runtime::nodeVolumes(asset, part, volumes));
    }
  }
  instance.pose = &*pose;
  const float scale = kScales[choice / 256 % 4];
  instance.to_world = glm::mat4(glm::vec4(0, scale, 0, 0), glm::vec4(scale, 0, 0, 0), glm::vec4(0, 0, 1, 0),
                                glm::vec4(choice / 1024 % 2 == 0 ? 0.0f : 1e5f, 0, 3, 1));
  ask(instance);
}

}  // namespace

void exercisePack(std::span<const std::byte> bytes) {
  // A hash of all bytes (FNV-1a) chooses the host, so that every kind of pack meets every kind of host.
  std::uint64_t choice = 0xcbf29ce484222325u;
  for (const std::byte byte : bytes) choice = (choice ^ static_cast<std::uint8_t>(byte)) * 0x100000001b3u;
  choice >>= 16;

  PackLimits limits;
  limits.max_decoded_bytes = std::uint64_t{64} << 20;
  limits.max_side = 1024;
  limits.max_parts = 64;
  // some of them less than the smallest packs need
  if (choice % 16 == 0)
    limits = {64 + 100 * (choice / 16 % 8), 8u << choice / 16 % 3, 2, 200 + 400 * (choice / 16 % 8)};
  MemorySource memory(bytes);
  FileSource file;
  FailingHost host;
  host.inner = memory.source();
  if (choice / 128 % 16 == 0) {
    static const InputFolder folder;
    Result<FileSource> opened = FileSource::open(folder.write("input.kelp", bytes).string().c_str());
    if (!opened) std::abort();
    file = *std::move(opened);
    host.inner = file.source();
  }
  if (choice / 2048 % 8 == 0) host.allocations_left = choice / 16384 % 64;
  if (choice / 2048 % 8 == 1) host.reads_left = choice / 16384 % 64;
  const Source source{&FailingHost::read, &host, bytes.size()};
  const Allocator allocator{&FailingHost::allocate, &FailingHost::deallocate, &host};

  verify(source, limits, report, nullptr, allocator);
  {
    const Result<Pack> pack = Pack::open(source, limits, allocator);
    if (pack && pack->fileSize() != bytes.size()) std::abort();
    if (pack) static_cast<void>(rawOf(*pack, allocator));
    PageData page;
    if (pack && pack->readPage(LevelGrid(), 0, {}, page)) std::abort();
  }
  // One input in four is drawn: of these some while they are loaded, some in too little memory.
  const bool is_drawn = (choice >> 22) % 4 == 0, is_streamed = is_drawn && (choice >> 24) % 2 == 0;
  runtime::AssetOptions options{limits, allocator};
  if (is_drawn && (choice >> 25) % 4 == 0) options.memory_budget = 2048 * (1 + (choice >> 27) % 8);
  // None, all, or without the finest.
  if (const int level = static_cast<int>((choice >> 32) % 4) - 1; level >= 0) options.distance_level = level;
  auto asset = runtime::Asset::open(source, options);
  // Where something did not load, the rest answers.
  if (asset && !is_streamed && ((*asset)->loadAll() || (choice >> 34) % 4 == 0))
    playAndAsk(**asset, choice >> 26);
  if (asset && is_drawn) exerciseRenderer(*std::move(asset), choice >> 30, allocator);
}
