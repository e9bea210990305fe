// SPDX-License-Identifier: MIT
// kelp-render as a process: a pack to draw, and what is in the picture.
#pragma once

#include <gtest/gtest.h>
#include <png.h>

#include <algorithm>
#include <fstream>

#include "process.h"
#include "support/test_pack.h"

namespace kelp::test {

inline ProcessResult render(std::vector<std::string> arguments) {
  arguments.insert(arguments.begin(), KELP_RENDER);
  return runProcess(arguments);
}

inline void write(const std::string& path, std::span<const std::byte> bytes) {
  std::ofstream(path, std::ios::binary)
      .write(reinterpret_cast<const char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
}

// Rows from top to bottom. Empty if the file is no PNG.
struct Picture {
  int width = 0, height = 0;
  std::vector<std::uint8_t> rgba;

  explicit Picture(const std::string& path) {
    png_image image{};
    image.version = PNG_IMAGE_VERSION;
    if (!png_image_begin_read_from_file(&image, path.c_str())) return;
    image.format = PNG_FORMAT_RGBA;
    rgba.resize(PNG_IMAGE_SIZE(image));
    if (!png_image_finish_read(&image, nullptr, rgba.data(), 0, nullptr)) return;
    width = static_cast<int>(image.width);
    height = static_cast<int>(image.height);
  }
  glm::ivec4 at(int x, int y) const {
    if (x >= width || y >= height) return glm::ivec4(-1);
    const std::uint8_t* p = rgba.data() + 4 * (y * width + x);
    return {p[0], p[1], p[2], p[3]};
  }
  bool covered(int x, int y) const { return at(x, y).a > 127; }
  // Mean x of the covered pixels of some rows; -1: none.
  double middle(int top, int bottom) const {
    double sum = 0;
    int count = 0;
    for (int y = top; y < bottom; ++y) {
      for (int x = 0; x < width; ++x) {
        if (covered(x, y)) sum += x, ++count;
      }
    }
    return count ? sum / count : -1;
  }
};

// A box of 24 x 48 x 16 voxels: below green, above red, and on its right (+x) blue. Its clip moves the top to
// the right.
inline RawPack boxPack() {
  const glm::ivec3 size(24, 48, 16);
  fields::Occupancy volume{size, std::vector<std::uint8_t>(24 * 48 * 16, 1)};
  RawPack pack = packOf(volume);
  pack.palette = {Material{{0.02f, 0.5f, 0.02f, 1}, {0, 0, 0}, 0, 1},
                  Material{{0.6f, 0.02f, 0.02f, 1}, {0, 0, 0}, 0, 1},
                  Material{{0.02f, 0.02f, 0.7f, 1}, {0, 0, 0}, 0, 1}};
  std::vector<fields::SurfaceVoxel> surface;
  for (const std::uint64_t i : fields::surfaceVoxels(volume, 1)) {
    const glm::ivec3 v(static_cast<int>(i % 24), static_cast<int>(i / 24 % 48),
                       static_cast<int>(i / (24 * 48)));
    const glm::vec3 normal = v.z == 15   ? glm::vec3(0, 0, 1)
                             : v.x == 23 ? glm::vec3(1, 0, 0)
                             : v.x == 0  ? glm::vec3(-1, 0, 0)
                                         : glm::vec3(0, 1, 0);
    surface.push_back({i, makeAttribute(v.x >= 16 ? 2 : v.y >= 24 ? 1 : 0, encodeNormal(normal))});
  }
  pack.parts[0].levels[0] = fields::buildLevel(volume, surface, 1);
  RawClip clip;
  clip.name = "lean";
  clip.duration = 2;
  clip.waves.push_back({0, 1, Target::kKnotOffset, {0.5f, 0, 0}, 2, 0});
  pack.clips.push_back(clip);
  return pack;
}

class KelpRender : public testing::Test {
 protected:
  void SetUp() override { write(pack_, bytesOf(boxPack())); }
  // Renders the box from the front, without background; the test fails if that fails.
  Picture picture(const std::vector<std::string>& more = {}) {
    EXPECT_EQ(said(more), "");
    return Picture(out_);
  }
  // The text that it prints; the picture is out_.
  std::string said(const std::vector<std::string>& more) {
    std::vector<std::string> arguments = {pack_, "-o",      out_, "--size",       "120x120", "--yaw",
                                          "0",   "--pitch", "0",  "--background", "none"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    const ProcessResult result = render(arguments);
    EXPECT_EQ(result.exit, 0) << result.err;
    EXPECT_EQ(result.err, "");
    return result.out;
  }

  const Scratch folder_;
  const std::string pack_ = folder_ / "box.kelp";
  const std::string out_ = folder_ / "out.png";
};

}  // namespace kelp::test
