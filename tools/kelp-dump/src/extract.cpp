// SPDX-License-Identifier: MIT
#include "extract.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "kelp/rig_json/rig_json.h"
#include "output_file.h"
#include "part_axis.h"
#include "text.h"

namespace kelp::dump {
namespace {

const Writer* const kWriters[] = {&kVoxWriter, &kPlyWriter, &kSlicesWriter, &kVdbWriter, &kNanoVdbWriter};

bool bends(const Pack& pack, std::uint32_t part) {
  for (const Clip& clip : pack.clips())
    if (std::any_of(clip.waves.begin(), clip.waves.end(), [&](const Wave& wave) { return wave.part == part; }) ||
        std::any_of(clip.tracks.begin(), clip.tracks.end(), [&](const Track& track) { return track.part == part; }))
      return true;
  const std::span<const Knot> knots = pack.parts()[part].knots;
  return std::any_of(knots.begin(), knots.end(), [](const Knot& knot) { return knot.position.x != 0 || knot.position.z != 0 || knot.tangent.x != 0 || knot.tangent.z != 0; });
}

}  // namespace

void noteRigs(const ExtractRequest& request, const std::vector<std::uint32_t>& parts, const glm::dmat3& file_to_object) {
  const Pack& pack = request.file.pack();
  for (const std::uint32_t index : parts) {
    if (!bends(pack, index)) continue;
    const glm::dmat3 part_to_object(glm::dmat4x3(request.part(index).to_object));
    const double edge = std::cbrt(std::abs(glm::determinant(part_to_object)));
    const std::string it = parts.size() > 1 ? fmt::format("part {} '{}'", index, nameText(request.part(index).name, 40)) : "it";
    std::string text = fmt::format("the rig of {} can not be said in the file's axes: give {} a new one", it, it);
    for (const Axis axis : {Axis::kPlusX, Axis::kMinusX, Axis::kPlusY, Axis::kMinusY, Axis::kPlusZ, Axis::kMinusZ}) {
      // kelp-bake makes the part's axes of the file's by this rotation.
      const glm::dmat3 apart = file_to_object - part_to_object / edge * glm::dmat3(axisRotation(axis));
      if (std::max({glm::length(apart[0]), glm::length(apart[1]), glm::length(apart[2])}) > 1e-3) continue;
      text = axis == bakedAxis(request.part(index)).value_or(Axis::kPlusY) ? "" : fmt::format("bake {} with the rig that kelp-dump rig --part {} --axis {} prints", it, index, toString(axis));
    }
    if (!text.empty()) note(request, text);
  }
}

LevelVoxels ExtractRequest::read(std::uint32_t index) const { return LevelVoxels(file, index, std::min(level, part(index).levels - 1)); }

void note(const ExtractRequest& request, const std::string& text) { say("{}: {}", request.file.path(), text); }

std::vector<std::uint32_t> solidParts(const ExtractRequest& request, const char* format) {
  std::vector<std::uint32_t> solid;
  std::string fog;
  for (const std::uint32_t part : request.parts) {
    if (!request.fog(part)) solid.push_back(part);
    else if (fog.size() < 200) fog += fmt::format("{}'{}'", fog.empty() ? "" : ", ", nameText(request.part(part).name, 40));
  }
  if (solid.empty()) throw DumpError(kUnsupported, fmt::format("{}: {} is fog, which {} can not hold; use --vdb, --nvdb or --slices", request.file.path(), fog, format));
  if (!fog.empty()) note(request, fmt::format("{} left out: {} can not hold fog", fog, format));
  return solid;
}

Rgba displayColor(const Material& material) {
  const auto srgb = [](float linear) {
    const double c = std::clamp(static_cast<double>(linear), 0.0, 1.0);
    return static_cast<std::uint8_t>(std::lround(255 * (c <= 0.0031308 ? 12.92 * c : 1.055 * std::pow(c, 1 / 2.4) - 0.055)));
  };
  const glm::vec4& color = material.base_color;
  return {srgb(color.r), srgb(color.g), srgb(color.b), static_cast<std::uint8_t>(std::lround(255 * std::clamp(color.a, 0.0f, 1.0f)))};
}

std::string extractFormats() {
  std::string text;
  for (const Writer* writer : kWriters)
    if (writer->write || (writer->isThere && writer->isThere())) text += fmt::format("{}{}", text.empty() ? "" : ", ", writer->name);
  return text;
}

int extract(const std::string& path, const std::string& format, const std::string& output, const std::string& wanted, int level) {
  const auto found = std::find_if(std::begin(kWriters), std::end(kWriters), [&](const Writer* one) { return format == one->name; });
  if (found == std::end(kWriters)) throw DumpError(kUsage, fmt::format("--{}: is no format; it has {}", format, extractFormats()));
  const Writer& writer = **found;
  if (!writer.write && !writer.handOver)
    throw DumpError(kUnsupported, fmt::format("--{}: this kelp-dump was built without {}; it has {} (see --version), or build it where {} is installed", format, writer.needs, extractFormats(), writer.needs));
  if (output == "-" && !writer.shown_as) throw DumpError(kUsage, fmt::format("--{} -: standard output can not take it; name a {}", format, format == "slices" ? "folder" : "file"));
  if (format != "slices") checkOutput(output, path, writer.shown_as);  // pictures go into a folder, which no pack is
  if (writer.handOver) {
    std::vector<std::string> arguments{"extract", "--" + format, output, "--level", std::to_string(level)};
    if (!wanted.empty()) arguments.insert(arguments.end(), {"--part", wanted});
    arguments.insert(arguments.end(), {"--", path});
    writer.handOver(std::move(arguments));
  }
  PackFile file(path);
  const std::span<const Part> parts = file.pack().parts();
  ExtractRequest request{file, {}, level, output};
  int levels = 0;
  if (wanted.empty()) {
    for (std::uint32_t part = 0; part < parts.size(); ++part) request.parts.push_back(part);
  } else {
    request.parts.push_back(file.findPart(wanted));
  }
  for (const std::uint32_t part : request.parts) levels = std::max(levels, parts[part].levels);
  if (level < 0 || level >= levels) throw DumpError(kUsage, fmt::format("{}: --level {}: there are levels 0 to {}; choose one of them", path, level, levels - 1));
  writer.write(request);
  return kOk;
}

}  // namespace kelp::dump
