// SPDX-License-Identifier: MIT
#include "resident_asset.h"

#include <cstring>
#include <new>

#include "kelp/draw/view.h"
#include "kelp/formats/fog.h"
#include "kelp/formats/page.h"
#include "kelp/runtime/level.h"

namespace kelp::draw {
namespace {

constexpr std::uint32_t kTableComplete = 0x80000000u;

// The meaning of fog's samples, after the tables of the part's levels: shaders/fog.glsl, kelpLoadFog.
std::uint32_t fogWords(const Part& part) {
  return part.fog ? 6 + static_cast<std::uint32_t>(part.levels) +
                        3 * static_cast<std::uint32_t>(part.fog->ramp.size())
                  : 0;
}
void writeFog(const Fog& fog, std::span<std::uint32_t> words) {
  const auto put = [&words](float value) {
    std::memcpy(words.data(), &value, sizeof value);
    words = words.subspan(1);
  };
  for (const float value : {fog.color.r, fog.color.g, fog.color.b, fog.anisotropy, fog.glow}) put(value);
  words[0] = static_cast<std::uint32_t>(fog.ramp.size());
  words = words.subspan(1);
  for (const float extinction : fog.extinction) put(extinction);
  for (const glm::vec3& color : fog.ramp) {
    for (const float value : {color.r, color.g, color.b}) put(value);
  }
}

// The words of the cage that lies behind a level's grid: shaders/instance.glsl.
std::span<const std::uint32_t> cageBehind(const Part& part, const runtime::LevelId& id) {
  if (id.distances || part.cages.empty()) return {};
  return part.cages[static_cast<std::size_t>(id.level)].words;
}

// Of distances; 0: none belong into the pool.
int distanceLevelsOf(const runtime::Asset& asset, std::size_t part, bool distances) {
  return distances && asset.loadsDistances() ? asset.pack().distanceLevels(static_cast<int>(part)) : 0;
}
std::uint32_t tableWords(const Part& part, int distances) {
  return kTableWords * static_cast<std::uint32_t>(part.levels + distances) + fogWords(part);
}

}  // namespace

std::uint64_t gridWords(const runtime::Level& level, std::span<const std::uint32_t> cage) {
  return level.cells.size() + level.pages.size() + 1 + cage.size();
}
std::uint32_t rowsOfPage(const runtime::Level& level, std::uint32_t page) {
  return Pool::rowsFor(pageWords(level.pages[page]));
}

const runtime::Level* ResidentLevel::content() const { return runtime::PageAccess::level(*asset->asset, id); }

const ResidentLevel* ResidentAsset::coarser(const ResidentLevel& level) const {
  const ResidentPart& part = parts[static_cast<std::size_t>(level.id.part)];
  const runtime::LevelId next{level.id.part, level.id.level + 1, level.id.distances};
  return next.level < (next.distances ? part.distances : part.levels) ? &at(next) : nullptr;
}

void writePalette(std::span<const Material> palette, std::span<std::uint32_t> words) {
  for (std::size_t i = 0; i < palette.size(); ++i) {
    const Material& m = palette[i];
    const float entry[kPaletteWords] = {m.base_color.r, m.base_color.g, m.base_color.b,
                                        m.base_color.a, m.emissive.r,   m.emissive.g,
                                        m.emissive.b,   m.metallic,     m.roughness};
    std::memcpy(&words[kPaletteWords * i], entry, sizeof entry);
  }
}

std::uint64_t cellCount(const glm::ivec3& grid) {
  return static_cast<std::uint64_t>(grid.x) * static_cast<std::uint64_t>(grid.y) *
         static_cast<std::uint64_t>(grid.z);
}

float ofPageOrGrid(float priority, std::uint32_t page) {
  if (page != Pool::Block::kGrid) return priority;
  return priority > 0 ? 1.5f * priority : priority + 0.5f;
}

float worthOf(const Pool::Block& block) { return ofPageOrGrid(block.level->worth.value(), block.page); }

ResidentAsset::~ResidentAsset() {
  for (const ResidentLevel* level : levels) delete level;
}

std::uint64_t pageEntry(const ResidentLevel& level, std::uint32_t page) {
  return level.cellsAt() + cellCount(level.grid) + page;
}

void tableOf(const ResidentLevel& level, std::span<std::uint32_t, kTableWords> words) {
  std::fill(words.begin(), words.end(), 0u);
  if (level.grid_row == 0) return;
  words[0] = static_cast<std::uint32_t>(level.cellsAt());
  words[1] = static_cast<std::uint32_t>(pageEntry(level, 0));
  words[2] = static_cast<std::uint32_t>(level.grid.x - 1) |
             static_cast<std::uint32_t>(level.grid.y - 1) << 10 |
             static_cast<std::uint32_t>(level.band) << 20 | (level.complete() ? kTableComplete : 0);
  if (!level.cage.empty())
    words[3] = static_cast<std::uint32_t>(pageEntry(level, 0) + level.page_rows.size() + 1);
}

Result<std::unique_ptr<ResidentAsset>> describe(const runtime::Asset& asset, bool distances,
                                                const Allocator& allocator, Buffer<std::uint32_t>& tables) {
  const std::span<const Part> parts = asset.pack().parts();
  std::unique_ptr<ResidentAsset> fresh(new (std::nothrow) ResidentAsset);
  if (!fresh) return kNoMemory;
  fresh->asset = &asset;
  fresh->watch = runtime::AssetWatch(asset);
  fresh->packed = parts;
  fresh->parts = Buffer<ResidentPart>(allocator);
  fresh->levels = Buffer<ResidentLevel*>(allocator);
  const std::span<const Material> palette = asset.pack().palette();
  const auto palette_words = static_cast<std::uint32_t>(kPaletteWords * palette.size());
  std::uint32_t levels = 0, table_words = palette_words;
  for (std::size_t p = 0; p < parts.size(); ++p) {
    const int fields = distanceLevelsOf(asset, p, distances);
    levels += static_cast<std::uint32_t>(parts[p].levels + fields);
    table_words += tableWords(parts[p], fields);
  }
  if (!fresh->parts.reset(parts.size()) || !fresh->levels.reset(levels) || !tables.reset(table_words))
    return kNoMemory;
  writePalette(palette, tables.span());
  std::uint32_t next = 0, table = palette_words;
  for (std::size_t p = 0; p < parts.size(); ++p) {
    const int fields = distanceLevelsOf(asset, p, distances);
    fresh->parts[p] = {next,   parts[p].levels,
                       fields, parts[p].levels,
                       {},     glm::vec4(glm::vec3(parts[p].size), static_cast<float>(parts[p].levels)),
                       table};
    for (int i = 0; i < parts[p].levels + fields; ++i, ++next) {
      auto* const level = new (std::nothrow) ResidentLevel;
      if (!level) return kNoMemory;
      level->asset = fresh.get();
      const bool of_distances = i >= parts[p].levels;
      level->id = {static_cast<int>(p), of_distances ? i - parts[p].levels : i, of_distances};
      level->grid = brickGrid(latticeSize(parts[p].kind, levelSize(parts[p].size, level->id.level)));
      level->table = table + kTableWords * static_cast<std::uint32_t>(i);
      level->cage = cageBehind(parts[p], level->id);
      level->page_rows = Buffer<std::uint32_t>(allocator);
      fresh->levels[next] = level;
    }
    if (parts[p].fog)
      writeFog(*parts[p].fog,
               tables.span().subspan(table + kTableWords * static_cast<std::uint32_t>(parts[p].levels)));
    table += tableWords(parts[p], fields);
  }
  return fresh;
}

std::uint64_t poolBytes(const runtime::Asset& asset, Features features) {
  const std::span<const Part> parts = asset.pack().parts();
  std::uint64_t rows = 0, table_words = kPaletteWords * asset.pack().palette().size();
  for (int p = 0; p < static_cast<int>(parts.size()); ++p) {
    const int fields =
        distanceLevelsOf(asset, static_cast<std::size_t>(p), has(features, Features::kDistances));
    table_words += tableWords(parts[static_cast<std::size_t>(p)], fields);
    const auto add = [&](const runtime::Level* level, const runtime::LevelId& id) {
      if (!level) return;
      rows += Pool::rowsFor(gridWords(*level, cageBehind(parts[static_cast<std::size_t>(p)], id)));
      for (std::uint32_t page = 0; page < level->pages.size(); ++page) rows += rowsOfPage(*level, page);
    };
    for (int l = 0; l < fields; ++l) add(asset.distances(p, l), {p, l, true});
    for (int l = 0; l < parts[static_cast<std::size_t>(p)].levels; ++l) add(asset.level(p, l), {p, l, false});
  }
  return (rows + Pool::rowsFor(table_words)) * Pool::kRowBytes;
}

}  // namespace kelp::draw
