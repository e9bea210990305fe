// SPDX-License-Identifier: MIT
#include "extract/extract.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "kelp/common/console.h"
#include "kelp/common/output_file.h"
#include "kelp/common/srgb.h"
#include "kelp/rig/rig_file.h"
#include "pack/pack_file.h"
#include "text/text.h"

namespace kelp::dump {
namespace {

bool bends(const Pack& pack, std::uint32_t part) {
  for (const Clip& clip : pack.clips())
    if (std::any_of(clip.waves.begin(), clip.waves.end(),
                    [&](const Wave& wave) { return wave.part == part; }) ||
        std::any_of(clip.tracks.begin(), clip.tracks.end(),
                    [&](const Track& track) { return track.part == part; }))
      return true;
  const std::span<const Knot> knots = pack.parts()[part].knots;
  return std::any_of(knots.begin(), knots.end(), [](const Knot& knot) {
    return knot.position.x != 0 || knot.position.z != 0 || knot.tangent.x != 0 || knot.tangent.z != 0;
  });
}

}  // namespace

void noteRigs(const ExtractRequest& request, const std::vector<std::uint32_t>& parts,
              const glm::dmat3& file_to_object) {
  const Pack& pack = request.file.pack();
  const RiggedPack rigged(pack);
  for (const std::uint32_t index : parts) {
    if (!bends(pack, index)) continue;
    const glm::dmat3 part_to_object(glm::dmat4x3(request.part(index).to_object));
    const double edge = std::cbrt(std::abs(glm::determinant(part_to_object)));
    const std::string it =
        parts.size() > 1 ? fmt::format("part {} '{}'", index, nameText(request.part(index).name, 40)) : "it";
    std::string text =
        fmt::format("the rig of {} cannot be written in the file's axes: give {} a new one", it, it);
    for (const Axis axis :
         {Axis::kPlusX, Axis::kMinusX, Axis::kPlusY, Axis::kMinusY, Axis::kPlusZ, Axis::kMinusZ}) {
      // kelp-bake makes the part's axes of the file's by this rotation.
      const glm::dmat3 apart = file_to_object - part_to_object / edge * glm::dmat3(axisRotation(axis));
      if (std::max({glm::length(apart[0]), glm::length(apart[1]), glm::length(apart[2])}) > 1e-3) continue;
      text = axis == rigged.axes[index]
                 ? ""
                 : fmt::format("bake {} with the rig that kelp-dump rig --part {} --axis {} prints", it,
                               index, toString(axis));
    }
    if (!text.empty()) note(request, text);
  }
}

std::filesystem::path makeFolder(const std::string& output, const char* what) {
  std::filesystem::path folder = console::pathOf(output);
  std::error_code problem;
  std::filesystem::create_directories(folder, problem);
  if (std::error_code ignored; !std::filesystem::is_directory(folder, ignored))
    throw ToolError(
        Exit::kIo, fmt::format("{}: is not a folder and cannot be created as one{}; name a folder for the {}",
                               output, problem ? ": " + problem.message() : "", what));
  return folder;
}

LevelVoxels ExtractRequest::read(std::uint32_t index) const {
  return LevelVoxels(file, index, std::min(level, part(index).levels - 1));
}

void note(const ExtractRequest& request, const std::string& text) {
  say("{}: {}", request.file.path(), text);
}

std::vector<std::uint32_t> solidParts(const ExtractRequest& request, const char* format) {
  std::vector<std::uint32_t> solid;
  std::string fog;
  for (const std::uint32_t part : request.parts) {
    if (!request.fog(part))
      solid.push_back(part);
    else if (fog.size() < 200)
      fog += fmt::format("{}'{}'", fog.empty() ? "" : ", ", nameText(request.part(part).name, 40));
  }
  if (solid.empty())
    throw ToolError(Exit::kUnsupported,
                    fmt::format("{}: {} is fog, which {} cannot hold; use --vdb or --nvdb",
                                request.file.path(), fog, format));
  if (!fog.empty()) note(request, fmt::format("{} left out: {} cannot hold fog", fog, format));
  return solid;
}

std::string partFileName(std::string_view name, std::uint32_t index, std::set<std::string>& taken) {
  std::string safe;
  for (const char c : name.substr(0, 100)) {
    const auto byte = static_cast<unsigned char>(c);
    const bool plain = (byte >= '0' && byte <= '9') || (byte >= 'A' && byte <= 'Z') ||
                       (byte >= 'a' && byte <= 'z') || byte == '-' || byte == '_' ||
                       (byte == '.' && !safe.empty());
    safe += plain ? c : '_';
  }
  if (safe.empty()) safe = "part";
  while (taken.contains(safe)) safe += fmt::format("_{}", index);  // that name may be taken too
  taken.insert(safe);
  return safe;
}

Rgba displayColor(const Material& material) {
  const glm::vec4& color = material.base_color;
  return {linearToSrgb8(color.r), linearToSrgb8(color.g), linearToSrgb8(color.b),
          static_cast<std::uint8_t>(std::lround(255 * std::clamp(color.a, 0.0f, 1.0f)))};
}

}  // namespace kelp::dump
