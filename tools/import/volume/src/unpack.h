// SPDX-License-Identifier: MIT
// Bytes in the two compressions of OpenVDB and NanoVDB. Safe for hostile input: what does not give exactly
// `out` is false.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace kelp::bake {

// Bytes that one packed byte can become: the most that zlib can make (zlib.net/zlib_tech.html). LZ4, with
// which both write Blosc, makes 255.
inline constexpr std::uint64_t kMostUnpacked = 1032;

bool unpackZip(std::span<const std::uint8_t> in, std::span<std::uint8_t> out);
// CRC-32, as zip files have it.
std::uint32_t zipChecksum(std::span<const std::uint8_t> bytes);
bool unpackBlosc(std::span<const std::uint8_t> in, std::span<std::uint8_t> out);
// The same to `size` bytes behind what `out` holds. Memory is used as they come, of zip, and after the
// block's own head has said as much, of Blosc.
bool appendZip(std::span<const std::uint8_t> in, std::size_t size, std::vector<std::uint8_t>& out);
bool appendBlosc(std::span<const std::uint8_t> in, std::size_t size, std::vector<std::uint8_t>& out);

}  // namespace kelp::bake
