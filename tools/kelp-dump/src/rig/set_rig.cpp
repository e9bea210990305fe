// SPDX-License-Identifier: MIT
#include "rig/set_rig.h"

#include <algorithm>
#include <filesystem>
#include <iterator>
#include <ranges>
#include <span>
#include <string_view>
#include <unordered_map>
#include <unordered_set>
#include <utility>

#include <fmt/format.h>

#include "kelp/common/console.h"
#include "kelp/common/error.h"
#include "kelp/common/output_file.h"
#include "kelp/rig/raw_clips.h"
#include "kelp/rig/rig.h"
#include "pack/pack_file.h"
#include "pack/part_axis.h"
#include "rig/set_rig_info.h"
#include "text/check_output.h"
#include "text/text.h"

namespace kelp::dump {
namespace {

// One byte more than parseRig accepts, so that parseRig reports what is too long.
constexpr std::size_t kMostText = (std::size_t{16} << 20) + 1;

std::string readText(const std::string& path) {
  console::Reading file(path);
  std::string text(kMostText, '\0');
  std::size_t size = 0;
  while (size < kMostText) {
    const std::size_t got = file.read(std::as_writable_bytes(std::span(text).subspan(size)));
    if (got == 0) break;
    size += got;
  }
  if (!file.problem().empty())
    throw ToolError(Exit::kIo, fmt::format("{}: cannot be read: {}; check the path and its permissions", path,
                                           file.problem()));
  text.resize(size);
  return text;
}

bool movesKnot(Target target) { return target == Target::kKnotOffset || target == Target::kKnotTangent; }

// Whether places along the part's axis matter to the rig: it can bend the part, or has sockets. kelp-bake
// adds no empty layers at the ends of such a part.
bool bendable(const RigDescription& rig) {
  return !rig.sockets.empty() ||
         std::any_of(
             rig.knots.begin(), rig.knots.end(),
             [](const RigDescription::Knot& knot) { return knot.tangent || knot.offset != glm::vec3(0); }) ||
         std::any_of(rig.clips.begin(), rig.clips.end(), [](const RigDescription::Clip& clip) {
           return !clip.waves.empty() ||
                  std::any_of(clip.tracks.begin(), clip.tracks.end(),
                              [](const RigDescription::Track& track) { return movesKnot(track.target); });
         });
}

// The same of the rig in the pack. A straight rig is straight to the last bit.
bool bends(const Pack& pack, const std::vector<RawClip>& clips, std::uint32_t index) {
  const Part& part = pack.parts()[index];
  const bool carries =
      std::any_of(pack.sockets().begin(), pack.sockets().end(),
                  [&](const Socket& socket) { return socket.part == index; }) ||
      std::any_of(pack.parts().begin(), pack.parts().end(), [&](const Part& other) {
        return other.parent == static_cast<int>(index) && other.parent_at != Part::kNotOnSpline;
      });
  if (carries) return true;
  const bool straight = std::all_of(part.knots.begin(), part.knots.end(), [](const Knot& k) {
    return k.position == glm::vec3(0, k.at, 0) && k.tangent == glm::vec3(0, 1, 0);
  });
  return !straight || std::any_of(clips.begin(), clips.end(), [&](const RawClip& clip) {
    return std::any_of(clip.waves.begin(), clip.waves.end(),
                       [&](const Wave& wave) { return wave.part == index; }) ||
           std::any_of(clip.tracks.begin(), clip.tracks.end(),
                       [&](const RawTrack& track) { return track.part == index && movesKnot(track.target); });
  });
}

// Clips are merged by name, but a pack may hold several clips of one name. Until the merge, further ones get
// a NUL and a number behind their name. No name in a pack has a NUL.
std::vector<RawClip> toldApart(std::vector<RawClip> clips) {
  std::unordered_map<std::string, std::size_t> named;
  for (RawClip& clip : clips)
    if (const std::size_t before = named[clip.name]++; before > 0)
      clip.name += std::string(1, '\0') + std::to_string(before);
  return clips;
}

std::string_view nameOf(const RawClip& clip) {
  return std::string_view(clip.name).substr(0, clip.name.find('\0'));
}

struct NewRig {
  RigDescription rig;
  std::string origin;   // for messages
  std::string preset;   // or
  std::string content;  // of the file

