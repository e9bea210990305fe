// SPDX-License-Identifier: MIT
// Random packs that keep every rule of formats/SPEC.md, and packs in memory. The voxels make no sense as a
// shape, they are only well formed: the clearances of cells are random.
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
  const Result<void> written = writePack(pack, Sink::into(bytes), threads);
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
  int joints = 2;
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
    for (int i = 0; i < options_.joints; ++i) pack.joints.push_back(makeJoint(i, options_.parts));
    return pack;
  }

  // One level of `size` voxels, about `filled` of whose bricks hold something.
  RawLevel makeLevel(const glm::ivec3& size, std::size_t palette_size, float filled) {
    return makeLevels(size, 1, palette_size, filled)[0];
  }
  // Levels of a part of `size` voxels, each true to the next finer one.
  std::vector<RawLevel> makeLevels(const glm::ivec3& size, int count, std::size_t palette_size,
                                   float filled) {
    std::vector<RawLevel> levels;
    Voxels voxels = scatter(size, filled);
    for (int level = 0; level < count; ++level) {
      levels.push_back(levelOf(voxels, palette_size));
      voxels = coarser(voxels);
    }
    return levels;
  }

 private:
  // As libstdc++'s distributions; those of other libraries draw other numbers, and so other packs.
  int between(int low, int high) {
    const std::uint32_t range = static_cast<std::uint32_t>(high - low) + 1, least = (0 - range) % range;
    std::uint64_t product = 0;
    do {
      product = std::uint64_t{random_()} * range;
    } while (static_cast<std::uint32_t>(product) < least);
    return low + static_cast<int>(product >> 32);
  }
  float unit() { return std::min(static_cast<float>(random_()) / 4294967296.0f, std::nextafter(1.0f, 0.0f)); }
  glm::vec3 vector(float reach) {
    return {reach * (2 * unit() - 1), reach * (2 * unit() - 1), reach * (2 * unit() - 1)};
  }

  // Dense: 0 empty, kInnerCode or kSurfaceCode.
  struct Voxels {
    glm::ivec3 size{0};
    std::vector<std::uint8_t> codes;

    std::uint8_t at(const glm::ivec3& v) const {
      return v.x < 0 || v.y < 0 || v.z < 0 || v.x >= size.x || v.y >= size.y || v.z >= size.z
                 ? 0
                 : codes[index(v)];
    }
    std::size_t index(const glm::ivec3& v) const {
      return static_cast<std::size_t>(v.x + size.x * (v.y + size.y * v.z));
    }
    template <class F>
    void each(F&& f) const {
      glm::ivec3 v;
      for (v.z = 0; v.z < size.z; ++v.z)
        for (v.y = 0; v.y < size.y; ++v.y)
          for (v.x = 0; v.x < size.x; ++v.x) f(v);
    }
  };

  // Bricks that are full, empty, or of random voxels; the surface is what SPEC.md says.
  Voxels scatter(const glm::ivec3& size, float filled) {
    Voxels out{size, std::vector<std::uint8_t>(static_cast<std::size_t>(size.x * size.y * size.z))};
    const glm::ivec3 grid = brickGrid(size);
    std::vector<float> density(static_cast<std::size_t>(grid.x * grid.y * grid.z));
    const float full = 0.8f * unit();
    for (float& brick : density)
      brick = unit() >= filled ? 0.0f : unit() < full ? 1.0f : 0.02f + 0.9f * unit();
    out.each([&](const glm::ivec3& v) {
      const glm::ivec3 b = v / 8;
      const float solid = density[static_cast<std::size_t>(b.x + grid.x * (b.y + grid.y * b.z))];
      if (solid >= 1 || (solid > 0 && unit() < solid)) out.codes[out.index(v)] = kInnerCode;
    });
    out.codes[0] = kInnerCode;  // something is solid
    out.each([&](const glm::ivec3& v) {
      if (out.at(v) == 0) return;
      for (int i = 0; i < 27; ++i)
        if (out.at(v + glm::ivec3(i % 3, i / 3 % 3, i / 9) - 1) == 0) out.codes[out.index(v)] = kSurfaceCode;
    });
    return out;
  }

  static Voxels coarser(const Voxels& fine) {
    const glm::ivec3 size = levelSize(fine.size, 1);
    Voxels out{size, std::vector<std::uint8_t>(static_cast<std::size_t>(size.x * size.y * size.z))};
    fine.each([&](const glm::ivec3& v) {
      std::uint8_t& code = out.codes[out.index(v / 2)];
      if (const std::uint8_t below = fine.at(v); below != 0 && code != kSurfaceCode) code = below;
    });
    return out;
  }

  // The clearances of empty bricks are random.
  RawLevel levelOf(const Voxels& voxels, std::size_t palette_size) {
    RawLevel level;
    const glm::ivec3 grid = brickGrid(voxels.size);
    std::vector<std::pair<std::uint64_t, std::size_t>> order;  // Morton code, cell
    const auto codeOf = [&](std::size_t cell, int i) {
      const auto c = static_cast<int>(cell);
      return voxels.at(8 * glm::ivec3(c % grid.x, c / grid.x % grid.y, c / grid.x / grid.y) +
                       glm::ivec3(i & 7, (i >> 3) & 7, i >> 6));
    };
    for (std::size_t cell = 0; cell < static_cast<std::size_t>(grid.x * grid.y * grid.z); ++cell) {
      bool surface = false, inner = false;
      for (int i = 0; i < kBrickVoxels; ++i) {
        surface = surface || codeOf(cell, i) == kSurfaceCode;
        inner = inner || codeOf(cell, i) == kInnerCode;
      }
      level.cells.push_back(surface ? kCellSolid
                            : inner ? kCellInside
                                    : static_cast<std::uint32_t>(random_()) & 127u << kCellClearanceShift);
      const auto c = static_cast<int>(cell);
      if (surface)
        order.emplace_back(mortonCode({c % grid.x, c / grid.x % grid.y, c / grid.x / grid.y}), cell);
    }
    std::sort(order.begin(), order.end());
    for (std::size_t slot = 0; slot < order.size(); ++slot) {
      level.cells[order[slot].second] = kCellSolid | static_cast<std::uint32_t>(slot);
      int rank = 0;
      for (int i = 0; i < kBrickVoxels; ++i) {
        if (i % 64 == 0) rank = 0;
        const std::uint8_t code = codeOf(order[slot].second, i);
        level.codes.push_back(code == kSurfaceCode ? static_cast<std::uint8_t>(code + rank++) : code);
        if (code != kSurfaceCode) continue;
        const auto color = static_cast<std::uint8_t>(between(0, static_cast<int>(palette_size) - 1));
        level.attributes.push_back(makeAttribute(color, static_cast<std::uint32_t>(random_()) & 0xffffffu));
      }
    }
    return level;
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
    part.levels = makeLevels(part.size, levels, palette_size, unit());
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

  RawJoint makeJoint(int index, int parts) {
    RawJoint joint;
    joint.name = "joint \xc3\xa9 " + std::to_string(index / 2);
    joint.parent = between(-1, index - 1);
    joint.inverse_bind[0] = {0.01f + unit(), unit(), unit()};
    joint.inverse_bind[1].z = 2 * unit();
    joint.inverse_bind[3] = vector(9);
    for (int part = 0; part < parts; ++part)
      if (unit() < 0.5f) joint.parts.push_back(static_cast<std::uint32_t>(part));
    return joint;
  }

  std::mt19937 random_;
  RandomPackOptions options_;
};

inline RawPack makeRandomPack(std::uint32_t seed, const RandomPackOptions& options = {}) {
  return RandomPack(seed, options).make();
}

}  // namespace kelp::test
