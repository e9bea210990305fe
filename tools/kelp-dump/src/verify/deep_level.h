// SPDX-License-Identifier: MIT
// The deep check of solid parts and of fog: a level as it is stored, a count of what is wrong in it, and the
// checks themselves.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "kelp/fields/fields.h"
#include "kelp/formats/raw_pack.h"
#include "pack/pack_file.h"
#include "verify/issue.h"

namespace kelp::dump {

struct LevelPlace {
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
StoredLevel readStored(PackFile& file, const LevelPlace& place);

// Counts the places of one kind in one level and remembers the first.
class Tally {
 public:
  Tally(DeepIssueId issue, const LevelPlace& place) : issue_(issue), place_(place) {}

  void add(std::optional<glm::ivec3> brick, std::optional<glm::ivec3> voxel, std::string detail = "");
  std::uint64_t count() const { return count_; }
  void report(VerifyReport& into) const;

 private:
  DeepIssueId issue_;
  LevelPlace place_;
  std::uint64_t count_ = 0;
  std::optional<glm::ivec3> brick_, voxel_;
  std::string detail_;
};

// Compares the clearances of empty bricks with recomputed ones: they may promise emptiness where something
// is, or less than they could.
void compareClearances(const StoredLevel& level, const RawLevel& right, const LevelPlace& place,
                       VerifyReport& report);

// Computes the distances of a level again and compares. ToolError if they cannot be read.
void checkDistances(PackFile& file, const LevelPlace& place, const fields::Occupancy& occupancy, int threads,
                    VerifyReport& report);

// Compares a level's cage with its voxels: each solid one is in a cell, of its piece, or in a
// cube that is inside, and of empty ones none is of a piece or inside.
void checkCage(const Cage& cage, const LevelPlace& place, const fields::Occupancy& occupancy,
               VerifyReport& report);

// The deep check of a part of fog. It compares the clearances to the voxel, the samples
// that bricks share, and every level's samples and extinction with those of the next finer level. If bricks
// disagree about shared samples, nothing else is checked in that level.
void checkFogDeeply(PackFile& file, int part, int threads, VerifyReport& report);

// The most memory that this takes for a level of `voxels` voxels, in addition to fields::peakBytes.
std::uint64_t deepFogBytes(std::uint64_t voxels, int channels);

// Recomputes what the voxels imply and appends to `report` every difference from what is stored. For each
// level of each solid part it compares: the clearances of all empty bricks, to the voxel; the
// occupancy with that of the next finer level; which voxels have an attribute (at level 0 the surface, above
// it the voxels over a surface voxel); the cage. checkFogDeeply() does the same for fog.
//
// Parts for which `report` lists errors already are left out, as nobody can say what their voxels mean.
// ToolError kRuntime if memory cannot hold the largest level.
void checkDeeply(PackFile& file, VerifyReport& report);

}  // namespace kelp::dump
