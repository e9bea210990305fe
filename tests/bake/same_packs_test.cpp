// SPDX-License-Identifier: MIT
// Bakes to the same bytes with every instruction set that this machine offers, on 1, 2 and 7 threads. Other
// builds and other processors' libm: tests/cli/same_packs.py.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <fstream>
#include <numbers>

#include "../fields/every_target.h"
#include "import_scratch.h"
#include "kelp/bake/bake.h"
#include "support/all_tests.h"

namespace kelp::bake::test {
namespace {

// A wavy lump with holes at its poles, colored corner by corner with more colors than a palette has, and a
// sheet beside it.
std::string lump() {
  constexpr int kSteps = 32;
  std::string text;
  char line[160];
  for (int j = 0; j <= kSteps; ++j) {
    for (int i = 0; i < kSteps; ++i) {
      const double u = 6.283185307179586 * i / kSteps, v = std::numbers::pi * (0.04 + 0.92 * j / kSteps),
                   r = 1 + 0.15 * std::sin(5 * u) * std::sin(4 * v);
      std::snprintf(line, sizeof line, "v %.6f %.6f %.6f %.3f %.3f %.3f\n", r * std::sin(v) * std::cos(u),
                    1.3 * r * std::cos(v), r * std::sin(v) * std::sin(u), (i * 37 % 256) / 255.0,
                    (j * 101 % 256) / 255.0, ((i + j) * 11 % 256) / 255.0);
      text += line;
    }
  }
  text += "v 1.2 -1 -0.8 1 0 0\nv 1.5 1 -0.5 0 1 0\nv 1.4 0.9 0.9 0 0 1\n";
  for (int j = 0; j < kSteps; ++j) {
    for (int i = 0; i < kSteps; ++i) {
      const int a = j * kSteps + i + 1, b = j * kSteps + (i + 1) % kSteps + 1;
      std::snprintf(line, sizeof line, "f %d %d %d %d\n", a, b, b + kSteps, a + kSteps);
      text += line;
    }
  }
  const int last = kSteps * (kSteps + 1) + 3;
  return text + "f " + std::to_string(last - 2) + " " + std::to_string(last - 1) + " " +
         std::to_string(last) + "\n";
}

std::string packOf(const std::filesystem::path& input, int threads, const std::filesystem::path& out) {
  Settings settings;
  settings.resolution = kelp::test::kSanitized ? 40 : 72;
  settings.rig_preset = "sway";
  settings.threads = threads;
  Report report;
  writePackFile(bake(input, settings, report), out, threads, report);
  EXPECT_GT(report.parts.at(0).repairs.capped, 0u) << "the lump has holes to cap";
  EXPECT_GT(report.parts.at(0).repairs.sheets, 0u);
  EXPECT_EQ(report.palette_entries, 256u);
  std::ifstream file(out, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

TEST(SamePacks, OnEveryTargetAndAnyNumberOfThreads) {
  Scratch scratch;
  const std::filesystem::path input = scratch.write("lump.obj", lump());
  const std::string expected = packOf(input, 1, scratch.folder() / "out.kelp");
  ASSERT_GT(expected.size(), 10000u);
  kelp::test::forEveryTarget([&](const char* target) {
    for (const int threads : {1, 2, 7})
      EXPECT_TRUE(packOf(input, threads, scratch.folder() / "out.kelp") == expected)
          << target << ", " << threads << " threads";
  });
}

}  // namespace
}  // namespace kelp::bake::test
