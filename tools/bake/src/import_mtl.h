// SPDX-License-Identifier: MIT
#pragma once

#include <map>
#include <string>
#include <string_view>

#include "import_image.h"

namespace kelp::bake {

// Reads an MTL library: adds its materials and their images to `out`, answers their indices by name. `name` is the library's, for notices.
// What is missing or damaged makes a notice; BakeError kRuntime where the pictures are beyond `budget`, which all libraries of a model share.
std::map<std::string, std::uint32_t> readMtl(const InputFiles& files, std::string_view text, const std::string& name, PictureBudget& budget, SourceModel& out);

}  // namespace kelp::bake
