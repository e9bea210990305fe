// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <string_view>

#include <glm/glm.hpp>

#include "kelp/import/core/source_model.h"
#include "kelp/import/image/image.h"

namespace kelp::bake {

// Place of a picture (-s, -o): at scale u + offset, v from below.
struct MapPlace {
  glm::dvec2 scale{1}, offset{0};
  bool operator==(const MapPlace&) const = default;
};

// Indices into SourceModel::materials by name, and for those with pictures where these lie.
struct MtlMaterials {
  std::map<std::string, std::uint32_t> by_name;
  std::map<std::uint32_t, MapPlace> places;
};

// Reads an MTL library: adds its materials and their images to `out`. `name` is the library's, for notices.
// Missing or damaged data makes a notice. ToolError kRuntime if the pictures exceed `budget`, which all
// libraries of a model share.
MtlMaterials readMtl(const InputFiles& files, std::string_view text, const std::string& name,
                     PictureBudget& budget, SourceModel& out);

}  // namespace kelp::bake
