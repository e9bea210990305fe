// SPDX-License-Identifier: MIT
// Small worlds for tests of the page codec: levels whose codes are found voxel by voxel, cut into pages.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <functional>
#include <random>
#include <vector>

#include <glm/geometric.hpp>
#include <glm/vec3.hpp>

#include "kelp/formats/brick.h"
#include "page_codec.h"

namespace kelp::page_test {

struct World {
  glm::ivec3 size{0};
  std::vector<std::uint8_t> codes;  // 0, 64 or 128, x fastest

  std::uint8_t at(const glm::ivec3& v) const {
    if (v.x < 0 || v.y < 0 || v.z < 0 || v.x >= size.x || v.y >= size.y || v.z >= size.z) return 0;
    return codes[static_cast<std::size_t>(v.x + size.x * (v.y + size.y * v.z))];
  }
};

template <class F>
void forEachVoxel(const glm::ivec3& size, const F& visit) {
  for (int z = 0; z < size.z; ++z)
    for (int y = 0; y < size.y; ++y)
      for (int x = 0; x < size.x; ++x) visit(glm::ivec3(x, y, z));
}

inline World makeWorld(const glm::ivec3& size, const std::function<bool(const glm::ivec3&)>& isSolid) {
  World solid{size, {}}, world;
  forEachVoxel(size, [&](const glm::ivec3& v) { solid.codes.push_back(isSolid(v) ? 128 : 0); });
  world = solid;
  std::size_t i = 0;
  forEachVoxel(size, [&](const glm::ivec3& v) {
    bool open = false;
    forEachVoxel(glm::ivec3(3), [&](const glm::ivec3& d) { open = open || solid.at(v + d - 1) == 0; });
    if (world.codes[i] != 0 && open) world.codes[i] = 64;
    ++i;
  });
  return world;
}

inline World coarser(const World& fine) {
  World coarse{levelSize(fine.size, 1), {}};
  forEachVoxel(coarse.size, [&](const glm::ivec3& v) {
    bool solid = false, surface = false;
    forEachVoxel(glm::ivec3(2), [&](const glm::ivec3& d) {
      const std::uint8_t code = fine.at(2 * v + d);
      solid = solid || code != 0;
      surface = surface || code == 64;
    });
    coarse.codes.push_back(surface ? 64 : solid ? 128 : 0);
  });
  return coarse;
}

using Look = std::function<std::uint32_t(const glm::ivec3&)>;  // the attribute of a voxel

struct TestPage {
  std::vector<glm::ivec3> bricks;
  std::vector<CoarseBlock> above;
  glm::ivec3 size{0};
  std::uint32_t palette = 1;
  std::vector<std::uint8_t> codes;
  std::vector<std::uint32_t> attributes;

  PageShape shape() const { return {bricks, above, size, palette}; }
};

inline CoarseBlock blockOver(const World& above, const glm::ivec3& brick) {
  CoarseBlock block;
  for (int i = 0; i < 64; ++i) {
    const std::uint8_t code = above.at(4 * brick + glm::ivec3(i & 3, i >> 2 & 3, i >> 4));
    block.solid |= std::uint64_t{code != 0} << i;
    block.surface |= std::uint64_t{code == 64} << i;
  }
  return block;
}

// The pages of a level; above: the next coarser level, or null for the coarsest.
inline std::vector<TestPage> pagesOf(const World& world, const World* above, std::uint32_t palette,
                                     const Look& look, std::size_t most_bricks = kMaxPageBricks) {
  std::vector<glm::ivec3> bricks;
  forEachVoxel(brickGrid(world.size), [&](const glm::ivec3& b) { bricks.push_back(b); });
  std::sort(bricks.begin(), bricks.end(),
            [](const glm::ivec3& a, const glm::ivec3& b) { return mortonCode(a) < mortonCode(b); });
  std::vector<TestPage> pages;
  for (const glm::ivec3& brick : bricks) {
    std::vector<std::uint8_t> codes;
    std::vector<std::uint32_t> attributes;
    forEachVoxel(glm::ivec3(8), [&](const glm::ivec3& v) {
      codes.push_back(world.at(8 * brick + v));
      if (codes.back() == 64) attributes.push_back(look(8 * brick + v));
    });
    if (attributes.empty()) continue;
    if (pages.empty() || pages.back().bricks.size() == most_bricks ||
        pages.back().codes.size() + 512 + 4 * (pages.back().attributes.size() + attributes.size()) > 65536) {
      pages.emplace_back();
      pages.back().size = world.size;
      pages.back().palette = palette;
    }
    TestPage& page = pages.back();
    page.bricks.push_back(brick);
    if (above) page.above.push_back(blockOver(*above, brick));
    page.codes.insert(page.codes.end(), codes.begin(), codes.end());
    page.attributes.insert(page.attributes.end(), attributes.begin(), attributes.end());
  }
  return pages;
}

// The pages of all levels, finest first.
inline std::vector<TestPage> allPages(World world, std::uint32_t palette, const Look& look,
                                      std::size_t most_bricks = kMaxPageBricks) {
  std::vector<TestPage> pages;
  for (bool more = true; more;) {
    more = std::max({world.size.x, world.size.y, world.size.z}) > 8;
    World above = coarser(world);
    for (TestPage& page : pagesOf(world, more ? &above : nullptr, palette, look, most_bricks))
      pages.push_back(std::move(page));
    world = std::move(above);
  }
  return pages;
}

inline bool inBall(const glm::ivec3& v, const glm::vec3& center, float radius) {
  return glm::distance(glm::vec3(v) + 0.5f, center) < radius;
}

// A ball with a bite, in a box that is no multiple of 8, with a look that is flat, smooth or noise.
inline World ballWorld(int side) {
  const glm::vec3 center = glm::vec3(static_cast<float>(side)) * glm::vec3(0.5f, 0.45f, 0.55f);
  const float radius = static_cast<float>(side) * 0.42f;
  return makeWorld({side, side - 3, side + 5}, [=](const glm::ivec3& v) {
    return inBall(v, center, radius) && !inBall(v, center + radius, radius);
  });
}

inline Look flatLook(std::uint32_t palette) {
  return [=](const glm::ivec3& v) {
    const auto cell = static_cast<std::uint32_t>((v.x / 5) * 7 + (v.y / 6) * 31 + v.z / 7);
    return cell * 7 % palette | (cell * 2654435761u & 0xffffff00u);
  };
}
inline Look smoothLook(std::uint32_t palette) {
  return [=](const glm::ivec3& v) {
    const glm::vec3 away = glm::vec3(v) - glm::vec3(20, 18, 22);
    return static_cast<std::uint32_t>(v.x / 9) % palette | encodeNormal(away) << 8;
  };
}
inline Look noiseLook(std::uint32_t palette) {
  return [=](const glm::ivec3& v) {
    std::mt19937 random(static_cast<std::uint32_t>(v.x + 1000 * v.y + 1000000 * v.z));
    const std::uint32_t normal = random() << 8;
    return normal | random() % palette;
  };
}

}  // namespace kelp::page_test
