// SPDX-License-Identifier: MIT
// The content of `info` as plain data.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "pack/pack_file.h"

namespace kelp::dump {

// A level according to the pack's tables and, if it was counted, its voxels.
struct LevelSummary {
  glm::ivec3 size{0};       // voxels
  std::uint64_t cells = 0;  // bricks of the grid, stored or empty
  std::uint64_t pages = 0;
  std::uint64_t stored = 0;  // bytes in the file
  struct Counted {
    std::uint64_t bricks = 0;      // stored ones
    std::uint64_t page_bytes = 0;  // decoded
    std::uint64_t solid = 0;       // voxels
    std::uint64_t surface = 0;     // voxels with an attribute
    std::uint64_t cubes = 0;       // of fog: between its samples
    std::uint64_t foggy = 0;       // cubes that are not clear
  };
  std::optional<Counted> counted;
};

struct DistanceSummary {
  std::uint64_t levels = 0;
  std::uint64_t pages = 0;
  std::uint64_t stored = 0;  // bytes in the file
};

struct CageSummary {
  std::uint64_t pieces = 0;  // cells in cubes of several
  std::uint64_t memory = 0;  // bytes
};
CageSummary summarize(const Cage& cage);
// The parts that nodes of a part's cages follow.
std::set<std::uint16_t> followedParts(const Part& part);

struct PartSummary {
  const Part* part = nullptr;  // of the PackFile's pack
  glm::dvec3 voxel{0};         // edges of a voxel in meters
  std::vector<LevelSummary> levels;
  std::optional<DistanceSummary> distances;  // if there are any
  std::uint64_t stored() const;              // without distances
};

struct ChunkSummary {
  std::string kind;  // fourcc; "other" for header, index and padding
  std::uint64_t count = 0;
  std::uint64_t stored = 0;          // bytes in the file
  std::optional<std::uint64_t> raw;  // bytes decoded; of pages, if they were counted
};

struct Summary {
  std::string path;
  const Pack* pack = nullptr;
  bool counted = false;
  std::vector<PartSummary> parts;
  std::array<std::uint64_t, 256> palette_use{};  // if counted: surface voxels of level 0 that name the entry
  std::vector<ChunkSummary> chunks;              // in the order of first appearance, "other" last

  std::uint64_t storedBytes() const { return pack->fileSize(); }
  std::optional<std::uint64_t> rawBytes() const;
  std::uint64_t voxels() const;         // of the boxes of all parts at level 0, empty ones too
  std::uint64_t surfaceVoxels() const;  // of level 0 of all parts, if counted
};

// Reads only the pack's tables, which are in memory. `count`: also every grid and page. ToolError.
Summary summarize(PackFile& file, bool count);

// Prints as text or JSON.
std::string infoText(const Summary& summary);
std::string infoJson(const Summary& summary);

}  // namespace kelp::dump
