// SPDX-License-Identifier: MIT
#include "diff/diff.h"

#include <algorithm>
#include <map>
#include <memory>

#include <fmt/format.h>

#include "text/text.h"

namespace kelp::dump {

PartPairs pairParts(const Pack& a, const Pack& b) {
  PartPairs pairs{std::vector<int>(a.parts().size(), -1), std::vector<int>(b.parts().size(), -1)};
  // Names need not be unique. The first part of a name matches the other pack's first, the second the second.
  std::map<std::string_view, std::vector<int>> named;
  for (std::size_t j = b.parts().size(); j-- > 0;) named[b.parts()[j].name].push_back(static_cast<int>(j));
  for (std::size_t i = 0; i < a.parts().size(); ++i) {
    std::vector<int>& left = named[a.parts()[i].name];
    if (left.empty()) continue;
    pairs.b_of_a[i] = left.back();
    pairs.a_of_b[static_cast<std::size_t>(left.back())] = static_cast<int>(i);
    left.pop_back();
  }
  return pairs;
}

namespace {

void onlyIn(const char* which, const Part& part, std::vector<Difference>& out) {
  Difference difference{
      "part", fmt::format("part '{}' is in {} alone", nameText(part.name), *which == 'a' ? "A" : "B"), which};
  difference.name = part.name;
  out.push_back(difference);
}

}  // namespace

DiffReport compare(PackFile& file_a, PackFile& file_b, double share) {
  const Pack &a = file_a.pack(), &b = file_b.pack();
  const Tolerance tolerance(share);
  DiffReport report{file_a.path(), file_b.path(), share, a.parts().size(), 0, a.clips().size(), {}};
  for (const Part& part : a.parts()) report.levels += static_cast<std::uint64_t>(part.levels);

  std::vector<Difference>& out = report.differences;
  const auto palette = std::make_unique<PaletteDistances>(comparePalettes(a, b, tolerance));
  const PartPairs pairs = pairParts(a, b);
  diffInfo(a, b, out);
  diffPalettes(a, b, *palette, out);
  for (std::size_t i = 0; i < a.parts().size(); ++i)
    if (pairs.b_of_a[i] < 0) onlyIn("a", a.parts()[i], out);
  for (std::size_t j = 0; j < b.parts().size(); ++j)
    if (pairs.a_of_b[j] < 0) onlyIn("b", b.parts()[j], out);
  for (std::size_t i = 0; i < a.parts().size(); ++i) {
    const int part_a = static_cast<int>(i), part_b = pairs.b_of_a[i];
    if (part_b < 0 || !diffPart(a, b, part_a, pairs, tolerance, out)) continue;
    for (int level = std::min(a.parts()[i].levels, b.parts()[static_cast<std::size_t>(part_b)].levels);
         level-- > 0;) {
      if (a.parts()[i].fog)
        diffFog(file_a, file_b, part_a, part_b, level, tolerance, out);
      else
        diffVoxels(file_a, file_b, part_a, part_b, level, *palette, tolerance, out);
    }
    if (!a.parts()[i].fog) diffDistances(file_a, file_b, part_a, part_b, out);
  }
  diffClips(a, b, pairs, tolerance, out);
  diffSockets(a, b, pairs, tolerance, out);
  diffJoints(a, b, pairs, tolerance, out);
  return report;
}

}  // namespace kelp::dump
