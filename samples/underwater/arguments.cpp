// SPDX-License-Identifier: MIT
#include "arguments.h"

#include <charconv>
#include <cmath>
#include <string_view>

namespace underwater {

const char* const kUsage =
    "usage: underwater PACKS_FOLDER [--plants N] [--size WxH] [--start SECONDS] [--frames N [PICTURE.ppm]]\n"
    "Shows a reef made of kelp_plant, sea_grass, dulse, fish and fusilier, whose packs are in the folder.\n"
    "Drag the mouse to look round, W A S D Q E to swim, C to give the camera back. With --frames it ends "
    "after N\n"
    "frames, a thirtieth of a second apart, and saves the last as a picture.\n";

namespace {

template <class T>
bool read(std::string_view word, T low, T high, T& value) {
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
  // false for a NaN
  return error == std::errc() && end == word.data() + word.size() && value >= low && value <= high;
}

}  // namespace

std::optional<Arguments> parse(int count, const char* const* words) {
  Arguments a;
  for (int i = 1; i < count; ++i) {
    const std::string_view word = words[i];
    const bool option = word.starts_with("-");
    const std::string_view value = option && i + 1 < count ? words[++i] : "";
    bool good = false;
    if (word == "--plants") {
      good = read(value, 0, 20000, a.plants);
    } else if (word == "--size") {
      const std::size_t by = value.find('x');
      good = by != value.npos && read(value.substr(0, by), 16, 16384, a.size.x) &&
             read(value.substr(by + 1), 16, 16384, a.size.y);
    } else if (word == "--start") {
      good = read(value, 0.0, 1e6, a.start);
    } else if (word == "--frames") {
      good = read(value, 1, 1000000, a.frames);
      if (good && i + 1 < count && words[i + 1][0] != '-') a.picture = words[++i];
    } else if (!option && a.packs.empty() && !word.empty()) {
      a.packs = word;
      good = true;
    }
    if (!good) return std::nullopt;
  }
  if (a.packs.empty()) return std::nullopt;
  return a;
}

}  // namespace underwater
