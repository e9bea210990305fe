// SPDX-License-Identifier: MIT
// Random packs that keep every rule of formats/SPEC.md, and packs in memory. The voxels make no sense as a
// shape (the emptiness that cells and codes promise is random), they are only well formed.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include "kelp/formats/raw_pack.h"
#include "kelp/formats/sweep.h"

namespace kelp::test {

// Writes a pack into memory; fails the test, and answers nothing, when the writer refuses.
inline std::vector<std::byte> writeToMemory(const RawPack& pack, int threads = 1) {
  std::vector<std::byte> bytes;
  Sink sink;
  sink.user = &bytes;
  sink.write = [](void* user, std::span<const std::byte> more) {
    std::vector<std::byte>& all = *static_cast<std::vector<std::byte>*>(user);
    all.insert(all.end(), more.begin(), more.end());
    return true;
  };
  const Result<void> written = writePack(pack, sink, threads);
  EXPECT_TRUE(written) << toString(written.error().code) << ": " << written.error().detail;
  if (!written) bytes.clear();
  return bytes;
}

struct RandomPackOptions {
  int parts = 3;
  int max_side = 40;  // level-0 voxels
  int max_levels = 4;
  int clips = 2;
  int sockets = 2;
};

class RandomPack {
 public:
  explicit RandomPack(std::uint32_t seed, const RandomPackOptions& options = {})
      : random_(seed), options_(options) {}

  RawPack make() {
    RawPack pack;
    pack.info_json = "{\"tool\":\"random\",\"seed\":" + std::to_string(random_()) + "}";
    pack.palette.resize(static_cast<std::size_t>(between(1, 256)));
    for (Material& material : pack.palette) {
      material.base_color = {unit(), unit(), unit(), unit()};
      material.emissive = {4 * unit(), 0, unit()};
      material.metallic = unit();
      material.roughness = unit();
    }
    for (int i = 0; i < options_.parts; ++i) pack.parts.push_back(makePart(i, pack.palette.size()));
    for (int i = 0; i < options_.clips; ++i) pack.clips.push_back(makeClip(i, pack.parts));
    for (int i = 0; i < options_.sockets; ++i) pack.sockets.push_back(makeSocket(i, options_.parts));
    return pack;
  }

  // Bricks over a level of `size` voxels; about `filled` of them are stored.
  RawLevel makeLevel(const glm::ivec3& size, std::size_t palette_size, float filled) {
    RawLevel level;
    const glm::ivec3 grid = brickGrid(size);
    std::vector<std::pair<std::uint64_t, std::size_t>> order;  // Morton code, cell
    for (int z = 0; z < grid.z; ++z) {
      for (int y = 0; y < grid.y; ++y) {
        for (int x = 0; x < grid.x; ++x) {
          const std::size_t cell = level.cells.size();
          level.cells.push_back(static_cast<std::uint32_t>(random_()) & ~kCellSolid);
          const bool whole = 8 * x + 8 <= size.x && 8 * y + 8 <= size.y && 8 * z + 8 <= size.z;
          if (whole && unit() < 0.1f)
            level.cells.back() = kCellInside;
          else if (unit() < filled)
            order.emplace_back(mortonCode({x, y, z}), cell);
        }
      }
    }
    if (order.empty()) order.emplace_back(0, 0);  // even if it was inside
    std::sort(order.begin(), order.end());
    for (std::size_t slot = 0; slot < order.size(); ++slot) {
      const int cell = static_cast<int>(order[slot].second);
      level.cells[order[slot].second] = kCellSolid | static_cast<std::uint32_t>(slot);
      addBrick(level, {cell % grid.x, cell / grid.x % grid.y, cell / grid.x / grid.y}, size, palette_size);
    }
    return level;
  }

 private:
  int between(int low, int high) { return std::uniform_int_distribution<int>(low, high)(random_); }
  float unit() { return std::uniform_real_distribution<float>(0.0f, 1.0f)(random_); }
  glm::vec3 vector(float reach) {
    return {reach * (2 * unit() - 1), reach * (2 * unit() - 1), reach * (2 * unit() - 1)};
  }

