// SPDX-License-Identifier: MIT
#include <cstdio>
#include <optional>

#include <fmt/format.h>

#include "commands.h"
#include "kelp/rig_json/rig_json.h"
#include "pack_file.h"
#include "text.h"

namespace kelp::dump {
namespace {

std::vector<RawClip> clipsOf(const Pack& pack) {
  std::vector<RawClip> clips;
  for (const Clip& clip : pack.clips()) {
    RawClip& raw = clips.emplace_back(RawClip{std::string(clip.name), clip.duration, {clip.waves.begin(), clip.waves.end()}, {}});
    for (const Track& track : clip.tracks)
      raw.tracks.push_back({track.part, track.knot, track.target, track.interpolation, {track.keys.begin(), track.keys.end()}});
  }
  return clips;
}

}  // namespace

int rig(const std::string& path, const std::string& wanted, const std::string& axis_name) {
  const std::optional<Axis> axis = parseAxis(axis_name);
  if (!axis) throw DumpError(kUsage, fmt::format("--axis {}: expected +x, -x, +y, -y, +z or -z", nameText(axis_name, 40)));
  PackFile file(path);
  const Pack& pack = file.pack();
  const std::uint32_t index = wanted.empty() ? 0 : file.findPart(wanted);
  const Part& part = pack.parts()[index];
  if (wanted.empty() && pack.parts().size() > 1)
    fmt::print(stderr, "kelp-dump: {}: has {} parts, this is part 0 '{}'; choose another with --part\n", path, pack.parts().size(), nameText(part.name));
  try {
    print(printRig(describeRig(part.knots, clipsOf(pack), index, part.size, *axis)));
  } catch (const RigError& error) {
    throw DumpError(kInvalid, fmt::format("{}: part {} '{}': {}", path, index, nameText(part.name), error.what()));
  }
  return kOk;
}

}  // namespace kelp::dump
