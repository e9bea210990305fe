// SPDX-License-Identifier: MIT
// kelp-dump slice: every pixel against the voxels that the test made, for each axis and each thing that can
// be shown.
#include <gtest/gtest.h>
#include <png.h>

#include "extract_packs.h"
#include "support/fog_pack.h"

namespace kelp {
namespace {

using test::KnownPart;
using test::ProcessResult;

using Pixel = std::array<int, 4>;

struct Picture {
  int width = 0, height = 0;
  std::vector<std::uint8_t> rgba;
  Pixel at(int x, int y) const {
    const std::uint8_t* p = &rgba[4 * static_cast<std::size_t>(x + width * y)];
    return {p[0], p[1], p[2], p[3]};
  }
};

Picture readPng(const std::string& bytes) {
  png_image image{};
  image.version = PNG_IMAGE_VERSION;
  EXPECT_TRUE(png_image_begin_read_from_memory(&image, bytes.data(), bytes.size())) << image.message;
  image.format = PNG_FORMAT_RGBA;
  Picture picture{static_cast<int>(image.width), static_cast<int>(image.height),
                  std::vector<std::uint8_t>(PNG_IMAGE_SIZE(image))};
  EXPECT_TRUE(png_image_finish_read(&image, nullptr, picture.rgba.data(), 0, nullptr));
  return picture;
}

class Slice : public testing::Test {
 protected:
  // Through standard output or through a file, which must be the same.
  Picture slice(std::vector<std::string> arguments) {
    arguments.insert(arguments.begin(), {"slice", pack_, "-o"});
    std::vector<std::string> piped = arguments;
    arguments.insert(arguments.begin() + 3, folder_ / "out.png");
    piped.insert(piped.begin() + 3, "-");
    const ProcessResult result = test::dump(arguments), other = test::dump(piped);
    EXPECT_EQ(result.exit, 0) << result.err;
    EXPECT_EQ(other.exit, 0) << other.err;
    EXPECT_EQ(other.out, test::readWhole(folder_ / "out.png"));
    return readPng(other.out);
  }

