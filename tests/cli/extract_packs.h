// SPDX-License-Identifier: MIT
// Packs whose every voxel is known, to be extracted.
#pragma once

#include <functional>
#include <vector>

#include "process.h"
#include "support/random_pack.h"
#include "support/surface_above.h"
#include "support/test_pack.h"

namespace kelp::test {

// A part's voxels as the test made them.
struct KnownPart {
  fields::Occupancy occupancy;
  std::vector<std::int64_t> attribute;  // of each voxel; -1: none
  glm::mat4x3 to_object{1};

  bool solid(const glm::ivec3& v) const {
    return v.x >= 0 && v.y >= 0 && v.z >= 0 && v.x < occupancy.size.x && v.y < occupancy.size.y &&
           v.z < occupancy.size.z && occupancy.solid[occupancy.index(v)] != 0;
  }
  template <class F>
  void eachVoxel(int margin, F&& f) const {
    for (int z = -margin; z < occupancy.size.z + margin; ++z)
      for (int y = -margin; y < occupancy.size.y + margin; ++y)
        for (int x = -margin; x < occupancy.size.x + margin; ++x) f(glm::ivec3(x, y, z));
  }
};

inline KnownPart knownPart(const glm::ivec3& size, const glm::mat4x3& to_object,
                           const std::function<bool(const glm::ivec3&)>& solid,
                           const std::function<glm::vec3(const glm::ivec3&)>& normal,
                           const std::function<int(const glm::ivec3&)>& entry) {
  KnownPart part{{size, {}}, {}, to_object};
  const std::size_t voxels =
      static_cast<std::size_t>(size.x) * static_cast<std::size_t>(size.y) * static_cast<std::size_t>(size.z);
  part.occupancy.solid.resize(voxels);
  part.attribute.assign(voxels, -1);
  part.eachVoxel(
      0, [&](const glm::ivec3& v) { part.occupancy.solid[part.occupancy.index(v)] = solid(v) ? 1 : 0; });
  part.eachVoxel(0, [&](const glm::ivec3& v) {
    bool surface = false;
    for (int i = 0; i < 27; ++i)
      surface = surface || !part.solid(v + glm::ivec3(i % 3, i / 3 % 3, i / 9) - 1);
    if (part.solid(v) && surface)
      part.attribute[part.occupancy.index(v)] =
          makeAttribute(static_cast<std::uint8_t>(entry(v)), encodeNormal(normal(v)));
  });
  return part;
}

// A ball with a tunnel and an antenna, away from the middle: empty bricks, inner voxels, thin things. Entries
// from 0 to `entries` - 1.
inline KnownPart ball(const glm::mat4x3& to_object, int entries, const glm::ivec3& size = {45, 62, 38}) {
  const glm::vec3 middle(17.3f, 20.1f, 18.2f);
  return knownPart(
      size, to_object,
      [=](const glm::ivec3& v) {
        const glm::vec3 p = glm::vec3(v) + 0.5f - middle;
        return (glm::dot(p, p) < 15 * 15 && p.x * p.x + p.z * p.z > 9) ||
               (v.x == 17 && v.z == 30 && v.y > 20 && v.y < 60) || v == glm::ivec3(0) || v == size - 1;
      },
      [=](const glm::ivec3& v) { return glm::vec3(v) + 0.5f - middle; },
      [=](const glm::ivec3& v) { return (v.x * 7 + v.y * 3 + v.z * 11) % entries; });
}

inline RawPart rawPart(const KnownPart& known, const std::string& name) {
  std::vector<fields::SurfaceVoxel> surface;
  for (std::size_t i = 0; i < known.attribute.size(); ++i)
    if (known.attribute[i] >= 0) surface.push_back({i, static_cast<std::uint32_t>(known.attribute[i])});
  RawPart part;
  part.name = name;
  part.size = known.occupancy.size;
  part.to_object = known.to_object;
  part.knots = figureKnots(kFigure6[0]);
  part.levels.push_back(fields::buildLevel(known.occupancy, surface, 1));
  fields::Occupancy coarse = fields::coarser(known.occupancy);
  std::vector<std::uint64_t> indices;
  for (const fields::SurfaceVoxel& voxel : surface) indices.push_back(voxel.index);
  std::vector<fields::SurfaceVoxel> above;
  for (const std::uint64_t i : surfaceAbove(indices, part.size))
    above.push_back({i, makeAttribute(0, encodeNormal({0, 1, 0}))});
  part.levels.push_back(fields::buildLevel(coarse, above, 1));
  return part;
}

// Entries that differ in everything that a material has.
inline std::vector<Material> paletteOf(int entries) {
  std::vector<Material> palette;
  for (int i = 0; i < entries; ++i) {
    const auto part = [&](int n) { return static_cast<float>((i * n) % 256) / 255.0f; };
    Material& m = palette.emplace_back(Material{{part(37), part(91), part(153), 1}, {0, 0, 0}, 0, 1});
    if (i % 5 == 1) m.metallic = 0.75f, m.roughness = 0.3f;
    if (i % 5 == 2) m.emissive = glm::vec3(m.base_color) * 2.5f;
    if (i % 5 == 3) m.base_color.a = 0.4f, m.roughness = 0.2f;
  }
  return palette;
}

inline std::string writePackFile(const Scratch& folder, const std::string& name,
                                 const std::vector<RawPart>& parts, const std::vector<Material>& palette) {
  RawPack pack;
  pack.info_json = "{}";
  pack.palette = palette;
  pack.parts = parts;
  return folder.write(name, std::span<const std::byte>(writeToMemory(pack)));
}

inline ProcessResult dump(std::vector<std::string> arguments) {
  arguments.insert(arguments.begin(), KELP_DUMP);
  return runProcess(arguments);
}

inline glm::mat4x3 scaled(float edge, const glm::vec3& origin = glm::vec3(0)) {
  return {glm::vec3(edge, 0, 0), glm::vec3(0, edge, 0), glm::vec3(0, 0, edge), origin};
}

inline int srgbOf(float linear) {
  const double c = std::clamp(static_cast<double>(linear), 0.0, 1.0);
  return static_cast<int>(
      std::lround(255 * (c <= 0.0031308 ? 12.92 * c : 1.055 * std::pow(c, 1 / 2.4) - 0.055)));
}

}  // namespace kelp::test
