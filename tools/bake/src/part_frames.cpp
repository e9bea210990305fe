// SPDX-License-Identifier: MIT
#include "part_frames.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <fmt/format.h>

#include "kelp/import/core/padding.h"
#include "steps.h"

namespace kelp::bake {
namespace {

glm::dmat4 affine(const glm::mat4x3& m) {
  return glm::dmat4(glm::dvec4(m[0], 0), glm::dvec4(m[1], 0), glm::dvec4(m[2], 0), glm::dvec4(m[3], 1));
}

Axis axisOf(const SourcePart& part) { return part.rig.axis.value_or(Axis::kPlusY); }

glm::dmat4 composeExactly(const glm::mat4x3& outer, const glm::mat4x3& inner) {
  return affine(outer) * affine(inner);
}

// Frames with their padding.
void checkSides(const SourceModel& model, const std::vector<Frame>& frames, const ImportSettings& settings,
                const std::filesystem::path& input) {
  for (std::size_t i = 0; i < model.parts.size(); ++i) {
    const SourcePart& part = model.parts[i];
    const glm::ivec3 size =
        part.isVolume() ? part.volumeSize() + 2 * paddingOf(part, settings.pad) : frames[i].size;
    checkPadded(size, settings.pad, partPlace(input, part));
  }
}

// Where parts stand in the object, as a pack holds it.
void checkPlaces(const SourceModel& model, const std::vector<Frame>& frames,
                 const std::filesystem::path& input) {
  const auto areFloats = [](const glm::dmat4& m) {
    bool all = true;
    for (int column = 0; column < 4; ++column)
      for (int row = 0; row < 3; ++row)
        all = all && std::abs(m[column][row]) <= static_cast<double>(std::numeric_limits<float>::max());
    return all;
  };
  for (std::size_t i = 0; i < model.parts.size(); ++i) {
    const SourcePart& part = model.parts[i];
    const glm::dmat4 to_node = part.isVolume() ? affine(part.volumeToNode())
                                               : glm::inverse(frames[i].node_to_voxel),
                     to_object = affine(part.to_object) * to_node;
    if (!areFloats(to_object) || !areFloats(affine(part.to_object)) || !areFloats(affine(part.pivot)))
      throw ToolError(Exit::kInvalid, fmt::format("{}: its place in the scene is beyond what 32-bit floats "
                                                  "can hold; move it towards the origin, or scale the model",
                                                  partPlace(input, part)));
    const double edge = std::cbrt(std::abs(glm::determinant(glm::dmat3(to_object))));
    if (!(edge >= kSmallestVoxel && edge <= kLargestVoxel))
      throw ToolError(
          Exit::kInvalid,
          fmt::format(
              "{}: voxels of {:.4g} m are beyond what 32-bit floats can draw ({:g} to {:g}); scale the model",
              partPlace(input, part), edge, kSmallestVoxel, kLargestVoxel));
  }
}

glm::mat4x3 placed(const glm::dmat3& outer, const glm::mat4x3& inner) {
  return {glm::vec3(outer * glm::dvec3(inner[0])), glm::vec3(outer * glm::dvec3(inner[1])),
          glm::vec3(outer * glm::dvec3(inner[2])), glm::vec3(outer * glm::dvec3(inner[3]))};
}

}  // namespace

std::string partPlace(const std::filesystem::path& input, const SourcePart& part) {
  return fmt::format("{}: part '{}'", input.filename().string(), part.name);
}

// Object meters to a meter of the part's node, in the mean over its axes.
double objectScale(const SourcePart& part) {
  const double scale = std::cbrt(std::abs(glm::determinant(glm::dmat3(part.to_object))));
  return scale > 0 && std::isfinite(scale) ? scale : 1.0;
}

// True if the voxels are the file's own.
bool isVolume(const SourceModel& model) {
  return std::all_of(model.parts.begin(), model.parts.end(),
                     [](const SourcePart& part) { return part.isVolume(); });
}

// The frames of all parts that are meshes. Their voxels are of one size in the object, but for the nudge that
// makes y whole.
std::vector<Frame> makeFrames(const SourceModel& model, const ImportSettings& settings,
                              const std::filesystem::path& input) {
  double voxel = settings.voxel_size.value_or(0.0);
  if (!settings.voxel_size) {
    double longest = 0;
    for (const SourcePart& part : model.parts) {
      if (part.isVolume()) continue;
      const glm::dvec3 extent =
          rigExtent(part.soup, axisOf(part), partPlace(input, part)) * objectScale(part);
      longest = std::max({longest, extent.x, extent.y, extent.z});
    }
    voxel = longest > 0 ? longest / settings.resolution : 1.0;
  }
  std::vector<Frame> frames;
  for (const SourcePart& part : model.parts) {
    Frame& frame = frames.emplace_back();
    if (part.isVolume()) continue;
    const std::string place = partPlace(input, part);
    double size = voxel / objectScale(part);
    if (!settings.voxel_size) size = fitVoxelSize(rigExtent(part.soup, axisOf(part), place).y, size);
    frame = makeFrame(part.soup, axisOf(part), size, place, objectScale(part));
    padFrame(frame, paddingOf(part, settings.pad));
  }
  return frames;
}

void checkFrames(const SourceModel& model, const std::vector<Frame>& frames, const ImportSettings& settings,
                 const std::filesystem::path& input) {
  checkSides(model, frames, settings, input);
  checkPlaces(model, frames, input);
}

glm::mat4x3 voxelsToObject(const SourcePart& part) {
  return glm::mat4x3(glm::dmat4x3(composeExactly(part.to_object, part.volumeToNode())));
}

double placeError(const SourcePart& part) {
  return glm::length(glm::dvec3(voxelsToObject(part)[3]) -
                     glm::dvec3(composeExactly(part.to_object, part.volumeToNode())[3]));
}

void placeInObject(SourceModel& model, const ImportSettings& settings) {
  const Axis up = settings.up.value_or(model.up);
  if (up == Axis::kPlusY && settings.unit == 1) return;
  // As exporters turn: a quarter turn about x or z, for -y half a turn about x.
  const glm::dmat3 outer = settings.unit * glm::dmat3(axisRotation(up));
  for (SourcePart& part : model.parts) {
    part.to_object = placed(outer, part.to_object);
    part.pivot = placed(outer, part.pivot);
  }
}

PartSize partSize(const SourcePart& part, const Frame& frame, const glm::ivec3& pad) {
  PartSize result;
  if (part.grid) {
    result.size = part.grid->size + 2 * pad;
    result.surface_voxels = static_cast<double>(part.grid->surface.size());
    return result;
  }
  if (part.fog) {
    result.size = part.fog->size + 2 * pad;
    result.fog_channels = part.fog->heat.empty() ? 1 : 2;
    return result;
  }
  result.size = frame.size;
  result.triangles = part.soup.triangles.size();
  result.vertices = part.soup.positions.size();
  const glm::dmat3 turn(frame.node_to_voxel);
  for (const TriangleSoup::Triangle& triangle : part.soup.triangles) {
    glm::dvec3 corner[3];
    for (std::size_t i = 0; i < 3; ++i)
      corner[i] = turn * glm::dvec3(part.soup.positions[triangle.vertex[i]]);
    const glm::dvec3 area = 0.5 * glm::abs(glm::cross(corner[1] - corner[0], corner[2] - corner[0]));
    // A triangle narrower than a voxel touches voxels along its length, which it shares with a neighbor.
    const glm::dvec3 extent = glm::max(glm::max(corner[0], corner[1]), corner[2]) -
                              glm::min(glm::min(corner[0], corner[1]), corner[2]);
    const glm::dvec3 touched = area + 0.5 * glm::max(extent - 1.0, glm::dvec3(0));
    result.crossings += area;
    result.surface_voxels += touched.x + touched.y + touched.z;
  }
  result.surface_voxels = std::min(result.surface_voxels, result.voxels());
  return result;
}

bool isPile(const PartSize& part) {
  constexpr double kOverEachOther = 2048, kLong = 1e7;
  for (int axis = 0; axis < 3; ++axis)
    if (part.crossings[axis] > kLong &&
        part.crossings[axis] > kOverEachOther * part.voxels() / part.size[axis])
      return true;
  return false;
}

}  // namespace kelp::bake
