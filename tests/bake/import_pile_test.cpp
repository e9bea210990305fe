// SPDX-License-Identifier: MIT
// Triangles that lie over each other by the thousand: the same voxels in little memory, or refused before the
// work.
#include <random>

#include <fmt/format.h>

#include "import_scratch.h"

namespace kelp::bake::test {
namespace {

Settings settingsOf(int resolution, int threads) {
  Settings settings;
  settings.resolution = resolution;
  settings.resolution_given = true;
  settings.threads = threads;
  return settings;
}

// Boxes through each other, and open sheets between them.
std::string boxes(int count) {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> unit(0, 1);
  std::string out;
  for (int i = 0; i < count; ++i) {
    glm::dvec3 low(unit(random), unit(random), unit(random)), high(unit(random), unit(random), unit(random));
    if (i == 0) low = glm::dvec3(0), high = glm::dvec3(1);
    const glm::dvec3 from = glm::min(low, high), to = glm::max(low, high);
    for (int corner = 0; corner < 8; ++corner)
      out += fmt::format("v {} {} {}\n", corner & 1 ? to.x : from.x, corner & 2 ? to.y : from.y,
                         corner & 4 ? to.z : from.z);
    const auto face = [&](int a, int b, int c, int d) {
      out += fmt::format("f {} {} {} {}\n", a - 8, b - 8, c - 8, d - 8);
    };
    face(0, 4, 6, 2), face(1, 3, 7, 5);
    if (i % 5 == 4) continue;
    face(0, 1, 5, 4), face(2, 6, 7, 3), face(0, 2, 3, 1), face(4, 5, 7, 6);
  }
  return out;
}

// Threads share what may be held at a time: for 256 of them every slab is halved again and again, down to
// single columns.
TEST(ImportPile, ScannedInPiecesIsTheSame) {
  const Scratch scratch;
  const auto path = scratch.write("a.obj", boxes(400));
  Report report;
  const RawPack whole = bake::bake(path, settingsOf(40, 1), report),
                pieces = bake::bake(path, settingsOf(40, 256), report);
  EXPECT_EQ(whole.parts[0].levels[0].cells, pieces.parts[0].levels[0].cells);
  EXPECT_EQ(whole.parts[0].levels[0].codes, pieces.parts[0].levels[0].codes);
  EXPECT_EQ(whole.parts[0].levels[0].attributes, pieces.parts[0].levels[0].attributes);
}

// Triangles from end to end of a cube: at 128 voxels each crosses thousands of scanlines.
TEST(ImportPile, IsRefusedBeforeTheWork) {
  const Scratch scratch;
  std::string fan;
  for (int corner = 0; corner < 3; ++corner)
    for (int i = 0; i < 30; ++i)
      fan += fmt::format("v {} {} {}\n", corner == 0 ? 0 : 1, corner == 2 ? 1.0 : 1e-3 * i, 1e-3 * i);
  for (int a = 1; a <= 30; ++a)
    for (int b = 31; b <= 60; ++b)
      for (int c = 61; c <= 90; ++c) fan += fmt::format("f {} {} {}\n", a, b, c);
  const auto path = scratch.write("fan.obj", fan);
  Report report;
  try {
    bake::bake(path, settingsOf(160, 1), report);
    ADD_FAILURE() << "accepted";
  } catch (const ToolError& error) {
    EXPECT_EQ(error.exit, Exit::kRuntime);
    EXPECT_TRUE(contains(error.what(), "fan.obj: part 'fan': thousands of its triangles lie over each other"))
        << error.what();
  }
  EXPECT_TRUE(report.parts.empty());
  // A hundred boxes are baked.
  EXPECT_NO_THROW(bake::bake(scratch.write("few.obj", boxes(100)), settingsOf(24, 0), report));
}

}  // namespace
}  // namespace kelp::bake::test
