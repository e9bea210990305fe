// SPDX-License-Identifier: MIT
#include <algorithm>
#include <cmath>
#include <set>
#include <string>
#include <string_view>
#include <utility>

#include <fmt/format.h>

#include "kelp/formats/pack.h"
#include "part_frames.h"
#include "steps.h"

namespace kelp::bake {
namespace {

bool isKnots(Target target) { return target == Target::kKnotOffset || target == Target::kKnotTangent; }

// A clip bends a part if it moves its knots, and moves it if it moves the part as a whole.
bool bends(const RawClip& share) {
  return !share.waves.empty() || std::any_of(share.tracks.begin(), share.tracks.end(),
                                             [](const RawTrack& track) { return isKnots(track.target); });
}
bool moves(const RawClip& share) {
  return std::any_of(share.tracks.begin(), share.tracks.end(),
                     [](const RawTrack& track) { return !isKnots(track.target); });
}

// Clips and sockets that no reader would take by default are refused before the long work.
void checkClips(const RawPack& pack, const std::filesystem::path& input) {
  std::uint64_t bytes = 0;
  for (const RawClip& clip : pack.clips) {
    bytes += sizeof(Clip) + clip.waves.size() * kWaveMemory;
    for (const RawTrack& track : clip.tracks) bytes += sizeof(Track) + track.keys.size() * sizeof(Key);
  }
  for (const RawSocket& socket : pack.sockets) bytes += sizeof(Socket) + socket.name.size();
  constexpr std::uint64_t kMost =
      PackLimits{}.max_metadata_bytes / 16 * 15;  // the rest is for the other tables
  if (bytes > kMost)
    throw ToolError(
        Exit::kUnsupported,
        fmt::format("{}: its clips and sockets take {} MiB in memory, and packs with more than {} "
                    "are not read by default; leave some out, or give clips fewer keys",
                    input.filename().string(), bytes >> 20, kMost >> 20));
}

bool isFinite(const glm::vec4& v) {
  return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z) && std::isfinite(v.w);
}

// A file's numbers are finite; what they are by the part's size or its scale at rest may not be.
void checkTracks(const SourceModel& model, const RawPack& pack, const std::filesystem::path& input) {
  for (const RawClip& clip : pack.clips)
    for (const RawTrack& track : clip.tracks)
      for (const Key& key : track.keys)
        if (!isFinite(key.value) || !isFinite(key.in) || !isFinite(key.out))
          throw ToolError(
              Exit::kInvalid,
              fmt::format("{}: clip '{}': its key at {:g} s is beyond what a 32-bit float can hold, seen "
                          "from the part at rest; give the part a larger scale there, or move it less",
                          partPlace(input, model.parts[track.part]), clip.name, key.time));
}

void give(const RawRig& rest, RawPart& part) {
  part.knots = rest.knots;
  part.automatic_tangents = rest.automatic_tangents;
  part.parent_at = rest.parent_at;
  part.bend = rest.bend;
  part.roll = rest.roll;
}

}  // namespace

void chooseBends(SourceModel& model, const Settings& settings) {
  for (SourcePart& part : model.parts) {
    if (part.skin) {  // its nodes follow joints
      part.rig.bend = Bend::kShear;
      part.rig.caged = true;
    }
    if (!part.rig.sides.empty()) part.carries = true;
    if (part.rig.bend) continue;
    part.rig.bend = part.fog ? Bend::kShear : settings.bend.value_or(kDefaultBend);
    part.rig.caged = !part.fog && settings.caged;
  }
  for (const SourcePart& part : model.parts)
    if (part.parent >= 0 && part.rig.parent_at != Part::kNotOnSpline)
      model.parts[static_cast<std::size_t>(part.parent)].carries = true;
}

void requireRiggedParts(const SourceModel& model, const ImportSettings& settings,
                        const std::filesystem::path& input) {
  if (!model.outer) return;
  constexpr std::size_t kMostNames = 40;
  std::string names;
  std::set<std::string_view> there;
  for (const SourcePart& part : model.parts)
    if (there.insert(part.name).second && there.size() <= kMostNames)
      names += fmt::format("{}'{}'", names.empty() ? "" : ", ", part.name);
  if (there.size() > kMostNames) names += fmt::format(" and {} more", there.size() - kMostNames);
  for (const RigFile::PartRig& rig : model.outer->file.parts)
    if (!there.contains(rig.name))
      throw ToolError(
          Exit::kInvalid,
          fmt::format("{}: there is no part '{}', for which the rig ({}) has one; parts are {}: correct the "
                      "name under \"parts\", or take it out{}",
                      input.filename().string(), rig.name, model.outer->origin, names,
                      model.hasNodes() && settings.parts == Parts::kOne
                          ? "; --parts nodes makes a part of each node or .vox object"
                          : ""));
}

void rigParts(const SourceModel& model, const std::filesystem::path& input, RawPack& pack, Report& report) {
  std::vector<RawClip> clips;
  std::vector<RawRig> rests;
  for (std::size_t i = 0; i < model.parts.size(); ++i) {
    try {
      const RawRig& rest = rests.emplace_back(realizeRig(model.parts[i].rig));
      checkRest(rest, pack.parts[i].size);
      give(rest, pack.parts[i]);
      for (auto& socket : realizeSockets(model.parts[i].rig, static_cast<std::uint32_t>(i)))
        pack.sockets.push_back(std::move(socket));
      for (auto& clip : realizeClips(model.parts[i].rig, static_cast<std::uint32_t>(i)))
        clips.push_back(std::move(clip));
    } catch (const RigError& error) {
      throw ToolError(Exit::kInvalid, fmt::format("{} ({}): {}", partPlace(input, model.parts[i]),
                                                  model.parts[i].rig_origin, error.what()));
    }
    if (pack.parts[i].parent_at != Part::kNotOnSpline && model.parts[i].parent < 0)
      throw ToolError(Exit::kInvalid,
                      fmt::format("{} ({}): /parent_at: the part has no parent part to hang on; take it out, "
                                  "or put the part's node below that of another part",
                                  partPlace(input, model.parts[i]), model.parts[i].rig_origin));
  }
  mergeClips(pack.clips, std::move(clips));
  checkClips(pack, input);
  checkTracks(model, pack, input);
  std::set<std::uint32_t> sections;  // their knots are no places
  for (const SourcePart& part : model.parts)
    if (part.sections >= 0) sections.insert(static_cast<std::uint32_t>(part.sections));
  for (const RawClip& clip : pack.clips) {
    for (const auto& [part, share] : splitByPart(clip)) {
      const SourcePart& source = model.parts[part];
      if (sections.contains(part)) {
        report.clips.push_back({clip.name, source.name, clip.duration, 0, true, false, {}});
        continue;
      }
      try {
        const ClipReport proof = proveClip(share, part, rests[part], pack.parts[part].size);
        report.clips.push_back(
            {clip.name, source.name, clip.duration, proof.leaves_box, bends(share), moves(share), {}});
      } catch (const RigError& error) {
        throw ToolError(Exit::kInvalid, fmt::format("{} ({}): {}", partPlace(input, source),
                                                    source.rig_origin, error.what()));
      }
    }
  }
}

}  // namespace kelp::bake
