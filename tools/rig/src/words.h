// SPDX-License-Identifier: MIT
// The words of the rig language and of its messages: names of enums, near misses, printable text.
#pragma once

#include <array>
#include <map>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <string_view>

#include "kelp/formats/model.h"

namespace kelp::rig {

const char* wordOf(Target target);
// Whatever a wave or a key moves: a target, or of a section width or twist (RigDescription::Wave).
struct MovedThing {
  Target target;
  bool of_section = false;
  bool operator==(const MovedThing&) const = default;
};
inline constexpr MovedThing kWidth{Target::kKnotOffset, true}, kTwist{Target::kKnotTangent, true};
// Those that waves move first.
inline constexpr std::array<MovedThing, 7> kMovedThings{{{Target::kKnotOffset},
                                                         {Target::kKnotTangent},
                                                         kWidth,
                                                         kTwist,
                                                         {Target::kPartTranslation},
                                                         {Target::kPartRotation},
                                                         {Target::kPartScale}}};
inline const char* wordOf(const MovedThing& thing) {
  return thing == kWidth ? "width" : thing == kTwist ? "twist" : wordOf(thing.target);
}
const char* wordOf(Interpolation interpolation);
std::optional<Interpolation> interpolationOf(std::string_view word);
inline bool movesKnot(Target target) {
  return target == Target::kKnotOffset || target == Target::kKnotTangent;
}

// The word among `known` that `word` most likely meant, or an empty view.
std::string_view nearMiss(std::string_view word, std::span<const std::string_view> known);
// "did you mean 'period'?", or "known are 'knot', 'period', ..." when nothing is near.
std::string suggestion(std::string_view word, std::span<const std::string_view> known);
// True if UTF-8 text holds one of U+0000 to U+001F or U+007F to U+009F, which names in a pack must not.
bool hasControls(std::string_view text);
// Text from a file for a message of one line: cut to about 60 characters, without control characters.
std::string printable(std::string_view text);
// A number with up to six digits, in the C locale.
std::string printable(double number);
// "knot 1 (at 0.4)"
std::string placeOf(std::span<const Knot> knots, std::uint64_t knot);

// Clips and sockets of a pack may share a name or have none, but in a rig names are keys.
class UniqueNames {
 public:
  explicit UniqueNames(const char* unnamed) : unnamed_(unnamed) {}
  std::string make(const std::string& wanted);

 private:
  const char* unnamed_;
  std::map<std::string, int> next_;
  std::set<std::string> used_;
};

}  // namespace kelp::rig
