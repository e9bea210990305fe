// SPDX-License-Identifier: MIT
// distance() against the truth: it never exceeds it, and is not much less.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "bent_instance.h"
#include "kelp/runtime/level.h"

namespace kelp::test {

// bound / truth near three distances.
class Quality {
 public:
  void add(double truth, double bound) {
    for (int i = 0; i < 3; ++i) {
      if (truth > 0.75 * kNear[i] && truth < 1.33 * kNear[i]) ratios_[i].push_back(bound / truth);
    }
  }
  // Sanitizers ask too few for a median.
  void expectAtLeast(const char* name, const double (&least)[3]) {
    if (kSanitized) return;
    for (int i = 0; i < 3; ++i) {
      std::vector<double>& ratios = ratios_[i];
      ASSERT_GT(ratios.size(), 50u) << name;
      std::nth_element(ratios.begin(), ratios.begin() + static_cast<std::ptrdiff_t>(ratios.size() / 2),
                       ratios.end());
      median_[i] = ratios[ratios.size() / 2];
      EXPECT_GE(median_[i], least[i]) << name << ", " << kNear[i] << " voxels";
    }
    if (allTests())
      std::printf("%s: median of bound / truth %.2f, %.2f, %.2f\n", name, median_[0], median_[1], median_[2]);
  }

 private:
  static constexpr double kNear[3] = {2, 8, 32};
  std::vector<double> ratios_[3];
  double median_[3] = {};
};
// Compares distance() with the truth.
inline void expectBounds(BentInstance& bent, int count, Quality* quality = nullptr) {
  int over = 0;
  for (int i = 0; i < count && over < 3; ++i) {
    const glm::vec3 point = i % 4 == 0 ? bent.anywhere() : bent.beside();
    const double truth = bent.distanceOf(glm::dvec3(point));
    const Result<runtime::Distance> found = distance(bent.instance, point);
    ASSERT_TRUE(found) << found.error().detail;
    ASSERT_NEAR(glm::length(found->away), 1, 1e-5);
    ASSERT_EQ(found->part, 0);
    const double bound{found->bound};
    bool fine = bound <= truth && (bound >= 0 || truth < 1e-5 * bent.voxel);
    if (truth == 0 && bent.instance.asset->distances(0, 0)) {
      bool on_surface = false;  // or as good as
      for (int k = 0; k < 6; ++k) {
        glm::dvec3 beside(point);
        beside[k % 3] += (k < 3 ? 1e-5 : -1e-5) * bent.voxel;
        on_surface |= !bent.inside(beside);
      }
      fine &= bound < 0 || on_surface;
      for (int k = 0; k < 4 && -bound > 1e-5 * bent.voxel; ++k)
        fine &= bent.inside(glm::dvec3(point) - 0.9999 * bound * bent.direction());
    }
    if (!fine) {
      ++over;
      ADD_FAILURE() << bound / bent.voxel << " for " << truth / bent.voxel << " voxels, level "
                    << found->level;
    }
    if (quality) quality->add(truth / bent.voxel, bound / bent.voxel);
  }
}

}  // namespace kelp::test
