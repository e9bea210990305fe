// SPDX-License-Identifier: MIT
#include <zlib.h>

#include "import_unpack.h"

namespace kelp::bake {

bool unpackZip(std::span<const std::uint8_t> in, std::span<std::uint8_t> out) {
  uLongf size = out.size();
  return uncompress(out.data(), &size, in.data(), in.size()) == Z_OK && size == out.size();
}

}  // namespace kelp::bake
