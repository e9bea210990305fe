// SPDX-License-Identifier: MIT
// Writes the smallest pack that shows something: one brick with a cube of 4 x 4 x 4 voxels in its middle, red
// on its left, blue on its right. In meters the volume is 1 m high, stands on the origin and is centered in x
// and z: the cube is [-1/4, 1/4] x [1/4, 3/4] x [-1/4, 1/4].
#include <cmath>
#include <cstdio>
#include <cstdlib>

#include "kelp/formats/raw_pack.h"

namespace {

constexpr int kSide = 8;

int outside(int v) { return v < 2 ? 2 - v : v > 5 ? v - 5 : 0; }  // voxels to the cube, along an axis
bool onFace(int v) { return v == 2 || v == 5; }
float faceNormal(int v) { return v == 2 ? -1.0f : v == 5 ? 1.0f : 0.0f; }

kelp::RawLevel cube() {
  kelp::RawLevel level;
  level.cells = {kelp::kCellSolid};
  for (int z = 0; z < kSide; ++z) {
    int rank = 0;  // among the surface voxels of the slice
    for (int y = 0; y < kSide; ++y) {
      for (int x = 0; x < kSide; ++x) {
        if (outside(x) + outside(y) + outside(z) > 0) {
          // squared distance of the closed cubes
          const int apart = (outside(x) > 1) + (outside(y) > 1) + (outside(z) > 1);
          level.codes.push_back(static_cast<std::uint8_t>(4.0 * std::sqrt(apart)));
        } else if (onFace(x) || onFace(y) || onFace(z)) {
          level.codes.push_back(static_cast<std::uint8_t>(kelp::kSurfaceCode + rank++));
          const glm::vec3 normal(faceNormal(x), faceNormal(y), faceNormal(z));
          level.attributes.push_back(kelp::makeAttribute(x < 4 ? 0 : 1, kelp::encodeNormal(normal)));
        } else {
          level.codes.push_back(kelp::kInnerCode);
        }
      }
    }
  }
  return level;
}

}  // namespace

int main(int count, char** words) {
  if (count != 2) return std::fputs("usage: write_pack OUT.kelp\n", stderr), 1;
  kelp::RawPart part;
  part.name = "cube";
  part.size = glm::ivec3(kSide);
  part.to_object = glm::mat4x3(0.125f, 0, 0, 0, 0.125f, 0, 0, 0, 0.125f, -0.5f, 0, -0.5f);
  part.knots = {{0, glm::vec3(0), glm::vec3(0, 1, 0)}, {1, glm::vec3(0, 1, 0), glm::vec3(0, 1, 0)}};
  part.levels.push_back(cube());

  kelp::RawPack pack;
  pack.info_json = "{}";
  pack.palette = {{{0.8f, 0.05f, 0.05f, 1}}, {{0.05f, 0.05f, 0.8f, 1}}};
  pack.parts.push_back(part);
  kelp::RawClip sway;
  sway.name = "sway";
  sway.duration = 2;
  sway.waves = {{0, 1, kelp::Target::kKnotOffset, {0.25f, 0, 0}, 2, 0}};
  pack.clips.push_back(sway);

  std::FILE* const file = std::fopen(words[1], "wb");
  if (!file) return std::perror(words[1]), 2;
  const kelp::Sink sink{
      [](void* user, std::span<const std::byte> bytes) -> kelp::Result<void> {
        if (std::fwrite(bytes.data(), 1, bytes.size(), static_cast<std::FILE*>(user)) == bytes.size())
          return {};
        return kelp::Error{kelp::ErrorCode::kIo, "the file cannot be written"};
      },
      file};
  const kelp::Result<void> written = kelp::writePack(pack, sink);
  if (!written)
    std::fprintf(stderr, "%s: %s: %s\n", words[1], kelp::toString(written.error().code),
                 written.error().detail);
  return std::fclose(file) == 0 && written ? 0 : 2;
}
