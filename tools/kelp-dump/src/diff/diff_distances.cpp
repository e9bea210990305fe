// SPDX-License-Identifier: MIT
#include <fmt/format.h>

#include "diff/diff.h"
#include "pack/level_distances.h"
#include "text/text.h"

namespace kelp::dump {

void diffDistances(PackFile& file_a, PackFile& file_b, int part_a, int part_b, std::vector<Difference>& out) {
  const Pack &a = file_a.pack(), &b = file_b.pack();
  const std::string name(a.parts()[static_cast<std::size_t>(part_a)].name);
  const auto add = [&](const std::string& text) -> Difference& {
    Difference difference{"distance", text};
    difference.name = name;
    return out.emplace_back(difference);
  };
  if (a.hasDistances() != b.hasDistances()) {
    const bool in_a = a.hasDistances();
    add(fmt::format("distances in {} alone", in_a ? "A" : "B")).only_in = in_a ? "a" : "b";
    return;
  }
  for (int level = std::min(a.distanceLevels(part_a), b.distanceLevels(part_b)); level-- > 0;) {
    const LevelDistances in_a(file_a, static_cast<std::uint32_t>(part_a), level),
        in_b(file_b, static_cast<std::uint32_t>(part_b), level);
    const DistanceBand &band_a = in_a.raw().band, &band_b = in_b.raw().band;
    if (!(band_a == band_b)) {
      Difference& d =
          add(fmt::format("level {}: distances up to {}, {} and {}, {} (squared, outside and inside)", level,
                          band_a.outside, band_a.inside, band_b.outside, band_b.inside));
      d.level = level;
      continue;
    }
    Places found;
    glm::ivec3 v;
    for (v.z = 0; v.z < in_a.size().z; ++v.z)
      for (v.y = 0; v.y < in_a.size().y; ++v.y)
        for (v.x = 0; v.x < in_a.size().x; ++v.x)
          if (in_a.code(v) != in_b.code(v)) found.add(v);
    if (found.count == 0) continue;
    Difference& d =
        add(fmt::format("level {}: {} at another distance, first at ({}, {}, {})", level,
                        plural(found.count, "voxel"), found.first.x, found.first.y, found.first.z));
    d.level = level;
    d.count = found.count;
    d.first = found.first;
  }
}

}  // namespace kelp::dump
