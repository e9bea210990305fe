// SPDX-License-Identifier: MIT
#include <blosc.h>

#include "import_unpack.h"

namespace kelp::bake {

bool unpackBlosc(std::span<const std::uint8_t> in, std::span<std::uint8_t> out) {
  // The size that the block states is checked against the bytes that there are: blosc_decompress_ctx believes it.
  std::size_t size = 0;
  if (blosc_cbuffer_validate(in.data(), in.size(), &size) != 0 || size != out.size()) return false;
  return out.empty() || blosc_decompress_ctx(in.data(), out.data(), out.size(), 1) == static_cast<int>(out.size());
}

}  // namespace kelp::bake
