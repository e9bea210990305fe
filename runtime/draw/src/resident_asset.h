// SPDX-License-Identifier: MIT
// A host's asset in the renderer: its parts and levels, and where they are in the pool.
#pragma once

#include <algorithm>
#include <memory>
#include <optional>

#include "kelp/runtime/level.h"
#include "kelp/streaming/page_access.h"
#include "pool.h"
#include "worth.h"

namespace kelp::draw {

inline constexpr Error kNoMemory{ErrorCode::kOutOfMemory, "no memory to keep account of an asset"};
inline constexpr float kPinned = 1e30f;  // the priority of coarsest levels, which are never dropped

struct ResidentAsset;

// One level of voxels or of distances of one part in the pool.
struct ResidentLevel {
  ResidentAsset* asset = nullptr;
  runtime::LevelId id;
  glm::ivec3 grid{0};       // bricks
  std::uint32_t table = 0;  // its words in the asset's tables: shaders/instance.glsl
  // Of its cage, which lies behind its grid; empty: it has none.
  std::span<const std::uint32_t> cage;
  Worth worth;
  std::uint32_t grid_row = 0;       // 0: not in the pool
  std::uint32_t resident = 0;       // pages
  std::uint32_t all_rows = 0;       // of all its pages
  std::uint8_t band = 0;            // of distances: the largest squared one of an empty voxel
  Buffer<std::uint32_t> page_rows;  // 0: not in the pool. Empty while the grid is not

  // Null: it is not in memory.
  const runtime::Level* content() const;
  std::uint64_t cellsAt() const { return std::uint64_t{grid_row} * Pool::kRowWords; }
  bool complete() const { return grid_row != 0 && resident == page_rows.size(); }
};

// The level of a part that the frame's draws asked for.
struct Want {
  float pixels = 0;        // that a level-0 voxel covers, at most
  std::int32_t level = 0;  // the finest that is of use
  bool asked = false;
};

struct ResidentPart {
  std::uint32_t first_level = 0;  // in ResidentAsset::levels; those of distances follow those of voxels
  std::int32_t levels = 0;
  std::int32_t distances = 0;  // levels of them
  // The finest level that can be drawn: its grid, and those of all coarser ones, are in the pool; of a caged
  // part so are all bricks of the next coarser one. `levels`: the part cannot be drawn.
  std::int32_t finest = 0;
  Want want;
  glm::vec4 extent{0};      // size, level-0 voxels; levels
  std::uint32_t table = 0;  // that of its finest level
};

struct ResidentAsset {
  const runtime::Asset* asset = nullptr;
  runtime::AssetWatch watch;
  std::span<const Part> packed;  // the asset's own
  std::uint64_t number = 0;      // in the order of add()
  std::uint32_t tables_row = 0;
  // The log has been told of an instance that cannot be drawn; that nothing is in memory, or on the GPU.
  bool told_left_out = false, told_unpumped = false, told_unsent = false;
  std::uint32_t added = 0;  // levels that Residency::pending() counts since add()
  Buffer<ResidentPart> parts;
  Buffer<ResidentLevel*> levels;  // part by part, voxels, then distances, finest first; owned

  ResidentAsset() = default;
  ResidentAsset(const ResidentAsset&) = delete;
  ResidentAsset& operator=(const ResidentAsset&) = delete;
  ~ResidentAsset();

  std::uint32_t palette() const { return tables_row * Pool::kRowWords; }
  ResidentLevel& level(const ResidentPart& part, int level) const {
    return *levels[part.first_level + static_cast<std::size_t>(level)];
  }
  ResidentLevel& distances(const ResidentPart& part, int level) const {
    return *levels[part.first_level + static_cast<std::size_t>(part.levels + level)];
  }
  ResidentLevel& at(const runtime::LevelId& id) const {
    const ResidentPart& part = parts[static_cast<std::size_t>(id.part)];
    return id.distances ? distances(part, id.level) : level(part, id.level);
  }
  // The next coarser level of the same kind; null: there is none.
  const ResidentLevel* coarser(const ResidentLevel& level) const;
};

// Words of a level's cells, of its page table, which ends with the page of kSolidBrick, and of its cage.
std::uint64_t gridWords(const runtime::Level& level, std::span<const std::uint32_t> cage);
std::uint32_t rowsOfPage(const runtime::Level& level, std::uint32_t page);

// The value of a block: that of its level. A grid has more than its pages, and less than the next coarser
// level. `block` must have a level: tables and transfers have none.
float worthOf(const Pool::Block& block);

// The priority of a level's grid or of one of its pages. A grid comes before its pages, and after the next
// coarser level's.
float ofPageOrGrid(float priority, std::uint32_t page);

inline constexpr std::uint32_t kPaletteWords = 9;  // of each entry
// Writes the entries, kPaletteWords each.
void writePalette(std::span<const Material> palette, std::span<std::uint32_t> words);

// Words of a grid of cells.
std::uint64_t cellCount(const glm::ivec3& grid);

// The words of a level in its asset's tables: shaders/instance.glsl. All 0 while its grid is not in the
// pool.
inline constexpr std::uint32_t kTableWords = 4;
void tableOf(const ResidentLevel& level, std::span<std::uint32_t, kTableWords> words);
// The word of the page's entry in the level's page table.
std::uint64_t pageEntry(const ResidentLevel& level, std::uint32_t page);

// Describes an asset of which nothing is in the pool. `distances`: whether those that it loads belong there.
// `tables`: its palette and tables, for the pool. kOutOfMemory.
Result<std::unique_ptr<ResidentAsset>> describe(const runtime::Asset& asset, bool distances,
                                                const Allocator& allocator, Buffer<std::uint32_t>& tables);

}  // namespace kelp::draw