  const std::string& name() const { return preset.empty() ? origin : preset; }  // as --rig has it
};

// A preset's rig is left empty: it depends on the axis.
NewRig readRig(const std::string& wanted) {
  const std::vector<std::string> presets = presetNames();
  if (std::find(presets.begin(), presets.end(), wanted) != presets.end())
    return {{}, "preset '" + wanted + "'", wanted, ""};
  NewRig read{{}, wanted, "", readText(wanted)};
  try {
    read.rig = parseRig(read.content);
  } catch (const RigError& error) {
    throw ToolError(Exit::kInvalid, fmt::format("{}: {}", wanted, error.what()));
  }
  if (!read.rig.skin.empty())
    throw ToolError(Exit::kInvalid,
                    fmt::format("{}: /skin: which parts a skin becomes is decided when it is baked; bake its "
                                "file again: kelp-bake --rig {}",
                                wanted, wanted));
  return read;
}

class RigSetter {
 public:
  RigSetter(PackFile& file, std::uint32_t part)
      : file_(file), pack_(file.pack()), part_(part), old_clips_(toldApart(rawClips(pack_))) {
    for (const RawClip& clip : old_clips_) old_durations_.try_emplace(clip.name, clip.duration);
  }

  void take(NewRig wanted, std::optional<Axis> given) {
    const std::optional<BakeOptions> read = bakeOptions(pack_.infoJson());
    if (!read)
      throw ToolError(Exit::kInvalid,
                      fmt::format("{}: its INFO about the bake cannot be read, so it is unknown whether this "
                                  "rig fits its voxels; bake it again with this rig: kelp-bake --rig {}",
                                  file_.path(), wanted.name()));
    const BakeOptions& options = *read;
    new_ = std::move(wanted);
    if (!new_.preset.empty()) new_.rig = *presetRig(new_.preset, given ? given : options.axis, options.up);
    by_default_ = part().fog ? Bend::kShear : options.bend.value_or(kDefaultBend);
    if (given && new_.rig.axis && *given != *new_.rig.axis)
      throw ToolError(
          Exit::kUsage,
          fmt::format(
              "--axis {}: {} names the axis {} itself; leave --axis out, or take \"axis\" out of the rig",
              toString(*given), new_.origin, toString(*new_.rig.axis)));
    const bool named = new_.rig.axis.has_value();
    if (!new_.rig.axis) new_.rig.axis = given ? given : options.axis ? options.axis : options.up;
    checkAxis(new_.rig.axis.value_or(Axis::kPlusY), named, given);
    if (options.pad > 0 && bendable(new_.rig) && !bends(pack_, old_clips_, part_))
      throw ToolError(Exit::kInvalid,
                      fmt::format("{}: {} was baked with --pad {} and a rig that does not bend and has no "
                                  "sockets, so empty layers are at "
                                  "the ends of its spline; bake it again with this rig: kelp-bake --rig {}",
                                  new_.origin, what(), options.pad, new_.name()));
    given_axis_ = given;
  }

  RawRigs make() {
    RawRigs rigs;
    for (const Part& each : pack_.parts()) rigs.parts.push_back(rawRig(each));
    try {
      rigs.parts[part_] = realizeRig(new_.rig, by_default_);
      checkRest(rigs.parts[part_], part().size);
      // A rig without sockets leaves those that are there: they may come from the model's own empties.
      for (const RawSocket& socket : rawSockets(pack_))
        if (socket.part != part_ || new_.rig.sockets.empty()) rigs.sockets.push_back(socket);
      std::ranges::move(realizeSockets(new_.rig, part_), std::back_inserter(rigs.sockets));
      std::ranges::stable_sort(rigs.sockets, {}, &RawSocket::part);  // as kelp-bake writes them
      std::vector<std::vector<RawClip>> of_parts = clipsOfParts(old_clips_, pack_.parts().size());
      of_parts[part_] = realizeClips(new_.rig, part_);
      std::vector<RawClip> clips;
      for (std::vector<RawClip>& of_part : of_parts) std::ranges::move(of_part, std::back_inserter(clips));
      mergeClips(rigs.clips, std::move(clips));
      if (pack_.parts().size() > 1) keepIdle(rigs.clips);
    } catch (const RigError& error) {
      refuse(error.what());
    }
    if (new_.rig.parent_at != Part::kNotOnSpline && part().parent < 0)
      refuse("/parent_at: the part has no parent part to hang on; leave parent_at out");
    for (const RawClip& clip : rigs.clips) prove(clip, rigs);
    for (RawClip& clip : rigs.clips) clip.name.resize(nameOf(clip).size());
    const std::string of_several = pack_.parts().size() > 1 ? std::string(part().name) : "";
    rigs.info_json =
        infoWithRig(pack_.infoJson(), of_several, new_.preset,
                    console::nameOf(console::pathOf(new_.origin).filename()), new_.content, given_axis_);
    return rigs;
  }

  std::string summary() const {
    const std::string sockets =
        new_.rig.sockets.empty() ? "" : ", " + plural(new_.rig.sockets.size(), "socket");
    return fmt::format("{} has the rig of {}: {}, {}{}", what(), new_.origin,
                       plural(std::max<std::size_t>(new_.rig.knots.size(), 2), "knot"),
                       plural(new_.rig.clips.size(), "clip"), sockets);
  }

