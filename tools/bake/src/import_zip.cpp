// SPDX-License-Identifier: MIT
#include <zlib.h>

#include "import_unpack.h"

namespace kelp::bake {

bool unpackZip(std::span<const std::uint8_t> in, std::span<std::uint8_t> out) {
  uLongf size = out.size();
  return uncompress(out.data(), &size, in.data(), in.size()) == Z_OK && size == out.size();
}

std::uint32_t zipChecksum(std::span<const std::uint8_t> bytes) { return static_cast<std::uint32_t>(crc32_z(crc32(0, nullptr, 0), bytes.data(), bytes.size())); }

}  // namespace kelp::bake
