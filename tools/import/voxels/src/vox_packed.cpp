// SPDX-License-Identifier: MIT
// Format: https://github.com/vengi-voxel/vengi/pull/778.
#include <algorithm>
#include <new>

#include <zlib.h>

#include "vox_file.h"

namespace kelp::bake {

std::vector<std::uint8_t> unpackVoxels(const InputFiles& files, const std::string& place,
                                       std::span<const std::uint8_t> packed, const glm::ivec3& size) {
  const std::size_t count =
      static_cast<std::size_t>(size.x) * static_cast<std::size_t>(size.y) * static_cast<std::size_t>(size.z);
  std::vector<std::uint8_t> indices(count + 1);  // one more would not be filled
  z_stream stream{};
  if (inflateInit(&stream) != Z_OK) throw std::bad_alloc();
  stream.next_in = const_cast<Bytef*>(packed.data());
  stream.avail_in = static_cast<uInt>(packed.size());
  stream.next_out = indices.data();
  stream.avail_out = static_cast<uInt>(indices.size());
  const int result = inflate(&stream, Z_SYNC_FLUSH);
  inflateEnd(&stream);
  // Teardown flushes its streams, but does not end them.
  if ((result != Z_OK && result != Z_STREAM_END && result != Z_BUF_ERROR) || stream.total_out != count)
    refuse(Exit::kInvalid, files.input(), place,
           "does not unpack to the voxels of its size; the file is damaged: save it again");
  indices.pop_back();
  std::vector<std::uint8_t> voxels(
      4 * (count - static_cast<std::size_t>(std::count(indices.begin(), indices.end(), 0))));
  const std::uint8_t* next = indices.data();
  std::uint8_t* out = voxels.data();
  for (int z = 0; z < size.z; ++z)
    for (int y = 0; y < size.y; ++y)
      for (int x = 0; x < size.x; ++x)
        if (const std::uint8_t index = *next++; index != 0) {
          *out++ = static_cast<std::uint8_t>(x);
          *out++ = static_cast<std::uint8_t>(y);
          *out++ = static_cast<std::uint8_t>(z);
          *out++ = index;
        }
  return voxels;
}

}  // namespace kelp::bake
