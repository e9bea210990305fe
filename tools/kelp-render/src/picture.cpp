// SPDX-License-Identifier: MIT
#include "picture.h"

#include <array>
#include <cmath>

#include <glm/common.hpp>
#include <glm/vec4.hpp>

#include "kelp/common/srgb.h"

namespace kelp::render {
namespace {

// What a byte means: light, or a plain number.
class Transfer {
 public:
  explicit Transfer(bool colors) : colors_(colors) {
    for (int i = 0; i < 256; ++i) {
      const float value = static_cast<float>(i) / 255.0f;
      table_[static_cast<std::size_t>(i)] = colors ? srgbToLinear(value) : value;
    }
  }
  float decode(std::uint8_t byte) const { return table_[byte]; }
  float decode(float value) const { return colors_ ? srgbToLinear(value) : value; }
  std::uint8_t encode(float value) const {
    const float clamped = glm::clamp(value, 0.0f, 1.0f);
    return static_cast<std::uint8_t>(std::lround(255.0f * (colors_ ? linearToSrgb(clamped) : clamped)));
  }

 private:
  bool colors_;
  std::array<float, 256> table_{};
};

}  // namespace

Picture resolve(const std::vector<std::uint8_t>& drawn, glm::ivec2 size, int samples, bool colors,
                const Background& background) {
  const Transfer transfer(colors);
  Picture picture;
  picture.size = size;
  picture.rgba.resize(4 * static_cast<std::size_t>(size.x) * static_cast<std::size_t>(size.y));
  const float share = 1.0f / static_cast<float>(samples * samples);
  for (int y = 0; y < size.y; ++y) {
    const float height = 1.0f - (static_cast<float>(y) + 0.5f) / static_cast<float>(size.y);
    const glm::vec3 behind = glm::mix(background.bottom, background.top, height);
    for (int x = 0; x < size.x; ++x) {
      glm::vec4 sum(0);  // colour times coverage, coverage
      for (int sy = 0; sy < samples; ++sy) {
        for (int sx = 0; sx < samples; ++sx) {
          const auto row = static_cast<std::size_t>(samples) * static_cast<std::size_t>(size.y - 1 - y) +
                           static_cast<std::size_t>(sy);
          const std::uint8_t* from = drawn.data() + 4 * (row * static_cast<std::size_t>(samples * size.x) +
                                                         static_cast<std::size_t>(samples * x + sx));
          sum += glm::vec4(transfer.decode(from[0]), transfer.decode(from[1]), transfer.decode(from[2]),
                           static_cast<float>(from[3]) / 255.0f);
        }
      }
      std::uint8_t* out =
          picture.rgba.data() +
          4 * (static_cast<std::size_t>(y) * static_cast<std::size_t>(size.x) + static_cast<std::size_t>(x));
      const float coverage = share * sum.w;
      for (int i = 0; i < 3; ++i) {
        const float light = background.transparent
                                ? (sum.w > 0 ? sum[i] / sum.w : 0.0f)
                                : share * sum[i] + (1 - coverage) * transfer.decode(behind[i]);
        out[i] = transfer.encode(light);
      }
      out[3] = background.transparent ? static_cast<std::uint8_t>(std::lround(255.0f * coverage))
                                      : std::uint8_t{255};
    }
  }
  return picture;
}

}  // namespace kelp::render
