// SPDX-License-Identifier: MIT
#include "scene.h"

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <system_error>
#include <utility>

#include <fmt/format.h>
#include <glm/gtc/matrix_transform.hpp>

#include "kelp/common/console.h"
#include "kelp/common/dense_index.h"
#include "kelp/common/memory.h"
#include "kelp/common/pack_error.h"
#include "kelp/fields/cages.h"
#include "kelp/fields/solid_bits.h"
#include "kelp/formats/raw_level.h"
#include "kelp/rig/raw_clips.h"
#include "kelp/rig/rig.h"

namespace kelp::render {
namespace {

FileSource openFile(const std::string& path) {
  errno = 0;
  auto opened = FileSource::open(path.c_str());
  if (opened) return *std::move(opened);
  const int reason = errno;
  std::error_code ignored;
  if (std::filesystem::is_other(path, ignored) || std::filesystem::is_fifo(path, ignored))
    throw ToolError(
        Exit::kIo,
        path + ": is a pipe or a device, and a pack is read in any order; write it to a file first");
  errno = reason;
  throw ToolError(Exit::kIo, fmt::format("{}: cannot be opened: {}; check the path and its permissions", path,
                                         errno ? std::strerror(errno) : "it is not a file"));
}

// Refuses a level that no part has. Parts may have different numbers of levels; those with fewer draw their
// coarsest.
void checkLevel(const Options& options, const std::string& path, const Pack& pack) {
  int levels = 0;
  for (const Part& part : pack.parts()) levels = std::max(levels, static_cast<int>(part.levels));
  if (options.level.value_or(0) >= levels)
    throw ToolError(Exit::kUsage, fmt::format("--level {}: {} has the levels 0 to {}; name one of them",
                                              *options.level, path, levels - 1));
}

glm::mat4 placeOf(const Item& item) {
  const glm::mat4 at = glm::translate(glm::mat4(1), item.at);
  return glm::scale(glm::rotate(at, static_cast<float>(glm::radians(item.turn)), glm::vec3(0, 1, 0)),
                    glm::vec3(static_cast<float>(item.scale)));
}

// Fog has no distances. It can be shaded all the same, but there is nothing to show of it.
void checkDistances(const Options& options, const std::string& path, const runtime::Asset& pack) {
  if (pack.loadsDistances()) return;
  const bool fog = std::ranges::all_of(pack.pack().parts(),
                                       [](const Part& part) { return part.kind != PartKind::kSolid; });
  if (!fog)
    throw ToolError(Exit::kUnsupported, path + ": holds no distances; bake it again without --no-distance");
  if (options.view == ViewKind::kDistance)
    throw ToolError(Exit::kUnsupported,
                    path + ": is fog, which has no distances; leave it out, or choose another --view");
}

[[noreturn]] void failTooLarge(const std::string& path) {
  throw ToolError(
      Exit::kRuntime,
      fmt::format("{}: its voxels take more than {} MiB, and this machine has no memory for that and "
                  "OpenGL's copy; use one with more memory, or bake it with a lower --resolution",
                  path, mostMemory() >> 20));
}

// Cages of a solid part: cells as it has them, or else of 8 voxels, or of 16 if that is too many.
RawCages cagesOf(const std::string& path, const Pack& pack, int index) {
  const Part& part = pack.parts()[static_cast<std::size_t>(index)];
  const int longest = std::max({part.size.x, part.size.y, part.size.z});
  const int cell = !part.cages.empty() ? part.cages[0].side : longest > 8 * kMostCageCells ? 16 : 8;
  if (longest > cell * kMostCageCells)
    throw ToolError(Exit::kUnsupported,
                    fmt::format("{}: --bend cage: part {} is {} voxels long, and a cage has at most {} cells "
                                "of {}; bake it with a lower --resolution",
                                path, part.name, longest, kMostCageCells, cell));
  // Level 0 in bricks, as bytes, as bits.
  if (2 * denseCount(part.size) + fields::SolidBits::bytes(part.size) > mostMemory()) failTooLarge(path);
  return {cell,
          fields::buildCages(checkPack(path, readRawLevel(pack, index, 0)), part.size, part.levels, cell),
          {},
          {}};
}

}  // namespace

std::uint64_t mostMemory() { return physicalMemory() / 5 * 2; }

Scene::Scene(const Options& options) {
  // Checks the command line against all packs before it reads the first voxel.
  std::uint64_t memory = 0;
  for (const Item& item : options.items) {
    const Key key{item.pack, item.bend, item.caged};
    std::unique_ptr<runtime::Asset>& pack = packs_[key];
    if (!pack) {
      const FileSource file = openFile(item.pack);
      Source source = file.source();
      if (item.bend) {
        memory += source.size;
        if (memory > mostMemory()) failTooLarge(item.pack);
        source = rebent_.try_emplace(key, item.pack, source, *item.bend, item.caged).first->second.source();
      }
      runtime::AssetOptions whole;
      whole.memory_budget = mostMemory();
      if (options.view == ViewKind::kDistance || options.shadesByDistances()) whole.distance_level = 0;
      pack = checkPack(item.pack, runtime::Asset::open(source, whole));
      checkLevel(options, item.pack, pack->pack());
      if (whole.distance_level == 0) checkDistances(options, item.pack, *pack);
    }
    poses_.push_back(checkPack(item.pack, runtime::Pose::create(*pack)));
    posings_.emplace_back(*pack, item);
    if (duration_ == 0) duration_ = posings_.back().duration();
  }
  for (const auto& [key, pack] : packs_) {
    Result<void> loaded = pack->loadAll();
    memory += pack->memory();
    if (memory > mostMemory() ||
        (!loaded && loaded.error().code == ErrorCode::kLimit && loaded.error().offset == Error::kNoOffset))
      failTooLarge(key.path);
    checkPack(key.path, loaded);
  }
  for (std::size_t i = 0; i < options.items.size(); ++i) {
    const Item& item = options.items[i];
    runtime::Instance instance{packs_[{item.pack, item.bend, item.caged}].get(), &poses_[i]};
    instance.to_world = placeOf(item);
    instances_.push_back(instance);
  }
}

void Scene::pose(double seconds) {
  for (std::size_t i = 0; i < poses_.size(); ++i) posings_[i].apply(seconds, poses_[i]);
}

Rebent::Rebent(const std::string& path, const Source& source, Bend bend, bool caged) {
  const Pack pack = checkPack(path, Pack::open(source));
  RawRigs rigs{std::string(pack.infoJson()), {}, rawClips(pack), rawSockets(pack), {}};
  rigs.cages.emplace(pack.parts().size());
  for (const Part& part : pack.parts()) {
    if (!part.cages.empty() && !part.cages[0].influences.empty())
      throw ToolError(Exit::kUnsupported,
                      fmt::format("{}: --bend {}: part {} bends as its joints move; leave --bend out", path,
                                  toString(bend, caged), part.name));
    if (part.sections >= 0)
      throw ToolError(
          Exit::kUnsupported,
          fmt::format("{}: --bend {}: part {} has sections, which are bent by its own cage alone; "
                      "leave --bend out",
                      path, toString(bend, caged), part.name));
    if (caged && part.kind == PartKind::kSolid)
      (*rigs.cages)[rigs.parts.size()] = cagesOf(path, pack, static_cast<int>(rigs.parts.size()));
    RawRig& rest = rigs.parts.emplace_back(restRig(part));
    if (caged && part.kind != PartKind::kSolid) continue;
    rest.bend = bend;
    if (bend == Bend::kShear) rest.roll = 0;
    try {
      checkRest(rest, part.size);
    } catch (const RigError& error) {
      throw ToolError(Exit::kInvalid, fmt::format("{}: --bend {}: part {}: {}", path, toString(bend, caged),
                                                  part.name, error.what()));
    }
  }
  bytes_.reserve(source.size);
  const Sink sink = Sink::into(bytes_);
  checkPack(path, writeRigs(source, rigs, sink));
}

}  // namespace kelp::render
