// SPDX-License-Identifier: MIT
// The content of a rig file (*.rig.json): one rig, or the rigs of parts by name.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "kelp/formats/pack.h"
#include "kelp/rig/rig.h"

namespace kelp {

struct RigFile {
  struct PartRig {
    std::string name;    // of the part
    RigDescription rig;  // in the axes of the part's node
    bool operator==(const PartRig&) const = default;
  };
  RigDescription whole;        // of the whole file; says nothing if there are `parts`
  std::vector<PartRig> parts;  // no name twice
  bool operator==(const RigFile&) const = default;

  // The rig of the part of this name; null if there is none.
  const RigDescription* find(std::string_view part) const;
};

// As parseRig and printRig.
RigFile parseRigFile(std::string_view text);
std::string printRigFile(const RigFile& file);

// The axis, in the axes of the part's node, along which a part was baked: by its voxels' rotation against its
// pivot. Nothing if the pivot is rotated otherwise, or skewed.
std::optional<Axis> axisByPlace(const glm::mat4x3& to_object, const glm::mat4x3& pivot);

// A pack as rig files see it, by its INFO, which may be hostile.
struct RiggedPack {
  RiggedPack() = default;
  explicit RiggedPack(const Pack& pack);

  // The rig file has a rig for each part: there are several, sides not counted, or kelp-bake was asked for
  // parts of nodes.
  bool by_part = false;
  std::vector<Axis> axes;   // of each part, in the axes of its node
  bool skinned = false;     // a skin moves its parts; only these have a rig of their own, from a rig file:
  std::vector<bool> given;  // of each part; without a skin, all but sides
  // Of each part: if it is a side of another, that part and the corner, as cornerName(); -1: of those left
  // out; kSections: if it says the sections of that part.
  static constexpr int kSections = -2;
  struct Side {
    std::uint32_t of = 0;
    int corner = -1;
    bool operator==(const Side&) const = default;
  };
  std::vector<std::optional<Side>> sides;

 private:
  void findSides(const Pack& pack);
};

// The rig file that bakes a pack of several parts again: the rigs of all parts, but those that a skin moves.
// Sides are in the rigs of their parts.
RigFile describeParts(const Pack& pack, const RiggedPack& rigged);

}  // namespace kelp
