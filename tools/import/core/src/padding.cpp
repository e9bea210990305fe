// SPDX-License-Identifier: MIT
#include "kelp/import/core/padding.h"

#include <algorithm>

#include "kelp/common/dense_index.h"

namespace kelp::bake {
namespace {

// True if places along the part's axis matter: it bends, or something hangs on its spline.
bool bendable(const SourcePart& part) {
  const RigDescription& rig = part.rig;
  if (part.carries || !rig.sockets.empty()) return true;
  const auto isKnots = [](Target target) {
    return target == Target::kKnotOffset || target == Target::kKnotTangent;
  };
  return std::any_of(
             rig.knots.begin(), rig.knots.end(),
             [](const RigDescription::Knot& knot) { return knot.tangent || knot.offset != glm::vec3(0); }) ||
         std::any_of(rig.clips.begin(), rig.clips.end(), [&](const RigDescription::Clip& clip) {
           return std::any_of(clip.waves.begin(), clip.waves.end(),
                              [&](const auto& wave) { return isKnots(wave.target); }) ||
                  std::any_of(clip.tracks.begin(), clip.tracks.end(),
                              [&](const auto& track) { return isKnots(track.target); });
         });
}

// Where the voxels of a volume are after `pad` more were added on every side.
struct Padding {
  glm::ivec3 old, edge, size;

  Padding(const glm::ivec3& unpadded, const glm::ivec3& pad)
      : old(unpadded), edge(pad), size(old + 2 * edge) {}
  std::size_t moved(const glm::ivec3& voxel) const { return denseIndex(size, voxel + edge); }
  template <class T>
  std::vector<T> padded(const std::vector<T>& values) const {
    std::vector<T> out(denseCount(size), 0);
    for (int z = 0; z < old.z; ++z)
      for (int y = 0; y < old.y; ++y) {
        const auto row = values.begin() + static_cast<std::ptrdiff_t>(denseIndex(old, 0, y, z));
        std::copy(row, row + old.x, out.begin() + static_cast<std::ptrdiff_t>(moved({0, y, z})));
      }
    return out;
  }
};

}  // namespace

glm::ivec3 paddingOf(const SourcePart& part, int pad) {
  if (part.isEmpty()) return glm::ivec3(0);
  return {pad, bendable(part) ? 0 : pad, pad};
}

void padFrame(Frame& frame, const glm::ivec3& pad) {
  frame.size += 2 * pad;
  frame.node_to_voxel[3] += glm::dvec4(glm::dvec3(pad), 0);
}

void padGrid(VoxelGrid& grid, const glm::ivec3& pad) {
  if (pad == glm::ivec3(0)) return;
  const Padding padding(grid.size, pad);
  for (SurfaceSample& sample : grid.surface) sample.index = padding.moved(voxelAt(padding.old, sample.index));
  grid.solid = padding.padded(grid.solid);
  grid.size = padding.size;
  grid.to_node[3] = grid.to_node * glm::vec4(-glm::vec3(pad), 1);
}

void padFog(FogGrid& fog, const glm::ivec3& pad) {
  if (pad == glm::ivec3(0)) return;
  const Padding padding(fog.size, pad);
  fog.density = padding.padded(fog.density);
  if (!fog.heat.empty()) fog.heat = padding.padded(fog.heat);
  fog.size = padding.size;
  fog.to_node[3] = fog.to_node * glm::vec4(-glm::vec3(pad), 1);
}

}  // namespace kelp::bake
