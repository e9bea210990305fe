// SPDX-License-Identifier: MIT
// Small packs made in memory, for tests of everything that reads packs.
#pragma once

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <string>
#include <vector>

#include "kelp/fields/fields.h"
#include "kelp/formats/raw_pack.h"
#include "support/poses.h"
#include "support/surface_above.h"

namespace kelp::test {

// All levels of a volume, every surface voxel with palette entry `material` and a normal away from the
// volume's center.
inline std::vector<RawLevel> levelsOf(fields::Occupancy volume, std::uint8_t material = 0) {
  std::vector<RawLevel> levels;
  std::vector<std::uint64_t> indices = fields::surfaceVoxels(volume, 1);
  while (true) {
    std::vector<fields::SurfaceVoxel> surface;
    const auto sx = static_cast<std::uint64_t>(volume.size.x);
    const auto sy = static_cast<std::uint64_t>(volume.size.y);
    for (const std::uint64_t i : indices) {
      const glm::vec3 center = glm::vec3(static_cast<float>(i % sx), static_cast<float>(i / sx % sy),
                                         static_cast<float>(i / sx / sy)) +
                               0.5f;
      surface.push_back({i, makeAttribute(material, encodeNormal(center - 0.5f * glm::vec3(volume.size)))});
    }
    levels.push_back(fields::buildLevel(volume, surface, 1));
    if (volume.size.x <= 8 && volume.size.y <= 8 && volume.size.z <= 8) return levels;
    indices = surfaceAbove(indices, volume.size);
    volume = fields::coarser(volume);
  }
}

// A part in meters: one meter high, standing on the origin, centerd in x and z.
inline RawPart partOf(const fields::Occupancy& volume, std::vector<Knot> knots,
                      const std::string& name = "part") {
  RawPart part;
  part.name = name;
  part.size = volume.size;
  const float s = 1.0f / static_cast<float>(volume.size.y);
  part.to_object = glm::mat4x3(
      glm::vec3(s, 0, 0), glm::vec3(0, s, 0), glm::vec3(0, 0, s),
      s * glm::vec3(-0.5f * static_cast<float>(volume.size.x), 0, -0.5f * static_cast<float>(volume.size.z)));
  part.knots = std::move(knots);
  part.levels = levelsOf(volume);
  return part;
}

// The pack's bytes; the test fails if it cannot be written.
inline std::vector<std::byte> bytesOf(const RawPack& pack) {
  std::vector<std::byte> bytes;
  const Sink sink = Sink::into(bytes);
  const Result<void> written = writePack(pack, sink);
  EXPECT_TRUE(written) << (written ? "" : written.error().detail);
  return bytes;
}

// One part with straight knots unless others are given, two palette entries.
inline RawPack packOf(const fields::Occupancy& volume, std::vector<Knot> knots = {}) {
  RawPack pack;
  pack.info_json = "{}";
  pack.palette = {Material{{0.8f, 0.4f, 0.1f, 1}, {0, 0, 0}, 0, 0.7f},
                  Material{{0.1f, 0.6f, 0.2f, 1}, {0, 0, 0}, 0, 1}};
  if (knots.empty()) knots = figureKnots(kFigure6[0]);
  pack.parts.push_back(partOf(volume, std::move(knots)));
  return pack;
}

}  // namespace kelp::test
