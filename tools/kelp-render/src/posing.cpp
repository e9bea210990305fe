// SPDX-License-Identifier: MIT
#include "posing.h"

#include <charconv>

#include <fmt/format.h>

#include "kelp/common/pack_error.h"
#include "kelp/formats/sweep.h"

namespace kelp::render {
namespace {

// At most eight names, for a message.
template <class Range>
std::string listNames(const Range& things) {
  std::string list;
  int count = 0;
  for (const auto& thing : things) {
    if (++count > 8) return list + ", ...";
    list += fmt::format("{}{}", list.empty() ? "" : ", ", thing.name);
  }
  return list.empty() ? "none" : list;
}

int findPart(const Pack& pack, const KnotChange& change) {
  const std::span<const Part> parts = pack.parts();
  if (change.part.empty()) {
    if (parts.size() == 1) return 0;
    throw ToolError(Exit::kUsage,
                    fmt::format("{}: the pack has several parts; say which as PART:KNOT. Parts: {}",
                                change.text, listNames(parts)));
  }
  for (std::size_t i = 0; i < parts.size(); ++i) {
    if (parts[i].name == change.part) return static_cast<int>(i);
  }
  int index = -1;
  const char* const end = change.part.data() + change.part.size();
  const auto parsed = std::from_chars(change.part.data(), end, index);
  if (parsed.ec == std::errc() && parsed.ptr == end && index >= 0 &&
      static_cast<std::size_t>(index) < parts.size())
    return index;
  throw ToolError(Exit::kUsage, fmt::format("{}: the pack has no part \"{}\". Parts: {}", change.text,
                                            change.part, listNames(parts)));
}

// Says why a part cannot be drawn, where, and what to do. Empty: it can.
std::string wrongWith(const Part& part, std::span<const Knot> knots, float roll) {
  const Result<void> sound = checkRig(part.bend, knots, part.size, roll);
  if (sound) return {};
  const auto knot = static_cast<std::size_t>(sound.error().offset);
  if (sound.error().code == ErrorCode::kMisuse)
    return fmt::format("part {}: knot {} (at {}): {}; give it another --tangent or --offset", part.name, knot,
                       knots[knot].at, sound.error().detail);
  const std::string between = fmt::format("between knots {} and {} (at {} to {})", knot, knot + 1,
                                          knots[knot].at, knots[knot + 1].at);
  if (part.bend == Bend::kSweep)
    return fmt::format(
        "part {}: the spline bends too sharply for the part's thickness {}; a swept part may not "
        "fold: let it turn over a greater length, or less far",
        part.name, between);
  return fmt::format(
      "part {}: the spline turns back along its axis {}; let the knots' y ascend, and keep the y of "
      "every tangent between 0 and 3 times the slope to the next knot",
      part.name, between);
}

}  // namespace

Posing::Posing(const runtime::Asset& asset, const Item& item) : asset_(asset), item_(item) {
  const Pack& pack = asset.pack();
  for (const KnotChange& change : item.changes) {
    const int part = findPart(pack, change);
    const std::size_t knots = pack.parts()[static_cast<std::size_t>(part)].knots.size();
    if (static_cast<std::size_t>(change.knot) >= knots) {
      throw ToolError(Exit::kUsage, fmt::format("{}: the part has the knots 0 to {}; name one of them",
                                                change.text, knots - 1));
    }
    changes_.push_back({part, &change});
  }
  if (item.clip.empty()) return;
  const Result<int> found = runtime::findClip(asset, item.clip);
  if (!found)
    throw ToolError(Exit::kUsage, fmt::format("--clip {}: {} has no such clip. Clips: {}", item.clip,
                                              item.pack, listNames(pack.clips())));
  clip_ = *found;
}

double Posing::duration() const {
  return clip_ < 0 ? 0 : double{asset_.pack().clips()[static_cast<std::size_t>(clip_)].duration};
}

void Posing::apply(double seconds, runtime::Pose& pose) const {
  pose.reset();
  // Tangents last, so that none of them follows a knot.
  for (const bool tangents : {false, true}) {
    for (const auto& [part, change] : changes_) {
      if (change->tangent != tangents) continue;
      (void)(tangents ? pose.setTangent(part, change->knot, change->value)
                      : pose.move(part, change->knot, change->value));
    }
  }
  if (clip_ >= 0) {
    if (const auto added = runtime::addClip(asset_, clip_, item_.time + seconds, 1, pose); !added)
      failPack(item_.pack, added.error());
  }
  for (int p = 0; p < pose.parts(); ++p) {
    const Part& part = asset_.pack().parts()[static_cast<std::size_t>(p)];
    const std::string wrong = wrongWith(part, pose.knots(p), part.roll + pose.motion(p)->roll);
    if (wrong.empty()) continue;
    const std::string moment =
        clip_ < 0 ? "" : fmt::format("--clip {} at {:.6g} s: ", item_.clip, item_.time + seconds);
    throw ToolError(Exit::kInvalid, fmt::format("{}: {}{}", item_.pack, moment, wrong));
  }
}

}  // namespace kelp::render
