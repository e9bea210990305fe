// SPDX-License-Identifier: MIT
// Compares two levels of fog brick by brick. A sample that bricks share counts once, in the first brick that
// has it.
#include <array>
#include <cmath>
#include <span>

#include <fmt/format.h>

#include "kelp/common/dense_index.h"

#include "diff/diff.h"
#include "kelp/formats/fog.h"
#include "pack/brick_reader.h"
#include "text/text.h"

namespace kelp::dump {
namespace {

constexpr const char* kNames[] = {"density", "heat"};

double valueOf(int channel, std::uint8_t code) {
  return channel == 0 ? static_cast<double>(fogDensity(code)) : code / 255.0;
}

// A missing brick (null) is clear.
void compare(const glm::ivec3& low, const BrickReader* a, const BrickReader* b, int channels,
             const glm::ivec3& size, const Tolerance& tolerance, Places (&found)[2]) {
  static constexpr std::array<std::uint8_t, kFogSamples> kClear{};
  for (int channel = 0; channel < channels; ++channel) {
    const std::span<const std::uint8_t> codes_a = a ? a->samples(channel) : kClear,
                                        codes_b = b ? b->samples(channel) : kClear;
    for (int i = 0; i < kFogSamples; ++i) {
      const std::uint8_t code_a = codes_a[static_cast<std::size_t>(i)],
                         code_b = codes_b[static_cast<std::size_t>(i)];
      if (code_a == code_b) continue;
      const glm::ivec3 local(i % kFogSide, i / kFogSide % kFogSide, i / (kFogSide * kFogSide)),
          at = low + local;
      bool first = true;  // or the last of the level, which no other brick has
      for (int axis = 0; axis < 3; ++axis)
        first = first && (local[axis] < kBrickSide || at[axis] + 1 == size[axis]);
      if (!first) continue;
      if (const double apart = std::abs(valueOf(channel, code_a) - valueOf(channel, code_b));
          !tolerance.allows(apart, 1))
        found[channel].add(at, apart);
    }
  }
}

}  // namespace

void diffFog(PackFile& file_a, PackFile& file_b, int part_a, int part_b, int level,
             const Tolerance& tolerance, std::vector<Difference>& out) {
  const Part &of_a = file_a.pack().parts()[static_cast<std::size_t>(part_a)],
             &of_b = file_b.pack().parts()[static_cast<std::size_t>(part_b)];
  const float extinction_a = of_a.fog->extinction[static_cast<std::size_t>(level)],
              extinction_b = of_b.fog->extinction[static_cast<std::size_t>(level)];
  const auto add = [&](const char* kind, const std::string& text) -> Difference& {
    Difference difference{kind, fmt::format("level {}: {}", level, text)};
    difference.name = of_a.name;
    difference.level = level;
    return out.emplace_back(difference);
  };
  if (!tolerance.alike(static_cast<double>(extinction_a), static_cast<double>(extinction_b))) {
    Difference& d = add("extinction", fmt::format("extinction {} and {}", extinction_a, extinction_b));
    d.a = fmt::format("{}", extinction_a);
    d.b = fmt::format("{}", extinction_b);
  }
  BrickReader a(file_a, part_a, level), b(file_b, part_b, level);
  Places found[2];
  // Heat in only one of them is reported as a difference of "look".
  const int channels = std::min(of_a.fog->channels(), of_b.fog->channels());
  forEachBrick(a, b, [&](const glm::ivec3& low, const BrickReader* its_a, const BrickReader* its_b) {
    compare(low, its_a, its_b, channels, levelSize(of_a.size, level), tolerance, found);
  });
  for (int channel = 0; channel < 2; ++channel) {
    if (found[channel].count == 0) continue;
    const glm::ivec3& first = found[channel].first;
    Difference& d =
        add(kNames[channel], fmt::format("{} of another {} (by up to {:.2g}), first at ({}, {}, {})",
                                         plural(found[channel].count, "sample"), kNames[channel],
                                         found[channel].largest, first.x, first.y, first.z));
    d.count = found[channel].count;
    d.first = first;
    d.largest = found[channel].largest;
  }
}

}  // namespace kelp::dump
