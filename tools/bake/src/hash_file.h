// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <filesystem>
#include <span>
#include <string>

namespace kelp::bake {

// XXH3-64 of a file's bytes as 16 hexadecimal digits. BakeError kIo if it can not be read.
std::string hashFile(const std::filesystem::path& path);
// The same of bytes in memory.
std::string hashBytes(std::span<const std::uint8_t> bytes);

}  // namespace kelp::bake
