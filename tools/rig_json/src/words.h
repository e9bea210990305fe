// SPDX-License-Identifier: MIT
// The words of the rig language and of its error messages: names of enums, near misses, user text made fit to print.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "kelp/formats/model.h"

namespace kelp::rig {

const char* wordOf(Target target);
const char* wordOf(Interpolation interpolation);
std::optional<Interpolation> interpolationOf(std::string_view word);
inline bool movesKnot(Target target) { return target == Target::kKnotOffset || target == Target::kKnotTangent; }

// The word among `known` that `word` most likely meant, or an empty view.
std::string_view nearMiss(std::string_view word, std::span<const std::string_view> known);
// "did you mean 'period'?", or "known are 'knot', 'period', ..." when nothing is near.
std::string suggestion(std::string_view word, std::span<const std::string_view> known);
// Whether UTF-8 text holds one of U+0000 to U+001F and U+007F to U+009F, which no name in a pack may.
bool hasControls(std::string_view text);
// Text from a file, cut to some 60 characters and without control characters, so that a message stays one line.
std::string printable(std::string_view text);
// A number as a person writes it: up to six digits, the C locale.
std::string printable(double number);

}  // namespace kelp::rig
