// SPDX-License-Identifier: MIT
#include "pack/level_grid.h"

#include <utility>

#include <fmt/format.h>

#include "kelp/formats/level.h"
#include "kelp/formats/raw_level.h"
#include "text/text.h"

namespace kelp::dump {

std::string levelText(const Pack& pack, std::uint32_t part, int level) {
  return fmt::format("part {} '{}', level {}", part, nameText(pack.parts()[part].name), level);
}

LevelReader openLevel(PackFile& file, std::uint32_t part, int level) {
  Result<LevelReader> reader = LevelReader::open(file.pack(), static_cast<int>(part), level);
  if (!reader) file.fail(reader.error(), levelText(file.pack(), part, level));
  return *std::move(reader);
}

void readLevelPage(PackFile& file, const LevelReader& level, std::size_t index, PageData& page) {
  if (const Result<void> read = level.readPage(index, page); !read)
    file.fail(read.error(),
              levelText(file.pack(), static_cast<std::uint32_t>(level.grid().part), level.grid().level));
}

RawLevel readLevelData(PackFile& file, std::uint32_t part, int level) {
  Result<RawLevel> raw = readRawLevel(file.pack(), static_cast<int>(part), level);
  if (!raw) file.fail(raw.error(), levelText(file.pack(), part, level));
  return *std::move(raw);
}

std::vector<glm::ivec3> bricksBySlot(const LevelGrid& grid) {
  std::vector<glm::ivec3> bricks;
  for (std::uint32_t slot = 0; slot < grid.bricks.size(); ++slot) bricks.push_back(grid.place(slot));
  return bricks;
}

}  // namespace kelp::dump
