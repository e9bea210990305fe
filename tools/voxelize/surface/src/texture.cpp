// SPDX-License-Identifier: MIT
#include "kelp/voxelize/surface/texture.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "kelp/common/srgb.h"

namespace kelp::bake {
namespace {

const std::array<float, 256>& linearOfByte(bool srgb) {
  static const auto make = [](bool curve) {
    std::array<float, 256> table{};
    for (int i = 0; i < 256; ++i)
      table[static_cast<std::size_t>(i)] =
          curve ? srgbToLinear(static_cast<float>(i) / 255.0f) : static_cast<float>(i) / 255.0f;
    return table;
  };
  static const std::array<float, 256> curved = make(true);
  static const std::array<float, 256> straight = make(false);
  return srgb ? curved : straight;
}

int wrapTexel(int i, int count, Wrap wrap) {
  switch (wrap) {
    case Wrap::kClamp:
      return std::clamp(i, 0, count - 1);
    case Wrap::kRepeat:
      return ((i % count) + count) % count;
    case Wrap::kMirror: {
      const int period = 2 * count;
      const int folded = ((i % period) + period) % period;
      return folded < count ? folded : period - 1 - folded;
    }
  }
  return 0;
}

// Keeps coordinates where a float still tells texels apart, without moving the picture: two widths are a
// period of both repeats.
float tame(float value, Wrap wrap) {
  if (!std::isfinite(value)) return 0.0f;
  return wrap == Wrap::kClamp ? std::clamp(value, -1.0f, 2.0f) : value - 2.0f * std::floor(value * 0.5f);
}

// The mean of four texels by weights that sum to 1.
glm::vec4 blend(const std::array<glm::vec4, 4>& t, const std::array<float, 4>& weight) {
  if (t[0].a == t[1].a && t[0].a == t[2].a && t[0].a == t[3].a)
    return t[0] * weight[0] + t[1] * weight[1] + t[2] * weight[2] + t[3] * weight[3];
  glm::vec3 color(0);
  float alpha = 0;
  for (std::size_t i = 0; i < 4; ++i) {
    color += glm::vec3(t[i]) * (t[i].a * weight[i]);
    alpha += t[i].a * weight[i];
  }
  return glm::vec4(color / std::max(alpha, 1e-20f), alpha);
}

}  // namespace

TexturePyramid::TexturePyramid(const Image& image) : image_(image) {
  for (glm::ivec2 size(image.width, image.height); size.x > 1 || size.y > 1;) {
    const glm::ivec2 half(std::max(1, size.x / 2), std::max(1, size.y / 2));
    Level level{half.x, half.y, {}};
    level.texels.reserve(static_cast<std::size_t>(half.x) * static_cast<std::size_t>(half.y));
    const std::size_t from = reduced_.size();
    for (int y = 0; y < half.y; ++y) {
      const int y1 = std::min(2 * y + 1, size.y - 1);
      for (int x = 0; x < half.x; ++x) {
        const int x1 = std::min(2 * x + 1, size.x - 1);
        level.texels.push_back(blend(
            {texel(from, 2 * x, 2 * y), texel(from, x1, 2 * y), texel(from, 2 * x, y1), texel(from, x1, y1)},
            {0.25f, 0.25f, 0.25f, 0.25f}));
      }
    }
    reduced_.push_back(std::move(level));
    size = half;
  }
}

glm::ivec2 TexturePyramid::levelSize(std::size_t level) const {
  return level == 0 ? glm::ivec2(image_.width, image_.height)
                    : glm::ivec2(reduced_[level - 1].width, reduced_[level - 1].height);
}

glm::vec4 TexturePyramid::texel(std::size_t level, int x, int y) const {
  if (level > 0) {
    const Level& reduced = reduced_[level - 1];
    return reduced.texels[static_cast<std::size_t>(x) +
                          static_cast<std::size_t>(reduced.width) * static_cast<std::size_t>(y)];
  }
  const std::array<float, 256>& linear = linearOfByte(image_.srgb);
  const std::uint8_t* rgba =
      image_.rgba.data() + 4 * (static_cast<std::size_t>(x) +
                                static_cast<std::size_t>(image_.width) * static_cast<std::size_t>(y));
  return {linear[rgba[0]], linear[rgba[1]], linear[rgba[2]], static_cast<float>(rgba[3]) / 255.0f};
}

glm::vec4 TexturePyramid::sample(glm::vec2 uv, float lod, Wrap wrap_u, Wrap wrap_v, bool nearest) const {
  const float at = std::clamp(lod, 0.0f, static_cast<float>(reduced_.size()));
  const std::size_t level = static_cast<std::size_t>(at);
  const float part = at - static_cast<float>(level);
  const glm::vec4 fine = sampleLevel(uv, level, wrap_u, wrap_v, nearest);
  if (part == 0) return fine;
  const glm::vec4 coarse = sampleLevel(uv, level + 1, wrap_u, wrap_v, nearest);
  return blend({fine, coarse, coarse, coarse}, {1 - part, part, 0, 0});
}

glm::vec4 TexturePyramid::sampleLevel(glm::vec2 uv, std::size_t level, Wrap wrap_u, Wrap wrap_v,
                                      bool nearest) const {
  const glm::ivec2 size = levelSize(level);
  const float x = tame(uv.x, wrap_u) * static_cast<float>(size.x);
  const float y = tame(uv.y, wrap_v) * static_cast<float>(size.y);
  if (nearest)
    return texel(level, wrapTexel(static_cast<int>(std::floor(x)), size.x, wrap_u),
                 wrapTexel(static_cast<int>(std::floor(y)), size.y, wrap_v));
  const float fx = std::floor(x - 0.5f), fy = std::floor(y - 0.5f);
  const float ax = x - 0.5f - fx, ay = y - 0.5f - fy;
  const int x0 = wrapTexel(static_cast<int>(fx), size.x, wrap_u),
            x1 = wrapTexel(static_cast<int>(fx) + 1, size.x, wrap_u);
  const int y0 = wrapTexel(static_cast<int>(fy), size.y, wrap_v),
            y1 = wrapTexel(static_cast<int>(fy) + 1, size.y, wrap_v);
  return blend({texel(level, x0, y0), texel(level, x1, y0), texel(level, x0, y1), texel(level, x1, y1)},
               {(1 - ax) * (1 - ay), ax * (1 - ay), (1 - ax) * ay, ax * ay});
}

}  // namespace kelp::bake
