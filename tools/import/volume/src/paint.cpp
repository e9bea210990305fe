// SPDX-License-Identifier: MIT
#include "solid.h"

#include "kelp/formats/brick.h"
#include "kelp/import/core/source_model.h"

namespace kelp::bake {
namespace {

bool within(const glm::dvec3& value, double most) {
  for (int i = 0; i < 3; ++i)
    if (!(value[i] >= 0 && value[i] <= most)) return false;
  return true;
}

}  // namespace

bool paintedVoxel(const VolumeSampler& attribute, const glm::dvec3& place, PaintedVoxel& voxel) {
  if (!onLattice(place)) return false;
  const VolumeCell cell = attribute.cellAt(glm::ivec3(glm::round(place)));
  const glm::dvec3& value = cell.value;
  if (!cell.active || !within(value, 4095) || value.x >= static_cast<double>(kMaxPalette)) return false;
  voxel.entry = static_cast<std::size_t>(value.x);
  voxel.normal =
      decodeNormal(static_cast<std::uint32_t>(value.y) | static_cast<std::uint32_t>(value.z) << 12);
  return true;
}

std::vector<Material> paintedPalette(const VolumeGrid& palette) {
  const VolumeSampler sampler(palette);
  std::vector<Material> entries;
  for (int i = 0; i < static_cast<int>(kMaxPalette); ++i) {
    glm::dvec3 rows[3];
    for (int row = 0; row < 3; ++row) {
      const VolumeCell cell = sampler.cellAt({i, row, 0});
      if (!cell.active) return entries;
      rows[row] = cell.value;
    }
    if (!within(rows[0], 1) || !within(rows[1], std::numeric_limits<float>::max()) || !within(rows[2], 1))
      return {};
    Material& entry = entries.emplace_back();
    entry.base_color = glm::vec4(glm::vec3(rows[0]), static_cast<float>(rows[2].x));
    entry.emissive = glm::vec3(rows[1]);
    entry.metallic = static_cast<float>(rows[2].y);
    entry.roughness = static_cast<float>(rows[2].z);
  }
  return entries;
}

}  // namespace kelp::bake
