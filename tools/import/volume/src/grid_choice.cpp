// SPDX-License-Identifier: MIT
#include "grid_choice.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <charconv>

#include <fmt/format.h>

namespace kelp::bake {
namespace {

constexpr std::size_t kListed = 16;

std::string lowerCase(std::string text) {
  std::transform(text.begin(), text.end(), text.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return text;
}

template <std::size_t N>
bool isOneOf(const std::string& name, const std::array<std::string_view, N>& names) {
  return std::find(names.begin(), names.end(), lowerCase(name)) != names.end();
}

bool isScalar(const GridHeader& grid) {
  return grid.kind == GridKind::kScalar || grid.kind == GridKind::kBinary;
}
// Grids of OpenVDB's format 225. They are chosen as if they could be read, for a message that says what to
// do.
bool isHalf(const GridHeader& grid) { return grid.kind == GridKind::kOther && grid.type.starts_with("half"); }
bool isColor(const GridHeader& grid) {
  return grid.kind == GridKind::kVector && grid.type.find("vec3i") == std::string::npos;
}
constexpr std::array<std::string_view, 4> kHeatNames{"flame", "flames", "heat", "temperature"};
constexpr std::array<std::string_view, 2> kColorNames{"cd", "color"};
bool isHeat(const GridHeader& grid) {
  return (grid.kind == GridKind::kScalar || isHalf(grid)) && isOneOf(grid.name, kHeatNames);
}

template <class Wanted>
std::string list(const std::vector<GridHeader>& grids, const Wanted& wanted) {
  std::string text;
  std::size_t count = 0;
  for (std::size_t i = 0; i < grids.size(); ++i) {
    if (!wanted(grids[i]) || ++count > kListed) continue;
    text += fmt::format("{}{}: {}", text.empty() ? "" : ", ", i, describeGrid(grids[i]));
  }
  return count > kListed ? fmt::format("{} and {} more", text, count - kListed) : text;
}

std::string listAll(const std::vector<GridHeader>& grids) {
  return list(grids, [](const GridHeader&) { return true; });
}

// Finds a grid by name, or else by index.
std::size_t find(const InputFiles& files, const std::vector<GridHeader>& grids, const std::string& option,
                 const std::string& wanted) {
  std::vector<std::size_t> found;
  for (std::size_t i = 0; i < grids.size(); ++i)
    if (grids[i].name == wanted) found.push_back(i);
  const std::string place = option + " " + oneLine(wanted, 60);
  if (found.size() > 1)
    refuse(Exit::kUsage, files.input(), place,
           "several grids have that name; give the index of one of " + listAll(grids));
  if (found.size() == 1) return found[0];
  std::size_t index = 0;
  const auto [end, error] = std::from_chars(wanted.data(), wanted.data() + wanted.size(), index);
  if (error == std::errc() && end == wanted.data() + wanted.size() && index < grids.size()) return index;
  refuse(Exit::kUsage, files.input(), place,
         "there is no such grid; give the name or the index of one of " + listAll(grids));
}

// Of several grids the one that a user most likely means: `density`, or the only level set, or the only fog
// volume. Nothing if none of these is there.
std::optional<std::size_t> mostLikely(const std::vector<GridHeader>& grids,
                                      const std::vector<std::size_t>& among) {
  const auto only = [&](const auto& wanted) -> std::optional<std::size_t> {
    const auto isIt = [&](std::size_t i) { return wanted(grids[i]); };
    if (std::count_if(among.begin(), among.end(), isIt) != 1) return std::nullopt;
    return *std::find_if(among.begin(), among.end(), isIt);
  };
  if (const auto named = only([](const GridHeader& grid) { return lowerCase(grid.name) == "density"; }))
    return named;
  for (const GridClass wanted : {GridClass::kLevelSet, GridClass::kFogVolume})
    if (const auto one = only([&](const GridHeader& grid) { return grid.grid_class == wanted; })) return one;
  return std::nullopt;
}

// `choice` gets the grid, and the notice.
void chooseVolume(const InputFiles& files, const std::vector<GridHeader>& grids,
                  const ImportSettings& settings, VolumeChoice& choice) {
  if (settings.grid) {
    choice.grid = find(files, grids, "--grid", *settings.grid);
    return;
  }
  const auto pick = [&](const auto& wanted) {
    std::vector<std::size_t> found;
    for (std::size_t i = 0; i < grids.size(); ++i)
      if (wanted(grids[i])) found.push_back(i);
    if (found.empty()) return false;
    choice.grid = found[0];
    if (found.size() == 1) return true;
    const auto likely = mostLikely(grids, found);
    if (!likely)
      refuse(Exit::kUsage, files.input(), "",
             "has several grids to bake; choose one with --grid NAME or INDEX: " + list(grids, wanted));
    choice.grid = *likely;
    choice.notice = fmt::format(
        "baked grid {} of several; --grid NAME or INDEX takes another: {}", describeGrid(grids[*likely]),
        list(grids, [&](const GridHeader& grid) { return wanted(grid) && &grid != &grids[*likely]; }));
    return true;
  };
  // No level set is fog.
  const auto hasNumbers = [&](const GridHeader& grid) {
    return isHalf(grid) || (isScalar(grid) && !grid.empty &&
                            (settings.volume != VolumeKind::kFog || grid.grid_class != GridClass::kLevelSet));
  };
  if (pick([&](const GridHeader& grid) { return hasNumbers(grid) && !isHeat(grid); }) ||
      pick([&](const GridHeader& grid) { return hasNumbers(grid) && isHeat(grid); }) ||
      pick([](const GridHeader& grid) { return isScalar(grid) && !grid.empty; }) ||
      pick([](const GridHeader& grid) { return grid.kind == GridKind::kPoints; }))
    return;
  if (grids.empty()) refuse(Exit::kUnsupported, files.input(), "", "holds no grid; export a volume");
  if (grids.size() == 1) return;
  if (std::all_of(grids.begin(), grids.end(), [](const GridHeader& grid) {
        return grid.empty && grid.kind != GridKind::kPoints && grid.kind != GridKind::kOther;
      }))
    refuse(Exit::kUnsupported, files.input(), "",
           "all its grids are empty: " + listAll(grids) + "; export a frame that has voxels");
  refuse(Exit::kUnsupported, files.input(), "",
         "has no grid of numbers with voxels, but " + listAll(grids) +
             "; convert one to a level set or a density");
}

std::string_view className(GridClass grid_class) {
  switch (grid_class) {
    case GridClass::kLevelSet:
      return "level set";
    case GridClass::kFogVolume:
      return "fog volume";
    case GridClass::kStaggered:
      return "staggered";
    case GridClass::kUnknown:
      break;
  }
  return "unknown class";
}

}  // namespace

std::string describeGrid(const GridHeader& grid) {
  std::string text =
      fmt::format("'{}' ({}, {}", oneLine(grid.name, 40), grid.type, className(grid.grid_class));
  const bool known = grid.kind != GridKind::kPoints && grid.kind != GridKind::kOther;
  if (known && grid.empty)
    text += ", empty";
  else if (known && grid.active == 0)
    text += ", no active voxel";
  else if (known)
    text += fmt::format(", {} active voxels in {} x {} x {}", grid.active, grid.high.x - grid.low.x + 1,
                        grid.high.y - grid.low.y + 1, grid.high.z - grid.low.z + 1);
  return text + ")";
}

std::string gridPlace(const GridHeader& grid) { return grid.raw ? "" : "grid " + describeGrid(grid); }

std::string gridSubject(const GridHeader& grid) {
  return grid.raw ? "the volume" : "grid '" + grid.name + "'";
}

namespace {

// The part of a grid's name that follows the chosen grid's, in files with several parts as kelp-dump extract
// writes them: beside "reed" and "steam.density" are "reed.Cd" and "steam.heat".
std::string nameBeside(const GridHeader& grid, const GridHeader& chosen) {
  const std::size_t dot = chosen.name.rfind('.');
  for (const std::string& prefix :
       {chosen.name + ".", dot == std::string::npos ? std::string() : chosen.name.substr(0, dot + 1)})
    if (!prefix.empty() && grid.name.starts_with(prefix)) return grid.name.substr(prefix.size());
  return {};
}

// A grid that has voxels, with one of these names: the one that belongs to the chosen grid, or else the first
// of the file.
template <std::size_t N, class Wanted>
std::optional<std::size_t> findNamed(const std::vector<GridHeader>& grids, std::size_t chosen,
                                     const std::array<std::string_view, N>& names, const Wanted& wanted) {
  std::optional<std::size_t> found;
  for (std::size_t i = 0; i < grids.size(); ++i) {
    if (i == chosen || grids[i].empty || !wanted(grids[i])) continue;
    if (isOneOf(nameBeside(grids[i], grids[chosen]), names)) return i;
    if (!found && isOneOf(grids[i].name, names)) found = i;
  }
  return found;
}

}  // namespace

void requireVoxels(const InputFiles& files, const GridHeader& grid) {
  const std::string place = gridPlace(grid);
  if (grid.kind == GridKind::kVector)
    refuse(Exit::kUnsupported, files.input(), place,
           "holds vectors: they can color a volume (--color-grid), but not be one; choose a grid of numbers");
  if (isHalf(grid))
    refuse(Exit::kUnsupported, files.input(), place,
           "is a half grid, a type that kelp does not read; save it as a float grid (OpenVDB can write that "
           "with 16 bits a value, too: setSaveFloatAsHalf)");
  if (grid.kind == GridKind::kOther)
    refuse(Exit::kUnsupported, files.input(), place,
           "has values of a type that kelp does not read; convert it to float");
  if (grid.empty && grid.kind != GridKind::kPoints)
    refuse(Exit::kUnsupported, files.input(), place,
           "is empty: it has no voxel but its background; export a frame that has some");
}

VolumeChoice chooseGrids(const InputFiles& files, const std::vector<GridHeader>& grids,
                         const ImportSettings& settings) {
  VolumeChoice choice;
  chooseVolume(files, grids, settings, choice);
  requireVoxels(files, grids[choice.grid]);
  if (settings.color_grid) {
    choice.color = find(files, grids, "--color-grid", *settings.color_grid);
    choice.color_named = true;
    const GridHeader& grid = grids[*choice.color];
    if (!isColor(grid))
      refuse(Exit::kUsage, files.input(), "--color-grid " + oneLine(*settings.color_grid, 60),
             "holds no colors: " + describeGrid(grid) + "; name a grid of vec3s");
    if (grid.empty)
      refuse(Exit::kUsage, files.input(), "--color-grid " + oneLine(*settings.color_grid, 60),
             "is empty; leave the option out");
  } else {
    choice.color = findNamed(grids, choice.grid, kColorNames, isColor);
    choice.attribute =
        findNamed(grids, choice.grid, std::array<std::string_view, 1>{"kelp_attribute"}, isColor);
    choice.palette = findNamed(grids, choice.grid, std::array<std::string_view, 1>{"kelp_palette"}, isColor);
    if (!choice.attribute || !choice.palette) choice.attribute = choice.palette = std::nullopt;
  }
  if (settings.heat_grid) {
    if (settings.heat_grid->empty()) return choice;
    choice.heat = find(files, grids, "--heat-grid", *settings.heat_grid);
    choice.heat_named = true;
    const GridHeader& grid = grids[*choice.heat];
    if (!isScalar(grid))
      refuse(Exit::kUsage, files.input(), "--heat-grid " + oneLine(*settings.heat_grid, 60),
             "holds no numbers: " + describeGrid(grid) + "; name a grid of float");
    if (grid.empty)
      refuse(Exit::kUsage, files.input(), "--heat-grid " + oneLine(*settings.heat_grid, 60),
             "is empty; leave the option out");
  } else {
    choice.heat = findNamed(grids, choice.grid, kHeatNames,
                            [](const GridHeader& grid) { return grid.kind == GridKind::kScalar; });
  }
  return choice;
}

}  // namespace kelp::bake
