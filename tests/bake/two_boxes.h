// SPDX-License-Identifier: MIT
// Two boxes that touch, 1 x 2 x 1 and 1.5 x 1 x 1, for files that are made in many ways.
#pragma once

#include <array>
#include <filesystem>
#include <set>
#include <string>

#include <fmt/format.h>

#include "kelp/bake/bake.h"
#include "kelp/common/srgb.h"

namespace kelp::bake::test {

struct TwoBoxes {
  static constexpr int kCorners = 16;
  static constexpr std::array<std::array<int, 3>, 24> kFaces = {
      {{0, 2, 1},    {1, 2, 3},    {4, 5, 6},    {5, 7, 6},    {0, 1, 4},   {1, 5, 4},
       {2, 6, 3},    {3, 6, 7},    {0, 4, 2},    {2, 4, 6},    {1, 3, 5},   {3, 7, 5},
       {8, 10, 9},   {9, 10, 11},  {12, 13, 14}, {13, 15, 14}, {8, 9, 12},  {9, 13, 12},
       {10, 14, 11}, {11, 14, 15}, {8, 12, 10},  {10, 12, 14}, {9, 11, 13}, {11, 15, 13}}};
  static bool isSecond(int corner) { return corner >= 8; }
  static glm::vec3 corner(int i) {
    return isSecond(i) ? glm::vec3(i & 1 ? 2.5f : 1.0f, i & 2 ? 1 : 0, i & 4 ? 1 : 0)
                       : glm::vec3(i & 1, i & 2, i & 4 ? 1 : 0);
  }
  static std::string text(int i) { return fmt::format("{} {} {}", corner(i).x, corner(i).y, corner(i).z); }
};

inline RawPack bakeBoxes(const std::filesystem::path& path, Report& report) {
  Settings settings;
  settings.resolution = 64;
  settings.resolution_given = true;
  settings.threads = 2;
  return bake::bake(path, settings, report);
}

// The colors of a palette as #rrggbb, ascending.
inline std::set<std::string> colorsOf(const RawPack& pack) {
  std::set<std::string> colors;
  for (const Material& m : pack.palette)
    colors.insert(fmt::format("#{:02x}{:02x}{:02x}", linearToSrgb8(static_cast<double>(m.base_color.r)),
                              linearToSrgb8(static_cast<double>(m.base_color.g)),
                              linearToSrgb8(static_cast<double>(m.base_color.b))));
  return colors;
}

}  // namespace kelp::bake::test
