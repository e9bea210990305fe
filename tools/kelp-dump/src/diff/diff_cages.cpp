// SPDX-License-Identifier: MIT
// Compares the cages of two parts.
#include <algorithm>
#include <span>

#include <fmt/format.h>

#include "diff/diff.h"

namespace kelp::dump {
namespace {

std::string cageText(const Part& part) {
  return part.cages.empty() ? "no cage" : fmt::format("cells of {}", part.cages[0].side);
}

bool sameMorphs(std::span<const Morph> a, std::span<const Morph> b) {
  return std::equal(a.begin(), a.end(), b.begin(), b.end(), [](const Morph& x, const Morph& y) {
    return x.part == y.part && std::equal(x.moved.begin(), x.moved.end(), y.moved.begin(), y.moved.end(),
                                          [](const MovedNode& u, const MovedNode& v) {
                                            return u.node == v.node && u.offset == v.offset;
                                          });
  });
}

}  // namespace

void diffCages(const Part& a, const Part& b, std::vector<Difference>& out) {
  const auto say = [&](const std::string& text) -> Difference& {
    Difference difference{"cage", "cage: " + text};
    difference.name = a.name;
    return out.emplace_back(difference);
  };
  if (cageText(a) != cageText(b)) {
    Difference& difference = say(cageText(a) + " and " + cageText(b));
    difference.a = cageText(a);
    difference.b = cageText(b);
  } else if (a.sections != b.sections) {
    say("other sections");
  } else if (a.size == b.size) {
    for (std::size_t i = 0; i < std::min(a.cages.size(), b.cages.size()); ++i) {
      const Cage &u = a.cages[i], &v = b.cages[i];
      const auto differ = [](std::span<const std::uint32_t> x, std::span<const std::uint32_t> y) {
        return !std::equal(x.begin(), x.end(), y.begin(), y.end());
      };
      if (differ(u.words, v.words) || differ(u.places, v.places) || differ(u.follows, v.follows))
        say(fmt::format("other cells, pieces or nodes for level {}", u.level));
      else if (i == 0 && !std::equal(u.influences.begin(), u.influences.end(), v.influences.begin(),
                                     v.influences.end()))
        say("nodes follow other parts, or by other weights");
      else if (i == 0 && !sameMorphs(u.morphs, v.morphs))
        say("morph targets move other nodes, or otherwise");
    }
  }
}

}  // namespace kelp::dump
