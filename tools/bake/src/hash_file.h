// SPDX-License-Identifier: MIT
#pragma once

#include <filesystem>
#include <string>

namespace kelp::bake {

// XXH3-64 of a file's bytes as 16 hexadecimal digits. BakeError kIo if it can not be read.
std::string hashFile(const std::filesystem::path& path);

}  // namespace kelp::bake
