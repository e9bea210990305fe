// SPDX-License-Identifier: MIT
// Sockets of two packs: those of one name on parts that belong together are compared.
#include <algorithm>
#include <cmath>
#include <vector>

#include <fmt/format.h>

#include "diff/diff.h"
#include "text/text.h"

namespace kelp::dump {
namespace {

// In heights of the part; for the rotation, the largest component of the difference.
double distanceOf(const Socket& a, const Socket& b) {
  const auto turned = [&](float sign) {
    const glm::dvec4 u(a.rotation.x, a.rotation.y, a.rotation.z, a.rotation.w),
        v(b.rotation.x, b.rotation.y, b.rotation.z, b.rotation.w);
    const glm::dvec4 apart = u - double{sign} * v;
    return std::max({std::abs(apart.x), std::abs(apart.y), std::abs(apart.z), std::abs(apart.w)});
  };
  return std::max({std::abs(double{a.at} - double{b.at}), std::abs(double{a.offset.x} - double{b.offset.x}),
                   std::abs(double{a.offset.y} - double{b.offset.y}),
                   std::min(turned(1), turned(-1))});  // q and -q are the same rotation
}

}  // namespace

void diffSockets(const Pack& a, const Pack& b, const PartPairs& pairs, const Tolerance& tolerance,
                 std::vector<Difference>& out) {
  std::vector<bool> paired(b.sockets().size());
  const auto say = [&](const Pack& of, const Socket& socket, const std::string& what) -> Difference& {
    Difference difference{"socket", fmt::format("socket '{}' of part '{}' {}", nameText(socket.name, 40),
                                                nameText(of.parts()[socket.part].name, 40), what)};
    difference.name = socket.name;
    return out.emplace_back(difference);
  };
  for (const Socket& socket : a.sockets()) {
    std::size_t j = 0;
    const int part = pairs.b_of_a[socket.part];
    while (j < paired.size() &&
           (paired[j] || b.sockets()[j].name != socket.name || static_cast<int>(b.sockets()[j].part) != part))
      ++j;
    if (j == paired.size()) {
      say(a, socket, "is in A alone").only_in = "a";
      continue;
    }
    paired[j] = true;
    const double apart = distanceOf(socket, b.sockets()[j]);
    if (!tolerance.allows(apart, 1)) say(a, socket, "is elsewhere, or turned").largest = apart;
  }
  for (std::size_t j = 0; j < paired.size(); ++j)
    if (!paired[j]) say(b, b.sockets()[j], "is in B alone").only_in = "b";
}

}  // namespace kelp::dump
