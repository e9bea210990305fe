// SPDX-License-Identifier: MIT
// For tests of parts with cages: pictures compared with those of other parts.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <vector>

#include "canvas.h"
#include "support/cage_pack.h"

namespace kelp::test {

using runtime::Instance;

// Where the point that is seen is at rest.
inline constexpr char kRestSurface[] =
    "vec4 kelpSurface(KelpSurface s) { return vec4(s.rest / s.size, 1.0); }\n";

// How two such pictures differ.
struct Difference {
  int covered = 0;  // in both
  int outline = 0;  // covered in one alone
  // Of `covered`: by more than 1/85 of the size from what the other shows there, and in each of the eight
  // pixels around it. (Edges of voxels are eroded without a cage, and not with one.)
  int apart = 0;
  double iou() const { return static_cast<double>(covered) / (covered + outline); }
};
inline Difference differenceOf(const std::vector<Pixel>& a, const std::vector<Pixel>& b,
                               const glm::ivec2& size) {
  Difference difference;
  for (int y = 0; y < size.y; ++y) {
    for (int x = 0; x < size.x; ++x) {
      const Pixel& in_a = a[static_cast<std::size_t>(x + size.x * y)];
      const Pixel& in_b = b[static_cast<std::size_t>(x + size.x * y)];
      difference.covered += in_a[3] != 0 && in_b[3] != 0;
      difference.outline += (in_a[3] != 0) != (in_b[3] != 0);
      if (in_a[3] == 0 || in_b[3] == 0) continue;
      int least = 255;
      for (int i = 0; i < 9; ++i) {
        const glm::ivec2 at = glm::clamp(glm::ivec2(x + i % 3 - 1, y + i / 3 - 1), glm::ivec2(0), size - 1);
        const Pixel& near = a[static_cast<std::size_t>(at.x + size.x * at.y)];
        int most = 0;
        for (std::size_t k = 0; k < 4; ++k) most = std::max(most, std::abs(near[k] - in_b[k]));
        least = std::min(least, most);
      }
      difference.apart += least > 3;
    }
  }
  return difference;
}

class CagedTest : public GlTest {
 protected:
  static std::vector<Pixel> draw(gl::Renderer& renderer, const gl::View& view, const Instance& instance,
                                 const Canvas& canvas) {
    canvas.clear();
    const auto drawn = renderer.draw(view, instance);
    EXPECT_TRUE(drawn);
    if (drawn) {
      EXPECT_EQ(drawn->instances, 1u);
      EXPECT_EQ(drawn->left_out, 0u);
    }
    EXPECT_EQ(glGetError(), GLenum{GL_NO_ERROR});
    return canvas.pixels();
  }
  static gl::View closeTo(const Canvas& canvas, const Instance& instance,
                          const glm::vec3& from = {0.5f, 0.3f, 0.8f}) {
    const Box box = bounds(instance);
    const glm::vec3 middle = 0.5f * (box.min + box.max);
    return lookAt(canvas, middle + 0.9f * glm::distance(box.min, box.max) * from, middle);
  }
};

}  // namespace kelp::test
