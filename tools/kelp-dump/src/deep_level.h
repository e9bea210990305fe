// SPDX-License-Identifier: MIT
// A level as it is stored, and a count of what is wrong in it: what the deep checks of solid parts and of fog share.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "finding.h"
#include "kelp/formats/raw_pack.h"
#include "pack_file.h"

namespace kelp::dump {

struct Place {
  int part = 0;
  int level = 0;
};

struct StoredLevel {
  RawLevel raw;
  glm::ivec3 size{0};   // voxels; cubes of fog
  glm::ivec3 grid{0};
  std::vector<glm::ivec3> brick_of_slot;
};

// All of a level. DumpError if it can not be read.
StoredLevel readStored(PackFile& file, const Place& place);

// Of an index into a dense array, x fastest.
glm::ivec3 positionOf(std::uint64_t index, const glm::ivec3& size);

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

// Compares what an empty brick's cell promises with what is right, and counts it in `untrue` or `lesser` if it differs. `right`: the level's cells recomputed.
void compareCell(std::uint32_t stored, std::size_t index, std::span<const std::uint32_t> right, const glm::ivec3& grid, Tally& untrue, Tally& lesser);

}  // namespace kelp::dump