 private:
  const Part& part() const { return pack_.parts()[part_]; }
  std::string what() const { return fmt::format("part {} '{}'", part_, nameText(part().name, 40)); }
  [[noreturn]] void refuse(const std::string& why) const {
    throw ToolError(Exit::kInvalid, fmt::format("{}: {}: {}", new_.origin, what(), why));
  }

  void checkAxis(Axis axis, bool named, const std::optional<Axis>& given) const {
    const std::optional<Axis> baked = bakedAxis(part());
    if (!baked && !given)
      throw ToolError(
          Exit::kUsage,
          fmt::format("{}: the axis of its file along which {} was baked is unknown; give it with --axis",
                      file_.path(), what()));
    if (!baked || *baked == axis) return;
    std::string hint;
    if (!given && !new_.preset.empty())
      hint = fmt::format(", or turn the preset with --axis {}", toString(*baked));
    else if (!named)
      hint = fmt::format(", or give --axis {} if that is what its vectors mean", toString(*baked));
    refuse(fmt::format("the rig bends along {}{}; the voxels were baked along {}: bake again with this rig{}",
                       toString(axis), named ? "" : ", as it names no axis", toString(*baked), hint));
  }

  // Keeps clips that move nothing, except where the new rig has a clip of that name.
  void keepIdle(std::vector<RawClip>& clips) const {
    std::unordered_set<std::string_view> names;
    for (const RawClip& clip : clips) names.insert(nameOf(clip));
    std::vector<RawClip> idle;
    for (const RawClip& clip : old_clips_)
      if (clip.waves.empty() && clip.tracks.empty() && !names.contains(nameOf(clip))) idle.push_back(clip);
    std::ranges::move(idle, std::back_inserter(clips));
  }

  // Proves that no part turns back during the clip. Other parts only need it if the clip repeats at another
  // time than before.
  void prove(const RawClip& clip, const RawRigs& rigs) const {
    const auto old = old_durations_.find(clip.name);
    const bool changed = old == old_durations_.end() || old->second != clip.duration;
    for (const auto& [p, share] : splitByPart(clip)) {
      if (p != part_ && !changed) continue;
      try {
        proveClip(share, p, rigs.parts[p], pack_.parts()[p].size);
      } catch (const RigError& error) {
        throw ToolError(Exit::kInvalid, fmt::format("{}: part {} '{}': {}", new_.origin, p,
                                                    nameText(pack_.parts()[p].name, 40), error.what()));
      }
    }
  }

  PackFile& file_;
  const Pack& pack_;
  const std::uint32_t part_;
  const std::vector<RawClip> old_clips_;
  std::unordered_map<std::string_view, float> old_durations_;
  NewRig new_;
  Bend by_default_ = kDefaultBend;
  std::optional<Axis> given_axis_;
};

void checkRequest(const SetRigRequest& request) {
  const std::string& path = request.path;
  if (request.output.empty() && (path == "-" || console::isPipe(path)))
    throw ToolError(Exit::kUsage,
                    fmt::format("{}: is {}, which cannot be replaced; name the new pack with -o", path,
                                path == "-" ? "standard input" : "a pipe"));
  if (request.rig == "-")
    throw ToolError(Exit::kUsage, "--set -: a rig is not read from standard input; name a file or a preset");
  if (!request.output.empty()) checkBinaryOutput(request.output, request.rig, "a pack");
}

}  // namespace

Exit setRig(const SetRigRequest& request) {
  checkRequest(request);
  PackFile file(request.path);
  NewRig wanted = readRig(request.rig);
  if (request.part.empty() && file.pack().parts().size() > 1)
    throw ToolError(Exit::kUsage, fmt::format("{}: has several parts; choose one of {} with --part",
                                              request.path, file.partList()));
  RigSetter setter(file, request.part.empty() ? 0 : file.findPart(request.part));
  setter.take(std::move(wanted), request.axis);
  const RawRigs rigs = setter.make();

  const std::string& output = request.output.empty() ? request.path : request.output;
  OutputFile out = OutputFile::orStandardOutput(console::pathOf(output));
  const auto write = [](void* user, std::span<const std::byte> bytes) -> Result<void> {
    if (static_cast<OutputFile*>(user)->tryWrite(bytes)) return {};
    return Error{ErrorCode::kIo, "the file cannot be written"};
  };
  const Result<void> written = writeRigs(file.source(), rigs, {write, &out});
  if (!written && !out.failed()) file.fail(written.error());
  const std::string summary = setter.summary();
  file.close();  // Windows does not replace an open file
  out.commit();
  say("{}: {}", output == "-" ? "standard output" : output, summary);
  return Exit::kOk;
}

}  // namespace kelp::dump
