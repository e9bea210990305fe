// SPDX-License-Identifier: MIT
#include <blosc.h>

#include "unpack.h"

namespace kelp::bake {

namespace {

// blosc_decompress_ctx believes the size that the block states, so that is checked against the bytes first.
bool saysSize(std::span<const std::uint8_t> in, std::size_t wanted) {
  std::size_t size = 0;
  return blosc_cbuffer_validate(in.data(), in.size(), &size) == 0 && size == wanted;
}

}  // namespace

bool unpackBlosc(std::span<const std::uint8_t> in, std::span<std::uint8_t> out) {
  if (!saysSize(in, out.size())) return false;
  return out.empty() ||
         blosc_decompress_ctx(in.data(), out.data(), out.size(), 1) == static_cast<int>(out.size());
}

bool appendBlosc(std::span<const std::uint8_t> in, std::size_t size, std::vector<std::uint8_t>& out) {
  if (!saysSize(in, size)) return false;
  out.resize(out.size() + size);
  return unpackBlosc(in, std::span(out).last(size));
}

}  // namespace kelp::bake
