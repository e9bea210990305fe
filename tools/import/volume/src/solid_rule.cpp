// SPDX-License-Identifier: MIT
#include "solid.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "grid_choice.h"

namespace kelp::bake {
namespace {

struct Range {
  double low = INFINITY, high = -INFINITY;  // of the finite values; the background is none
};

Range rangeOf(const VolumeGrid& grid) {
  Range range;
  const auto include = [&](double value) {
    if (!std::isfinite(value)) return;
    range.low = std::min(range.low, value);
    range.high = std::max(range.high, value);
  };
  grid.tree->visit([&](const VolumeCell& cell) { include(cell.value.x); },
                   [&](const VolumeLeaf& leaf) {
                     for (std::size_t i = 0; i < VolumeGrid::kLeafVoxels; ++i) include(leaf.values[i]);
                   });
  return range;
}

}  // namespace

VolumeRule volumeRule(const InputFiles& files, const GridHeader& header, const VolumeGrid& grid,
                      const ImportSettings& settings, std::vector<std::string>& notices) {
  const std::string place = gridPlace(header);
  if (settings.isovalue && !std::isfinite(*settings.isovalue))
    throw ToolError(Exit::kUsage, fmt::format("--isovalue {}: not a finite number", *settings.isovalue));
  if (settings.isovalue && settings.volume == VolumeKind::kFog)
    refuse(Exit::kUsage, files.input(), "--isovalue " + fmt::format("{}", *settings.isovalue),
           "fog has no surface; leave it out, or --volume fog");
  const double background = grid.background;
  const bool unclassed = header.kind == GridKind::kScalar && header.grid_class != GridClass::kLevelSet &&
                         header.grid_class != GridClass::kFogVolume;
  const Range range = rangeOf(grid);
  VolumeRule rule;
  rule.binary = header.kind == GridKind::kBinary;
  rule.below = !rule.binary &&
               (header.grid_class == GridClass::kLevelSet || (unclassed && background > 0 && range.low < 0));
  if (unclassed)
    notices.push_back(
        fmt::format("{} does not say what its numbers are: taken for {}", gridSubject(header),
                    rule.below ? "a level set, since its background is positive and there are negative ones"
                               : "densities"));
  if (rule.below && settings.volume == VolumeKind::kFog)
    refuse(Exit::kUsage, files.input(), place,
           "holds distances, which are no densities of fog; leave --volume out");
  rule.fog = settings.volume == VolumeKind::kFog ||
             (settings.volume == VolumeKind::kAuto && !rule.below && !rule.binary && !settings.isovalue);
  if (rule.fog) {
    if (background != 0)
      refuse(Exit::kInvalid, files.input(), place,
             fmt::format("has a background of {}: fog would fill all space; export it with a background of "
                         "0, or give an --isovalue",
                         background));
    return rule;
  }
  rule.iso = settings.isovalue.value_or(rule.below ? 0.0 : rule.binary ? 0.5 : range.high / 2);
  if (!settings.isovalue && !rule.below && !rule.binary)
    notices.push_back(
        fmt::format("{} is solid from {:.6g} on, half its greatest value; --isovalue chooses another",
                    gridSubject(header), rule.iso));
  if (rule.solid(background) || std::isnan(background))
    refuse(Exit::kInvalid, files.input(), place,
           rule.below
               ? fmt::format("is solid outside: its background is {}; the level set is inside out, or the "
                             "--isovalue is too large",
                             background)
               : fmt::format("is solid outside: its background is {}; give a larger --isovalue", background));
  return rule;
}

}  // namespace kelp::bake
