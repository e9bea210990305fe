// SPDX-License-Identifier: MIT
// Bytes in the two compressions of OpenVDB and NanoVDB. Safe for hostile input: what does not give exactly `out` is false.
#pragma once

#include <cstdint>
#include <span>

namespace kelp::bake {

bool unpackZip(std::span<const std::uint8_t> in, std::span<std::uint8_t> out);
// CRC-32, as zip files have it.
std::uint32_t zipChecksum(std::span<const std::uint8_t> bytes);
bool unpackBlosc(std::span<const std::uint8_t> in, std::span<std::uint8_t> out);

}  // namespace kelp::bake
