// SPDX-License-Identifier: MIT
// Usage: c_pack_file OUT.kelp
//
// Writes what ctypes_test.py draws: an orange column, one meter high, a quarter of a meter thick, with
// distances, whose clip "sway" moves its tip by 0.25 heights to +x and back, in 2 s. A socket is at its top.
#include <cstdio>

#include "support/distance_pack.h"

int main(int count, char** words) {
  if (count != 2) return std::fputs("usage: c_pack_file OUT.kelp\n", stderr), 1;
  const glm::ivec3 size(16, 64, 16);
  const kelp::fields::Occupancy column{size, std::vector<std::uint8_t>(16 * 64 * 16, 1)};
  kelp::RawPack pack = kelp::test::distancePackOf(column);
  pack.palette[0].base_color = {0.9f, 0.3f, 0.05f, 1};
  kelp::RawClip& sway = pack.clips.emplace_back();
  sway.name = "sway";
  sway.duration = 2;
  sway.waves = {{0, 1, kelp::Target::kKnotOffset, {0.25f, 0, 0}, 2, 0}};
  pack.sockets.push_back({.name = "top", .at = 1});
  const std::vector<std::byte> bytes = kelp::test::bytesOf(pack);
  std::FILE* const file = std::fopen(words[1], "wb");
  if (!file) return std::perror(words[1]), 2;
  const bool written = std::fwrite(bytes.data(), 1, bytes.size(), file) == bytes.size();
  return std::fclose(file) == 0 && written && !bytes.empty() ? 0 : 2;
}
