// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <string_view>

#include <glm/glm.hpp>

#include "import_image.h"

namespace kelp::bake {

// Where a picture lies (-s, -o): at (scale u + offset), v from below.
struct MapPlace {
  glm::dvec2 scale{1}, offset{0};
  bool operator==(const MapPlace&) const = default;
};

// Indices into SourceModel::materials, and where the pictures of those lie that have any.
struct MtlMaterials {
  std::map<std::string, std::uint32_t> by_name;
  std::map<std::uint32_t, MapPlace> places;
};

// Reads an MTL library: adds its materials and their images to `out`. `name` is the library's, for notices.
// What is missing or damaged makes a notice; BakeError kRuntime where the pictures are beyond `budget`, which all libraries of a model share.
MtlMaterials readMtl(const InputFiles& files, std::string_view text, const std::string& name, PictureBudget& budget, SourceModel& out);

}  // namespace kelp::bake
