// SPDX-License-Identifier: MIT
// The grid and the pages of one level, with errors that name the part and the level.
#pragma once

#include <string>
#include <vector>

#include <glm/vec3.hpp>

#include "kelp/formats/level.h"
#include "kelp/formats/raw_pack.h"
#include "pack/pack_file.h"

namespace kelp::dump {

// "part 0 'reed', level 1".
std::string levelText(const Pack& pack, std::uint32_t part, int level);

// ToolError if it cannot be read.
LevelReader openLevel(PackFile& file, std::uint32_t part, int level);
void readLevelPage(PackFile& file, const LevelReader& level, std::size_t index, PageData& page);
// All of a level.
RawLevel readLevelData(PackFile& file, std::uint32_t part, int level);

// The position in the grid of every stored brick, by slot.
std::vector<glm::ivec3> bricksBySlot(const LevelGrid& grid);

}  // namespace kelp::dump
