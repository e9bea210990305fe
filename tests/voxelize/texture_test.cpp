// SPDX-License-Identifier: MIT
// Filtered textures, against means over texels in double precision.
#include "kelp/voxelize/surface/texture.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>

namespace kelp::bake {
namespace {

// IEC 61966-2-1, in doubles.
double linear(std::uint8_t byte) {
  const double c = byte / 255.0;
  return c <= 0.04045 ? c / 12.92 : std::pow((c + 0.055) / 1.055, 2.4);
}

Image noise(int width, int height, bool opaque, std::uint32_t seed = 1) {
  std::mt19937 random(seed);
  Image image;
  image.width = width;
  image.height = height;
  for (int i = 0; i < width * height; ++i) {
    for (int k = 0; k < 4; ++k)
      image.rgba.push_back(k == 3 && opaque ? 255 : static_cast<std::uint8_t>(random()));
  }
  return image;
}

// Of a texel.
glm::dvec4 truthAt(const Image& image, int x, int y) {
  const std::uint8_t* rgba = &image.rgba[4 * static_cast<std::size_t>(x + image.width * y)];
  if (!image.srgb) return glm::dvec4(rgba[0], rgba[1], rgba[2], rgba[3]) / 255.0;
  return {linear(rgba[0]), linear(rgba[1]), linear(rgba[2]), rgba[3] / 255.0};
}
// The mean over a square of texels: alpha plain, color weighted by alpha.
glm::dvec4 meanOf(const Image& image, int x0, int y0, int side) {
  glm::dvec3 color(0);
  double alpha = 0;
  for (int y = y0; y < y0 + side; ++y) {
    for (int x = x0; x < x0 + side; ++x) {
      const glm::dvec4 texel = truthAt(image, x, y);
      color += glm::dvec3(texel) * texel.a;
      alpha += texel.a;
    }
  }
  return {color / alpha, alpha / (side * side)};
}
void expectNear(const glm::vec4& a, const glm::dvec4& b, double within = 1e-5) {
  for (int k = 0; k < 4; ++k) EXPECT_NEAR(a[k], b[k], within);
}

// In the middle of a texel of any reduction stands the mean of what it covers.
TEST(Texture, ReductionsAreMeans) {
  for (const bool opaque : {true, false}) {
    for (const bool srgb : {true, false}) {
      Image image = noise(16, 16, opaque);
      image.srgb = srgb;
      const TexturePyramid pyramid(image);
      for (int level = 0; level <= 4; ++level) {
        const int side = 1 << level;
        for (int y = 0; y < 16; y += side) {
          for (int x = 0; x < 16; x += side) {
            const glm::vec2 middle((x + 0.5 * side) / 16, (y + 0.5 * side) / 16);
            expectNear(pyramid.sample(middle, static_cast<float>(level), Wrap::kClamp, Wrap::kClamp, false),
                       meanOf(image, x, y, side));
          }
        }
      }
    }
  }
}

TEST(Texture, BetweenReductionsTheyAreMixed) {
  const Image image = noise(8, 8, true);
  const TexturePyramid pyramid(image);
  const glm::dvec4 fine = meanOf(image, 2, 4, 1), all = meanOf(image, 0, 0, 8);
  const glm::vec2 uv(2.5f / 8, 4.5f / 8);
  EXPECT_EQ(pyramid.sample(uv, -3, Wrap::kRepeat, Wrap::kRepeat, false),
            pyramid.sample(uv, 0, Wrap::kRepeat, Wrap::kRepeat, false));
  expectNear(pyramid.sample(uv, 99, Wrap::kRepeat, Wrap::kRepeat, false), all);
  const glm::dvec4 coarse(pyramid.sample(uv, 1, Wrap::kRepeat, Wrap::kRepeat, false));
  expectNear(pyramid.sample(uv, 0.25f, Wrap::kRepeat, Wrap::kRepeat, false), 0.75 * fine + 0.25 * coarse);
}

// Between the middles of four texels the value is bilinear, beyond the border as the wrapping says.
TEST(Texture, InterpolatesAndWraps) {
  const Image image = noise(5, 3, true);
  const TexturePyramid pyramid(image);
  const auto wrapped = [](int i, int count, Wrap wrap) {
    if (wrap == Wrap::kClamp) return std::min(std::max(i, 0), count - 1);
    const int period = wrap == Wrap::kRepeat ? count : 2 * count;
    while (i < 0) i += period;
    i %= period;
    return i < count ? i : period - 1 - i;
  };
  for (const Wrap u : {Wrap::kRepeat, Wrap::kMirror, Wrap::kClamp}) {
    for (const Wrap v : {Wrap::kRepeat, Wrap::kMirror, Wrap::kClamp}) {
      for (double y = -4.3; y < 7; y += 0.7) {
        for (double x = -11.2; x < 16; x += 0.9) {
          const int x0 = static_cast<int>(std::floor(x)), y0 = static_cast<int>(std::floor(y));
          const auto texel = [&](int i, int k) { return truthAt(image, wrapped(i, 5, u), wrapped(k, 3, v)); };
          const glm::dvec4 expected =
              glm::mix(glm::mix(texel(x0, y0), texel(x0 + 1, y0), x - x0),
                       glm::mix(texel(x0, y0 + 1), texel(x0 + 1, y0 + 1), x - x0), y - y0);
          // x and y count from the middle of the first texel.
          const glm::vec2 uv((x + 0.5) / 5, (y + 0.5) / 3);
          expectNear(pyramid.sample(uv, 0, u, v, false), expected, 1e-4);
          expectNear(pyramid.sample(glm::vec2((x0 + 0.51) / 5, (y0 + 0.51) / 3), 0, u, v, true),
                     texel(x0, y0), 1e-6);
        }
      }
    }
  }
}

// Transparent texels give no color: half of them leave the color and halves the alpha.
TEST(Texture, TransparentTexelsGiveNoColor) {
  Image image;
  image.width = 2;
  image.height = 1;
  image.rgba = {255, 0, 0, 0, 0, 255, 0, 255};
  const TexturePyramid pyramid(image);
  expectNear(pyramid.sample({0.5f, 0.5f}, 0, Wrap::kClamp, Wrap::kClamp, false), {0, 1, 0, 0.5});
  expectNear(pyramid.sample({0.5f, 0.5f}, 1, Wrap::kClamp, Wrap::kClamp, false), {0, 1, 0, 0.5});
}

// Coordinates come from files: whatever they are, a texel of the picture answers.
TEST(Texture, AnyCoordinatesAreHarmless) {
  const Image image = noise(7, 3, false);
  const TexturePyramid pyramid(image);
  const float inf = std::numeric_limits<float>::infinity();
  for (const float u : {std::nanf(""), inf, -inf, 1e30f, -1e30f, 3e9f}) {
    for (const Wrap wrap : {Wrap::kRepeat, Wrap::kMirror, Wrap::kClamp}) {
      for (const bool nearest : {false, true}) {
        const glm::vec4 sample = pyramid.sample({u, -u}, 0.5f, wrap, wrap, nearest);
        for (int k = 0; k < 4; ++k) EXPECT_TRUE(sample[k] >= 0 && sample[k] <= 1.00001f);
      }
    }
  }
}

}  // namespace
}  // namespace kelp::bake
