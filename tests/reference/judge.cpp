// SPDX-License-Identifier: MIT
#include "reference/judge.h"

#include <algorithm>

namespace kelp::reference {

Truth truthOf(const Volume& volume, std::span<const Knot> knots, const glm::dvec3& o, const glm::dvec3& r,
              double s_max) {
  Truth truth;
  const auto possible = firstTouch(volume, knots, o, r, 0, s_max, -kMargin);
  if (!possible) return truth;
  truth.possible = possible->s;
  // Shrunken voxels lie in grown ones, so the search may start there.
  if (const auto owed = firstTouch(volume, knots, o, r, std::max(possible->s - 1e-3, 0.0), s_max, kMargin))
    truth.owed = owed->s;
  return truth;
}

Verdict judge(const Truth& truth, std::optional<double> s) {
  if (truth.owed && (!s || *s > *truth.owed + 1)) return Verdict::kMissed;
  if (s && (!truth.possible || *s < *truth.possible - 1)) return Verdict::kFalse;
  return Verdict::kRight;
}

}  // namespace kelp::reference
