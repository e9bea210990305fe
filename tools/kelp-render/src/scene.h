// SPDX-License-Identifier: MIT
// The packs of a picture, loaded, posed and placed.
#pragma once

#include <compare>
#include <cstddef>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "kelp/formats/source.h"
#include "kelp/formats/spline.h"
#include "kelp/runtime/asset.h"
#include "options.h"
#include "posing.h"

namespace kelp::render {

// Bytes that the voxels of all packs may take, in the form in which they are drawn. OpenGL keeps them too,
// and without a GPU it does so in the same memory.
std::uint64_t mostMemory();

// --bend: a pack in memory whose parts all bend in one way, whatever their rigs say.
class Rebent {
 public:
  // Reads the pack `path` whole. ToolError kInvalid, with part, knot and place, if a rest rig cannot bend so.
  // A part that becomes sheared loses its roll. caged: solid parts get cages, with cells as they had or of 8
  // voxels; else they lose them.
  Rebent(const std::string& path, const Source& source, Bend bend, bool caged);

  // Valid as long as this object.
  Source source() const { return MemorySource(bytes_).source(); }

 private:
  std::vector<std::byte> bytes_;
};

class Scene {
 public:
  // Reads every pack once, even if it is drawn several times; once more for each --bend. ToolError: what is
  // wrong, and with which pack. `options` must outlive the scene.
  explicit Scene(const Options& options);
  Scene(const Scene&) = delete;
  Scene& operator=(const Scene&) = delete;

  // The first clip's duration in seconds; 0: no pack plays a clip.
  double duration() const { return duration_; }
  // Poses everything, `seconds` after each --time. ToolError kInvalid for a pose that turns back or folds.
  void pose(double seconds);
  std::span<const runtime::Instance> instances() const { return instances_; }

  // A pack is read once for each key; several items may draw it.
  struct Key {
    std::string path;
    std::optional<Bend> bend;
    bool caged = false;
    auto operator<=>(const Key&) const = default;
  };
  using Packs = std::map<Key, std::unique_ptr<runtime::Asset>>;
  const Packs& packs() const { return packs_; }

 private:
  std::map<Key, Rebent> rebent_;  // what assets of packs_ read
  Packs packs_;
  std::vector<runtime::Pose> poses_;
  std::vector<Posing> posings_;
  std::vector<runtime::Instance> instances_;
  double duration_ = 0;
};

}  // namespace kelp::render
