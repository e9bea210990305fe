// SPDX-License-Identifier: MIT
#include "page_state.h"

#include <new>

#include "kelp/formats/brick.h"
#include "layout.h"

namespace kelp::coding {
namespace {

// The numbers 1 to 16 of bins that stand for the odds e^-5.6 .. e^5.6, in steps of e^0.75, of 65536.
constexpr std::array<std::uint16_t, kBins> kOdds = {235,   495,   1037,  2158,  4429,  8849,  16889, 30001,
                                                    35535, 48647, 56687, 61107, 63378, 64499, 65041, 65301};

}  // namespace

bool isPageShape(const PageShape& shape) {
  const glm::ivec3& size = shape.size;
  if (shape.bricks.empty() || shape.bricks.size() > kMaxPageBricks) return false;
  if (!shape.above.empty() && shape.above.size() != shape.bricks.size()) return false;
  if (shape.palette < 1 || shape.palette > 256) return false;
  constexpr int kMost = static_cast<int>(layout::kMaxSide);
  if (size.x < 1 || size.y < 1 || size.z < 1 || size.x > kMost || size.y > kMost || size.z > kMost)
    return false;
  const glm::ivec3 grid = brickGrid(size);
  for (std::size_t i = 0; i < shape.bricks.size(); ++i) {
    const glm::ivec3& p = shape.bricks[i];
    if (p.x < 0 || p.y < 0 || p.z < 0 || p.x >= grid.x || p.y >= grid.y || p.z >= grid.z) return false;
    if (i > 0 && mortonCode(shape.bricks[i - 1]) >= mortonCode(p)) return false;
  }
  return true;
}

PageState* prepareState(const PageShape& shape, Buffer<std::byte>& workspace) {
  if (!workspace.reuse(sizeof(PageState))) return nullptr;
  PageState* const state = new (workspace.data()) PageState;
  for (auto& bins : state->models.solid)
    for (std::size_t bin = 0; bin < kBins; ++bin) bins[bin] = {kOdds[bin], 4};
  const glm::ivec3 grid = brickGrid(shape.size);
  const BrickPlaces places(shape.bricks);
  for (std::size_t b = 0; b < shape.bricks.size(); ++b) {
    for (int i = 0; i < 27; ++i) {
      const glm::ivec3 p = shape.bricks[b] + glm::ivec3(i % 3 - 1, i / 3 % 3 - 1, i / 9 - 1);
      const bool inside = p.x >= 0 && p.y >= 0 && p.z >= 0 && p.x < grid.x && p.y < grid.y && p.z < grid.z;
      state->around[b][static_cast<std::size_t>(i)] =
          inside ? static_cast<std::int16_t>(places.find(p)) : std::int16_t{-2};
    }
  }
  return state;
}

}  // namespace kelp::coding
