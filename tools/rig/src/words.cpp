// SPDX-License-Identifier: MIT
#include "words.h"

#include <algorithm>
#include <locale>
#include <sstream>
#include <vector>

namespace kelp::rig {
namespace {

char lower(char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c; }

// Edits (insert, delete, replace, swap of neighbors) between two words, without regard to case.
std::size_t editDistance(std::string_view a, std::string_view b) {
  std::vector<std::vector<std::size_t>> d(a.size() + 1, std::vector<std::size_t>(b.size() + 1));
  for (std::size_t i = 0; i <= a.size(); ++i) d[i][0] = i;
  for (std::size_t j = 0; j <= b.size(); ++j) d[0][j] = j;
  for (std::size_t i = 1; i <= a.size(); ++i) {
    for (std::size_t j = 1; j <= b.size(); ++j) {
      const bool same = lower(a[i - 1]) == lower(b[j - 1]);
      d[i][j] = std::min({d[i - 1][j] + 1, d[i][j - 1] + 1, d[i - 1][j - 1] + (same ? 0 : 1)});
      if (i > 1 && j > 1 && lower(a[i - 1]) == lower(b[j - 2]) && lower(a[i - 2]) == lower(b[j - 1]))
        d[i][j] = std::min(d[i][j], d[i - 2][j - 2] + 1);
    }
  }
  return d[a.size()][b.size()];
}

}  // namespace

const char* wordOf(Target target) {
  switch (target) {
    case Target::kKnotOffset:
      return "offset";
    case Target::kKnotTangent:
      return "tangent";
    case Target::kPartTranslation:
      return "translation";
    case Target::kPartRotation:
      return "rotation";
    case Target::kPartScale:
      return "scale";
  }
  return "offset";
}

const char* wordOf(Interpolation interpolation) {
  switch (interpolation) {
    case Interpolation::kStep:
      return "step";
    case Interpolation::kLinear:
      return "linear";
    case Interpolation::kCubic:
      return "cubic";
  }
  return "linear";
}

std::optional<Interpolation> interpolationOf(std::string_view word) {
  for (const Interpolation i : {Interpolation::kStep, Interpolation::kLinear, Interpolation::kCubic}) {
    if (word == wordOf(i)) return i;
  }
  return std::nullopt;
}

std::string_view nearMiss(std::string_view word, std::span<const std::string_view> known) {
  std::string_view best;
  if (word.size() > 40) return best;
  std::size_t best_distance = 3;  // more than two slips is another word
  for (const std::string_view candidate : known) {
    const std::size_t distance = editDistance(word, candidate);
    if (distance < best_distance && 2 * distance <= candidate.size()) {
      best_distance = distance;
      best = candidate;
    }
  }
  return best;
}

std::string suggestion(std::string_view word, std::span<const std::string_view> known) {
  if (const std::string_view near = nearMiss(word, known); !near.empty())
    return "did you mean '" + std::string(near) + "'?";
  std::string list = "known are ";
  for (std::size_t i = 0; i < known.size(); ++i) list += (i ? ", '" : "'") + std::string(known[i]) + "'";
  return list;
}

bool hasControls(std::string_view text) {
  for (std::size_t i = 0; i < text.size(); ++i) {
    const auto byte = static_cast<unsigned char>(text[i]);
    if (byte < 0x20 || byte == 0x7f) return true;
    if (byte == 0xc2 && i + 1 < text.size() && static_cast<unsigned char>(text[i + 1]) < 0xa0) return true;
  }
  return false;
}

std::string printable(std::string_view text) {
  constexpr std::size_t kLongest = 60;
  std::string clean;
  for (const char c : text.substr(0, kLongest))
    clean += static_cast<unsigned char>(c) < 0x20 || c == 0x7f ? '?' : c;
  if (text.size() > kLongest) {
    // no half of a UTF-8 character
    while (!clean.empty() && (static_cast<unsigned char>(clean.back()) & 0xc0) == 0x80) clean.pop_back();
    if (!clean.empty() && static_cast<unsigned char>(clean.back()) >= 0xc0) clean.pop_back();
    clean += "...";
  }
  return clean;
}

std::string printable(double number) {
  std::ostringstream out;
  out.imbue(std::locale::classic());
  out << number;
  return out.str();
}

std::string placeOf(std::span<const Knot> knots, std::uint64_t knot) {
  return "knot " + std::to_string(knot) + " (at " + printable(double{knots[knot].at}) + ")";
}

std::string UniqueNames::make(const std::string& wanted) {
  const std::string base = wanted.empty() ? unnamed_ : wanted;
  int& n = next_[base];  // a pack may hold very many of one name: do not count up from the start each time
  std::string name = n == 0 ? base : base + " " + std::to_string(n + 1);
  while (!used_.insert(name).second) name = base + " " + std::to_string(++n + 1);
  ++n;
  return name;
}

}  // namespace kelp::rig
