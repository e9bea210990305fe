// SPDX-License-Identifier: MIT
// Joints of two packs: the first of a name is compared with the other pack's first, the second with the
// second.
#include <algorithm>
#include <map>
#include <set>
#include <vector>

#include <fmt/format.h>

#include "diff/diff.h"
#include "text/text.h"

namespace kelp::dump {
namespace {

double largestEntry(const glm::vec3& v) {
  return static_cast<double>(std::max({std::abs(v.x), std::abs(v.y), std::abs(v.z)}));
}

// The largest difference of two inverse bind matrices, as a share of their largest number: of the axes, or of
// the places.
double distanceOf(const Joint& a, const Joint& b) {
  double apart[2] = {0, 0}, range[2] = {0, 0};
  for (int column = 0; column < 4; ++column) {
    const int which = column / 3;
    apart[which] = std::max(apart[which], largestEntry(a.inverse_bind[column] - b.inverse_bind[column]));
    range[which] =
        std::max({range[which], largestEntry(a.inverse_bind[column]), largestEntry(b.inverse_bind[column])});
  }
  return std::max(apart[0] / range[0], range[1] > 0 ? apart[1] / range[1] : 0);
}

// The parts of a joint of A, as indices of B. -1: a part that is in A alone.
std::set<int> partsInB(const Joint& joint, const PartPairs& pairs) {
  std::set<int> out;
  for (const std::uint32_t part : joint.parts) out.insert(pairs.b_of_a[part]);
  return out;
}

}  // namespace

void diffJoints(const Pack& a, const Pack& b, const PartPairs& pairs, const Tolerance& tolerance,
                std::vector<Difference>& out) {
  const auto say = [&](const Joint& joint, const std::string& what) -> Difference& {
    Difference difference{"joint", fmt::format("joint '{}' {}", nameText(joint.name, 40), what)};
    difference.name = joint.name;
    return out.emplace_back(difference);
  };
  std::map<std::string_view, std::vector<int>> named;
  for (std::size_t j = b.joints().size(); j-- > 0;) named[b.joints()[j].name].push_back(static_cast<int>(j));
  std::vector<int> b_of_a;
  std::vector<bool> paired(b.joints().size());
  for (const Joint& joint : a.joints()) {
    std::vector<int>& left = named[joint.name];
    b_of_a.push_back(left.empty() ? -1 : left.back());
    if (left.empty()) {
      say(joint, "is in A alone").only_in = "a";
      continue;
    }
    const Joint& other = b.joints()[static_cast<std::size_t>(left.back())];
    paired[static_cast<std::size_t>(left.back())] = true;
    left.pop_back();
    if (other.parent != (joint.parent < 0 ? -1 : b_of_a[static_cast<std::size_t>(joint.parent)]))
      say(joint, "has another parent");
    if (const double apart = distanceOf(joint, other); !tolerance.allows(apart, 1))
      say(joint, "has another inverse bind matrix").largest = apart;
    if (partsInB(joint, pairs) != std::set<int>(other.parts.begin(), other.parts.end()))
      say(joint, "has other parts");
  }
  for (std::size_t j = 0; j < paired.size(); ++j)
    if (!paired[j]) say(b.joints()[j], "is in B alone").only_in = "b";
}

}  // namespace kelp::dump
