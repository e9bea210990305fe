// SPDX-License-Identifier: MIT
// For the web, where there is no zlib.
#include "vox_file.h"

namespace kelp::bake {

std::vector<std::uint8_t> unpackVoxels(const InputFiles& files, const std::string& place,
                                       std::span<const std::uint8_t>, const glm::ivec3&) {
  refuse(Exit::kUnsupported, files.input(), place,
         "is packed as Teardown's models are, which pages cannot read; bake it with kelp-bake");
}

}  // namespace kelp::bake
