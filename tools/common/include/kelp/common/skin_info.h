// SPDX-License-Identifier: MIT
// The skin that a pack's parts were made from, read from INFO. Safe for hostile text.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "kelp/formats/pack.h"

namespace kelp {

// Distances between where a part carries its surface and where the skin would, in voxels, of the clip in
// which they are largest. Finite, 0 <= mean, p95 <= max.
struct PartFit {
  double mean = 0, p95 = 0, max = 0;
};

struct PartSkin {
  std::vector<std::string> joints;  // that it follows
  std::optional<PartFit> fit;       // nullopt: not known, or numbers that make no sense
};

// One entry for each part. Missing or wrong members of INFO give empty ones.
std::vector<PartSkin> readSkin(std::string_view info_json, std::size_t parts);
// Of the pack's parts. Without clips nothing moves, so no fit is known.
std::vector<PartSkin> skinOf(const Pack& pack);
// True if the fit of any part is known.
bool knowsFit(const std::vector<PartSkin>& skin);

}  // namespace kelp
