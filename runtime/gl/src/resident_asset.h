// SPDX-License-Identifier: MIT
// What the renderer knows of a host's asset: its parts and levels, and where they are in the pool.
#pragma once

#include <algorithm>
#include <memory>
#include <optional>

#include "kelp/streaming/page_access.h"
#include "pool.h"
#include "worth.h"

namespace kelp::gl {

inline constexpr Error kNoMemory{ErrorCode::kOutOfMemory, "no memory to keep account of an asset"};
inline constexpr float kPinned = 1e30f;  // the priority of coarsest levels, which are never dropped

struct ResidentAsset;

// One level of voxels or of distances of one part in the pool.
struct ResidentLevel {
  ResidentAsset* asset = nullptr;
  std::int32_t part = 0;
  std::int32_t level = 0;
  bool distances = false;
  glm::ivec3 grid{0};       // bricks
  std::uint32_t table = 0;  // its three words in the asset's tables: shaders/instance.glsl
  Worth worth;
  std::uint32_t grid_row = 0;       // 0: not in the pool
  std::uint32_t resident = 0;       // pages
  std::uint32_t all_rows = 0;       // of all its pages
  std::uint8_t band = 0;            // of distances: the largest squared one of an empty voxel
  Buffer<std::uint32_t> page_rows;  // 0: not in the pool. Empty while the grid is not

  std::uint64_t cellsAt() const { return std::uint64_t{grid_row} * Pool::kRowWords; }
  bool complete() const { return grid_row != 0 && resident == page_rows.size(); }
};

// What the frame's draws asked for of a part.
struct Want {
  float pixels = 0;        // that a level-0 voxel covers, at most
  std::int32_t level = 0;  // the finest that is of use
  bool asked = false;
};

struct ResidentPart {
  std::uint32_t first_level = 0;  // in ResidentAsset::levels; those of distances follow those of voxels
  std::int32_t levels = 0;
  std::int32_t distances = 0;  // levels of them
  // The finest level whose grid, and those of all coarser ones, are in the pool. `levels`: the part cannot be
  // drawn.
  std::int32_t finest = 0;
  Want want;
  glm::vec4 extent{0};      // size, level-0 voxels; levels
  std::uint32_t table = 0;  // that of its finest level
};

struct ResidentAsset {
  const runtime::Asset* asset = nullptr;
  runtime::AssetWatch watch;
  std::span<const Part> packed;  // the asset's own
  std::uint32_t tables_row = 0;
  bool told_left_out = false;  // the log has been told of an instance that cannot be drawn
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
  // The next coarser level of the same kind; null: there is none.
  const ResidentLevel* coarser(const ResidentLevel& level) const;
};

// What a level consists of, if the asset has it.
struct LevelContent {
  std::span<const std::uint32_t> cells;
  std::span<const PageInfo> pages;       // of voxels
  std::span<const std::uint32_t> codes;  // of distances, all pages

  std::uint32_t pageCount() const;
  // Words of the cells and of the page table. That of voxels ends with the page of kSolidBrick.
  std::uint64_t gridWords() const { return cells.size() + pageCount() + (codes.empty() ? 1 : 0); }
  std::uint32_t rowsOfPage(std::uint32_t page) const;
  // A page of distances.
  std::span<const std::uint32_t> codesOfPage(std::uint32_t page) const;
};
std::optional<LevelContent> contentOf(const ResidentLevel& level);

// What the block is worth: what its level is. A grid is worth more than its pages, and less than the next
// coarser level. `block` must have a level: tables and transfers have none.
float worthOf(const Pool::Block& block);

// The priority of a level's grid or of one of its pages. A grid comes before its pages, and after the next
// coarser level's.
float ofPageOrGrid(float priority, std::uint32_t page);

inline constexpr std::uint32_t kPaletteWords = 9;  // of each entry
// Writes the entries, kPaletteWords each.
void writePalette(std::span<const Material> palette, std::span<std::uint32_t> words);

// Words of a grid of cells.
std::uint64_t cellCount(const glm::ivec3& grid);

// The three words of a level in its asset's tables: shaders/instance.glsl. All 0 while its grid is not in the
// pool.
inline constexpr std::uint32_t kTableWords = 3;
void tableOf(const ResidentLevel& level, std::span<std::uint32_t, kTableWords> words);
// The word of the page's entry in the level's page table.
std::uint64_t pageEntry(const ResidentLevel& level, std::uint32_t page);

// Describes an asset of which nothing is in the pool. `distances`: whether those that it loads belong there.
// `tables`: its palette and tables, for the pool. kOutOfMemory.
Result<std::unique_ptr<ResidentAsset>> describe(const runtime::Asset& asset, bool distances,
                                                const Allocator& allocator, Buffer<std::uint32_t>& tables);

}  // namespace kelp::gl