  static constexpr int kColors = 6;
  const glm::ivec3 size_{45, 62, 38};
  const KnownPart part_ = test::ball(test::scaled(1), kColors);
  test::Scratch folder_;
  std::string pack_ =
      test::writePackFile(folder_, "ball.kelp", {test::rawPart(part_, "ball")}, test::paletteOf(kColors));
};

// Which voxel a pixel shows, as the README says.
glm::ivec3 voxelAt(char axis, int at, const glm::ivec3& size, int x, int y) {
  if (axis == 'x') return {at, size.y - 1 - y, x};
  if (axis == 'y') return {x, at, y};
  return {x, size.y - 1 - y, at};
}

glm::ivec2 sizeAcross(char axis, const glm::ivec3& size) {
  return axis == 'x'   ? glm::ivec2(size.z, size.y)
         : axis == 'y' ? glm::ivec2(size.x, size.z)
                       : glm::ivec2(size.x, size.y);
}

TEST_F(Slice, EveryVoxelOfALayer) {
  const auto check = [&](char axis, int at, const std::string& what, auto expected) {
    const Picture picture =
        slice({"--axis", std::string(1, axis), "--at", std::to_string(at), "--what", what});
    ASSERT_EQ(glm::ivec2(picture.width, picture.height), sizeAcross(axis, size_));
    for (int y = 0; y < picture.height; ++y)
      for (int x = 0; x < picture.width; ++x) {
        const glm::ivec3 v = voxelAt(axis, at, size_, x, y);
        const Pixel pixel = picture.at(x, y), right = expected(v);
        for (int i = 0; i < 4; ++i)
          ASSERT_NEAR(pixel[i], right[i], 1)
              << what << " across " << axis << " at " << v.x << " " << v.y << " " << v.z;
      }
  };
  // The voxel's attribute, or -1.
  const auto attribute = [&](const glm::ivec3& v) { return part_.attribute[part_.occupancy.index(v)]; };
  const auto occupancy = [&](const glm::ivec3& v) {
    return !part_.solid(v)     ? Pixel{255, 255, 255, 255}
           : attribute(v) >= 0 ? Pixel{40, 40, 40, 255}
                               : Pixel{150, 150, 150, 255};
  };
  const auto normals = [&](const glm::ivec3& v) {
    if (attribute(v) < 0) return part_.solid(v) ? Pixel{128, 128, 128, 255} : Pixel{0, 0, 0, 0};
    const glm::vec3 n = decodeNormal(attributeNormal(static_cast<std::uint32_t>(attribute(v))));
    return Pixel{static_cast<int>(std::lround(127.5f + 127.5f * n.x)),
                 static_cast<int>(std::lround(127.5f + 127.5f * n.y)),
                 static_cast<int>(std::lround(127.5f + 127.5f * n.z)), 255};
  };
  for (const auto& [axis, at] :
       {std::pair('x', 17), std::pair('y', 20), std::pair('z', 18), std::pair('z', 30)}) {
    check(axis, at, "occupancy", occupancy);
    check(axis, at, "normals", normals);
  }
  // Brute force: the distance between closed cubes, of which the nearest is one of the surface.
  std::vector<glm::dvec3> surface;
  part_.eachVoxel(0, [&](const glm::ivec3& s) {
    if (attribute(s) >= 0) surface.emplace_back(s);
  });
  const auto clearance = [&](const glm::ivec3& v) {
    if (part_.solid(v)) return Pixel{205, 92, 40, 255};
    double best = 1e9;
    for (const glm::dvec3& s : surface)
      best = std::min(best, glm::length(glm::max(glm::abs(s - glm::dvec3(v)) - 1.0, 0.0)));
    const int gray = std::min(static_cast<int>(4 * best + 1e-9), 255);
    return Pixel{gray, gray, gray, 255};
  };
  check('y', 3, "clearance", clearance);
  const std::vector<Material> palette = test::paletteOf(kColors);
  const Picture colors = slice({"--what", "colour", "--axis", "x", "--at", "17"});
  for (int y = 0; y < colors.height; ++y)
    for (int x = 0; x < colors.width; ++x) {
      const glm::ivec3 v = voxelAt('x', 17, size_, x, y);
      ASSERT_EQ(colors.at(x, y)[3] > 0, part_.solid(v));
      if (attribute(v) < 0) continue;
      const glm::vec4& color = palette[attributePalette(static_cast<std::uint32_t>(attribute(v)))].base_color;
      for (int i = 0; i < 3; ++i)
        ASSERT_EQ(colors.at(x, y)[static_cast<std::size_t>(i)], test::srgbOf(color[i]));
    }
}

TEST_F(Slice, TheMiddleLayerAcrossTheSplineUnlessToldOtherwise) {
  EXPECT_EQ(slice({}).rgba, slice({"--axis", "y", "--at", "31", "--level", "0", "--what", "occupancy",
                                   "--part", "ball", "--scale", "1"})
                                .rgba);
  const Picture coarse = slice({"--level", "1"});
  EXPECT_EQ(glm::ivec2(coarse.width, coarse.height), glm::ivec2(23, 19));
  const Picture small = slice({}), large = slice({"--scale", "3"});
  ASSERT_EQ(glm::ivec2(large.width, large.height), 3 * glm::ivec2(small.width, small.height));
  for (int y = 0; y < large.height; ++y)
    for (int x = 0; x < large.width; ++x) ASSERT_EQ(large.at(x, y), small.at(x / 3, y / 3));
}

TEST_F(Slice, FogIsItsCodes) {
  const glm::ivec3 size(17, 26, 19);
  const fields::FogSamples fog = test::fogOf(size, test::puffs, [](const glm::dvec3& p) { return p.x; });
  pack_ =
      folder_.write("fog.kelp", std::span<const std::byte>(test::writeToMemory(test::fogPack(fog, 0.5f))));
  for (const char axis : {'x', 'y', 'z'})
    for (const std::string what : {"density", "heat"}) {
      const int at = size[axis - 'x'] - 1;  // which bricks hold that begin before it
      const Picture picture =
          slice({"--axis", std::string(1, axis), "--at", std::to_string(at), "--what", what});
      for (int y = 0; y < picture.height; ++y)
        for (int x = 0; x < picture.width; ++x) {
          const glm::ivec3 v = voxelAt(axis, at, size, x, y);
          const std::uint8_t code =
              (what == "heat" ? fog.heat
                              : fog.density)[static_cast<std::size_t>(v.x + size.x * (v.y + size.y * v.z))];
          ASSERT_EQ(picture.at(x, y), (Pixel{code, code, code, 255}));
        }
    }
  EXPECT_EQ(slice({}).rgba, slice({"--what", "density"}).rgba);
}

TEST_F(Slice, Refusals) {
  const auto check = [&](std::vector<std::string> arguments, int exit, const std::string& says) {
    const std::string out = folder_ / "never.png";
    arguments.insert(arguments.begin(), {"slice", pack_, "-o", out});
    const ProcessResult result = test::dump(arguments);
    EXPECT_EQ(result.exit, exit) << result.err;
    EXPECT_EQ(result.out, "");
    EXPECT_NE(result.err.find(says), std::string::npos) << result.err;
    EXPECT_EQ(std::count(result.err.begin(), result.err.end(), '\n'), 1) << result.err;
    EXPECT_FALSE(std::filesystem::exists(out));
  };
  check({"--axis", "w"}, 1, "--axis w: expected x, y or z");
  check({"--at", "62"}, 1, "layers 0 to 61");
  check({"--at", "-1"}, 1, "layers 0 to 61");
  check({"--level", "2"}, 1, "levels 0 to 1");
  check({"--part", "bell"}, 1, "parts are 0 'ball'");
  check({"--what", "taste"}, 1, "--what taste: expected occupancy");
  check({"--what", "density"}, 1, "is not fog");
  check({"--scale", "0"}, 1, "1 to 64");
  pack_ = folder_.write("fog.kelp", std::span<const std::byte>(test::writeToMemory(
                                        test::fogPack(test::fogOf({9, 9, 9}, test::puffs), 0.5f))));
  check({"--what", "clearance"}, 1, "is fog: it has no clearance; choose density");
  check({"--what", "heat"}, 1, "has no heat");
  const ProcessResult none = test::dump({"slice", pack_});
  EXPECT_EQ(none.exit, 1);
  EXPECT_NE(none.err.find("--output is required"), std::string::npos) << none.err;
  EXPECT_EQ(test::dump({"slice", pack_, "-o", ""}).exit, 1);
  EXPECT_EQ(test::dump({"slice", pack_, "-o", folder_ / "nowhere/out.png"}).exit, 2);
}

}  // namespace
}  // namespace kelp