  void addBrick(RawLevel& level, const glm::ivec3& brick, const glm::ivec3& size, std::size_t palette_size) {
    const float solid = 0.02f + 0.9f * unit();
    int rank = 0;
    for (int i = 0; i < kBrickVoxels; ++i) {
      if (i % 64 == 0) rank = 0;
      const glm::ivec3 voxel = brick * kBrickSide + glm::ivec3(i & 7, (i >> 3) & 7, i >> 6);
      const bool inside = voxel.x < size.x && voxel.y < size.y && voxel.z < size.z;
      // Voxel 0 of a brick is always within the level: it becomes the one surface voxel that there must be.
      if (!inside || (i > 0 && unit() >= solid)) {
        level.codes.push_back(static_cast<std::uint8_t>(between(0, kSurfaceCode - 1)));
      } else if (i > 0 && unit() < 0.2f) {
        level.codes.push_back(kInnerCode);
      } else {
        level.codes.push_back(static_cast<std::uint8_t>(kSurfaceCode + rank++));
        level.attributes.push_back(
            makeAttribute(static_cast<std::uint8_t>(between(0, static_cast<int>(palette_size) - 1)),
                          static_cast<std::uint32_t>(random_()) & 0xffffffu));
      }
    }
  }

  RawPart makePart(int index, std::size_t palette_size) {
    RawPart part;
    part.name = "part \xc3\xa9 " + std::to_string(index);
    part.parent = between(-1, index - 1);
    part.size = {between(1, options_.max_side), between(1, options_.max_side), between(1, options_.max_side)};
    part.to_object[0] = {0.01f + unit(), 0, 0};
    part.to_object[1] = {0, 0.01f + unit(), unit()};
    part.to_object[2] = {0, 0, -0.01f - unit()};
    part.to_object[3] = vector(10);
    part.pivot[3] = vector(10);
    const int knots = between(2, 5);
    const float height = static_cast<float>(part.size.y);
    for (int k = 0; k < knots; ++k) {
      const float at = k + 1 == knots ? 1.0f : static_cast<float>(k) / static_cast<float>(knots - 1);
      const glm::vec3 aside = vector(5);
      part.knots.push_back({at,
                            {aside.x / height, at, aside.z / height},
                            {aside.z / height, 0.2f + 2 * unit(), aside.y / height}});
    }
    part.automatic_tangents = 2;
    if (part.parent >= 0 && index % 2 == 0) part.parent_at = unit();
    const float roll = 3 * unit() - 1.5f;
    if (index % 3 == 2 && checkSweep(part.knots, part.size, roll)) {
      part.bend = Bend::kSweep;
      part.roll = roll;
    }
    const int levels = between(1, options_.max_levels);
    for (int level = 0; level < levels; ++level) {
      part.levels.push_back(makeLevel(levelSize(part.size, level), palette_size, unit()));
    }
    return part;
  }

  RawClip makeClip(int index, const std::vector<RawPart>& parts) {
    RawClip clip;
    clip.name = "clip" + std::to_string(index);
    clip.duration = 0.1f + 5 * unit();
    for (int i = between(0, 3); i > 0; --i) {
      const int part = between(0, static_cast<int>(parts.size()) - 1);
      const int knot = between(0, static_cast<int>(parts[static_cast<std::size_t>(part)].knots.size()) - 1);
      clip.waves.push_back({static_cast<std::uint32_t>(part), static_cast<std::uint32_t>(knot),
                            unit() < 0.5f ? Target::kKnotOffset : Target::kKnotTangent, vector(3),
                            0.1f + unit(), unit()});
    }
    for (int i = between(0, 4); i > 0; --i) {
      RawTrack track;
      track.part = static_cast<std::uint32_t>(between(0, static_cast<int>(parts.size()) - 1));
      track.target = static_cast<Target>(between(0, 4));
      if (track.target <= Target::kKnotTangent) {
        track.knot =
            static_cast<std::uint32_t>(between(0, static_cast<int>(parts[track.part].knots.size()) - 1));
      }
      track.interpolation = static_cast<Interpolation>(between(0, 2));
      float time = unit();
      for (int key = between(1, 4); key > 0; --key, time += 0.01f + unit()) {
        Key k;
        k.time = time;
        k.value =
            track.target == Target::kPartRotation ? glm::vec4(0.6f, 0, 0, 0.8f) : glm::vec4(vector(2), 0);
        if (track.interpolation == Interpolation::kCubic) k.in = k.out = glm::vec4(vector(1), 0);
        track.keys.push_back(k);
      }
      clip.tracks.push_back(track);
    }
    return clip;
  }

  RawSocket makeSocket(int index, int parts) {
    RawSocket socket;
    socket.name = "socket \xc3\xa9 " + std::to_string(index);
    socket.part = static_cast<std::uint32_t>(between(0, parts - 1));
    socket.at = unit();
    socket.offset = glm::vec2(vector(2));
    const float half = 3 * unit();
    socket.rotation = glm::quat(std::cos(half), 0.6f * std::sin(half), 0, 0.8f * std::sin(half));
    return socket;
  }

  std::mt19937 random_;
  RandomPackOptions options_;
};

inline RawPack makeRandomPack(std::uint32_t seed, const RandomPackOptions& options = {}) {
  return RandomPack(seed, options).make();
}

}  // namespace kelp::test
