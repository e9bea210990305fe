// SPDX-License-Identifier: MIT
#include "placement.h"

#include <algorithm>

namespace kelp::bake {
namespace {

glm::mat4x3 placed(const glm::dmat3& outer, const glm::mat4x3& inner) {
  return {glm::vec3(outer * glm::dvec3(inner[0])), glm::vec3(outer * glm::dvec3(inner[1])), glm::vec3(outer * glm::dvec3(inner[2])), glm::vec3(outer * glm::dvec3(inner[3]))};
}

bool bendable(const RigDescription& rig) {
  const auto isKnots = [](Target target) { return target == Target::kKnotOffset || target == Target::kKnotTangent; };
  return std::any_of(rig.knots.begin(), rig.knots.end(), [](const RigDescription::Knot& knot) { return knot.tangent || knot.offset != glm::vec3(0); }) ||
         std::any_of(rig.clips.begin(), rig.clips.end(), [&](const RigDescription::Clip& clip) {
           return std::any_of(clip.waves.begin(), clip.waves.end(), [&](const auto& wave) { return isKnots(wave.target); }) ||
                  std::any_of(clip.tracks.begin(), clip.tracks.end(), [&](const auto& track) { return isKnots(track.target); });
         });
}

// Where the voxels of a volume are once it has `pad` more on every side.
struct Padding {
  using Size = glm::vec<3, std::size_t>;
  Size old, edge, size;

  Padding(const glm::ivec3& unpadded, const glm::ivec3& pad) : old(unpadded), edge(pad), size(old + std::size_t{2} * edge) {}
  std::size_t moved(std::size_t x, std::size_t y, std::size_t z) const { return x + edge.x + size.x * (y + edge.y + size.y * (z + edge.z)); }
  template <class T>
  std::vector<T> padded(const std::vector<T>& values) const {
    std::vector<T> out(size.x * size.y * size.z, 0);
    for (std::size_t z = 0; z < old.z; ++z)
      for (std::size_t y = 0; y < old.y; ++y) {
        const auto row = values.begin() + static_cast<std::ptrdiff_t>(old.x * (y + old.y * z));
        std::copy(row, row + static_cast<std::ptrdiff_t>(old.x), out.begin() + static_cast<std::ptrdiff_t>(moved(0, y, z)));
      }
    return out;
  }
};

}  // namespace

void placeInObject(SourceModel& model, const Settings& settings) {
  const Axis up = settings.up.value_or(model.up);
  if (up == Axis::kPlusY && settings.unit == 1) return;
  // As exporters turn: a quarter turn about x or z, for -y half a turn about x.
  const glm::dmat3 outer = settings.unit * glm::dmat3(axisRotation(up));
  for (SourcePart& part : model.parts) {
    part.to_object = placed(outer, part.to_object);
    part.pivot = placed(outer, part.pivot);
  }
}

glm::ivec3 paddingOf(const SourcePart& part, int pad) {
  if (part.carrier) return glm::ivec3(0);
  return {pad, bendable(part.rig) ? 0 : pad, pad};
}

void padFrame(Frame& frame, const glm::ivec3& pad) {
  frame.size += 2 * pad;
  frame.node_to_voxel[3] += glm::dvec4(glm::dvec3(pad), 0);
}

void padGrid(VoxelGrid& grid, const glm::ivec3& pad) {
  if (pad == glm::ivec3(0)) return;
  const Padding padding(grid.size, pad);
  for (SurfaceSample& sample : grid.surface) {
    const Padding::Size& old = padding.old;
    sample.index = padding.moved(sample.index % old.x, sample.index / old.x % old.y, sample.index / (old.x * old.y));
  }
  grid.solid = padding.padded(grid.solid);
  grid.size = glm::ivec3(padding.size);
  grid.to_node[3] = grid.to_node * glm::vec4(-glm::vec3(pad), 1);
}

void padFog(FogGrid& fog, const glm::ivec3& pad) {
  if (pad == glm::ivec3(0)) return;
  const Padding padding(fog.size, pad);
  fog.density = padding.padded(fog.density);
  if (!fog.heat.empty()) fog.heat = padding.padded(fog.heat);
  fog.size = glm::ivec3(padding.size);
  fog.to_node[3] = fog.to_node * glm::vec4(-glm::vec3(pad), 1);
}

}  // namespace kelp::bake
