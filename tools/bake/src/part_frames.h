// SPDX-License-Identifier: MIT
// Where the parts of a model are voxelized, and where they stand in the object.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "kelp/bake/bake.h"

namespace kelp::bake {

// "model.glb: part 'leaf'", for errors.
std::string partPlace(const std::filesystem::path& input, const SourcePart& part);

// Object meters to a meter of the part's node, in the mean over its axes.
double objectScale(const SourcePart& part);

// True if the voxels are the file's own.
bool isVolume(const SourceModel& model);

// The padded frames of all parts that are meshes; others have an empty one. Their voxels have one size in the
// object, except for the nudge that makes y whole.
std::vector<Frame> makeFrames(const SourceModel& model, const ImportSettings& settings,
                              const std::filesystem::path& input);

// ToolError where a padded part has too many voxels along a side, or stands where floats cannot hold it.
void checkFrames(const SourceModel& model, const std::vector<Frame>& frames, const ImportSettings& settings,
                 const std::filesystem::path& input);

// Voxels of a part that is a volume by now -> the object; and how far floats move the part's corner, in
// meters.
glm::mat4x3 voxelsToObject(const SourcePart& part);
double placeError(const SourcePart& part);

}  // namespace kelp::bake
