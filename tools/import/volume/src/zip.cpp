// SPDX-License-Identifier: MIT
#include <algorithm>
#include <memory>

#include <zlib.h>

#include "unpack.h"

namespace kelp::bake {

bool unpackZip(std::span<const std::uint8_t> in, std::span<std::uint8_t> out) {
  uLongf size = out.size();
  return uncompress(out.data(), &size, in.data(), in.size()) == Z_OK && size == out.size();
}

bool appendZip(std::span<const std::uint8_t> in, std::size_t size, std::vector<std::uint8_t>& out) {
  constexpr std::size_t kStep = std::size_t{1} << 20, kMostAtOnce = std::size_t{1} << 30;
  z_stream stream{};
  if (inflateInit(&stream) != Z_OK) return false;
  const std::unique_ptr<z_stream, int (*)(z_streamp)> closing(&stream, inflateEnd);
  stream.next_in = const_cast<Bytef*>(in.data());  // zlib reads it only
  const std::size_t end = out.size() + size;
  out.reserve(end);
  std::size_t fed = 0;
  for (int state = Z_OK; state != Z_STREAM_END;) {
    if (stream.avail_in == 0) {
      stream.avail_in = static_cast<uInt>(std::min(in.size() - fed, kMostAtOnce));
      fed += stream.avail_in;
    }
    const std::size_t at = out.size(), step = std::min(end - at, kStep);
    out.resize(at + step);
    stream.next_out = out.data() + at;
    stream.avail_out = static_cast<uInt>(step);
    // Z_BUF_ERROR where it can go no further: the bytes end, or there are more than `size`
    state = inflate(&stream, Z_NO_FLUSH);
    out.resize(at + step - stream.avail_out);
    if (state != Z_OK && state != Z_STREAM_END) return false;
  }
  return out.size() == end;
}

std::uint32_t zipChecksum(std::span<const std::uint8_t> bytes) {
  return static_cast<std::uint32_t>(crc32_z(crc32(0, nullptr, 0), bytes.data(), bytes.size()));
}

}  // namespace kelp::bake
