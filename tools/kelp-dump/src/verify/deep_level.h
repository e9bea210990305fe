// SPDX-License-Identifier: MIT
// What the deep checks of solid parts and of fog share: a level as it is stored, and a count of what is wrong
// in it.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "kelp/formats/raw_pack.h"
#include "pack/pack_file.h"
#include "verify/finding.h"

namespace kelp::dump {

struct Place {
  int part = 0;
  int level = 0;
};

struct StoredLevel {
  RawLevel raw;
  glm::ivec3 size{0};  // voxels; cubes of fog
  glm::ivec3 grid{0};
  std::vector<glm::ivec3> brick_of_slot;
};

// Reads all of a level. ToolError.
StoredLevel readStored(PackFile& file, const Place& place);

// Counts the places of one kind in one level and remembers the first.
class Tally {
 public:
  Tally(DeepIssue issue, const Place& place) : issue_(issue), place_(place) {}

  void add(std::optional<glm::ivec3> brick, std::optional<glm::ivec3> voxel, std::string detail = "");
  std::uint64_t count() const { return count_; }
  void report(VerifyReport& into) const;

 private:
  DeepIssue issue_;
  Place place_;
  std::uint64_t count_ = 0;
  std::optional<glm::ivec3> brick_, voxel_;
  std::string detail_;
};

// Compares the clearances of empty bricks with recomputed ones: they may promise emptiness where something
// is, or less than they could.
void compareClearances(const StoredLevel& level, const RawLevel& right, const Place& place,
                       VerifyReport& report);

}  // namespace kelp::dump
