// SPDX-License-Identifier: MIT
#include "triangle_picture.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

namespace kelp::sheet {
namespace {

constexpr int kSamples = 2;  // along each side of a pixel

int wrap(int i, int count, Repeat repeat) {
  if (repeat == Repeat::kNone) return std::clamp(i, 0, count - 1);
  const int period = repeat == Repeat::kMirror ? 2 * count : count;
  const int at = ((i % period) + period) % period;
  return at < count ? at : period - 1 - at;
}

glm::vec4 sample(const Texture& texture, glm::vec2 uv) {
  const float x = uv.x * static_cast<float>(texture.width) - 0.5f,
              y = (1 - uv.y) * static_cast<float>(texture.height) - 0.5f;
  const int x0 = static_cast<int>(std::floor(x)), y0 = static_cast<int>(std::floor(y));
  glm::vec4 sum(0);
  for (int dy = 0; dy < 2; ++dy) {
    for (int dx = 0; dx < 2; ++dx) {
      const float share = (dx ? x - static_cast<float>(x0) : 1 - (x - static_cast<float>(x0))) *
                          (dy ? y - static_cast<float>(y0) : 1 - (y - static_cast<float>(y0)));
      sum += share *
             texture.texels[static_cast<std::size_t>(wrap(x0 + dx, texture.width, texture.repeat_u)) +
                            static_cast<std::size_t>(texture.width) *
                                static_cast<std::size_t>(wrap(y0 + dy, texture.height, texture.repeat_v))];
    }
  }
  return sum;
}

glm::vec4 baseColor(const Scene& scene, const Triangle& t, const glm::dvec3& weights) {
  const Surface& surface = scene.surfaces[static_cast<std::size_t>(t.surface)];
  glm::vec4 color(0);
  glm::vec2 uv(0);
  for (std::size_t c = 0; c < 3; ++c) {
    const float w = static_cast<float>(weights[static_cast<int>(c)]);
    color += w * t.corner[c].color;
    uv += w * t.corner[c].uv;
  }
  color *= surface.color;
  if (surface.texture >= 0) color *= sample(scene.textures[static_cast<std::size_t>(surface.texture)], uv);
  return color;
}

// kelp's own look (shaders/surface.glsl), without its highlight.
glm::vec3 light(const gl::View& view, const Surface& surface, const glm::vec3& color, const glm::vec3& normal,
                const glm::vec3& to_eye) {
  const float facing =
      std::max((glm::dot(normal, glm::normalize(view.light.sun_direction)) + 0.15f) / (1.15f * 1.15f), 0.0f);
  const glm::vec3 diffuse = color * (1 - surface.metallic),
                  specular = glm::mix(glm::vec3(0.04f), color, surface.metallic);
  const float mirror = glm::reflect(-to_eye, normal).y, blur = surface.roughness + 0.1f;
  const glm::vec3 reflected =
      glm::mix(view.light.ground_color, view.light.sky_color, glm::smoothstep(-blur, blur, mirror));
  return diffuse * (view.light.sun_color *
                    (facing / std::numbers::pi_v<float>)+glm::mix(
                        view.light.ground_color, view.light.sky_color, 0.5f + 0.5f * normal.y)) +
         specular * (1 - 0.5f * surface.roughness) * reflected + surface.glow;
}

std::uint8_t srgbByte(float linear) {
  const float c = std::clamp(linear, 0.0f, 1.0f);
  return static_cast<std::uint8_t>(
      std::lround(255.0f * (c <= 0.0031308f ? 12.92f * c : 1.055f * std::pow(c, 1 / 2.4f) - 0.055f)));
}

}  // namespace

Picture drawTriangles(const Scene& scene, const gl::View& view, int side, Rgb ground) {
  const int fine = side * kSamples;
  const glm::dmat4 to_clip = glm::dmat4(view.camera.eye_to_clip) * glm::dmat4(view.camera.world_to_eye);
  const glm::dvec3 eye(glm::inverse(glm::dmat4(view.camera.world_to_eye))[3]);
  std::vector<double> depth(static_cast<std::size_t>(fine) * static_cast<std::size_t>(fine),
                            std::numeric_limits<double>::infinity());
  std::vector<glm::vec3> color(depth.size());
  for (const Triangle& t : scene.triangles) {
    glm::dvec3 at[3];  // pixel, pixel, 1 / w
    bool behind = false;
    for (std::size_t c = 0; c < 3; ++c) {
      const glm::dvec4 p = to_clip * glm::dvec4(t.corner[c].position, 1);
      behind = behind || p.w <= 0;
      at[c] = {(0.5 + 0.5 * p.x / p.w) * fine - 0.5, (0.5 - 0.5 * p.y / p.w) * fine - 0.5, 1 / p.w};
    }
    const double area = (at[1].x - at[0].x) * (at[2].y - at[0].y) - (at[1].y - at[0].y) * (at[2].x - at[0].x);
    if (behind || area == 0 || !std::isfinite(area)) continue;
    glm::dvec3 normal =
        glm::cross(t.corner[1].position - t.corner[0].position, t.corner[2].position - t.corner[0].position);
    const double length = glm::length(normal);
    if (!(length > 0)) continue;
    normal *= (glm::dot(normal, eye - t.corner[0].position) < 0 ? -1 : 1) / length;  // what is seen is lit
    const auto [left, right] = std::minmax({at[0].x, at[1].x, at[2].x});
    const auto [top, bottom] = std::minmax({at[0].y, at[1].y, at[2].y});
    const Surface& surface = scene.surfaces[static_cast<std::size_t>(t.surface)];
    const glm::vec3 to_eye(glm::normalize(eye - t.corner[0].position));
    for (int y = std::max(0, static_cast<int>(std::ceil(top)));
         y <= std::min(fine - 1, static_cast<int>(std::floor(bottom))); ++y) {
      for (int x = std::max(0, static_cast<int>(std::ceil(left)));
           x <= std::min(fine - 1, static_cast<int>(std::floor(right))); ++x) {
        glm::dvec3 w;
        w[1] = ((x - at[0].x) * (at[2].y - at[0].y) - (y - at[0].y) * (at[2].x - at[0].x)) / area;
        w[2] = ((at[1].x - at[0].x) * (y - at[0].y) - (at[1].y - at[0].y) * (x - at[0].x)) / area;
        w[0] = 1 - w[1] - w[2];
        if (w[0] < -1e-9 || w[1] < -1e-9 || w[2] < -1e-9) continue;
        w *= glm::dvec3(at[0].z, at[1].z, at[2].z);
        const double nearness = w[0] + w[1] + w[2];
        const std::size_t pixel =
            static_cast<std::size_t>(x) + static_cast<std::size_t>(fine) * static_cast<std::size_t>(y);
        if (1 / nearness >= depth[pixel]) continue;
        const glm::vec4 base = baseColor(scene, t, w / nearness);
        if (base.a < surface.alpha_cutoff) continue;
        depth[pixel] = 1 / nearness;
        color[pixel] = light(view, surface, glm::vec3(base), glm::vec3(normal), to_eye);
      }
    }
  }

  Picture picture(side, side, ground);
  picture.covered.resize(picture.pixels.size());
  for (int y = 0; y < side; ++y) {
    for (int x = 0; x < side; ++x) {
      glm::vec3 sum(0);
      int hits = 0;
      for (int s = 0; s < kSamples * kSamples; ++s) {
        const std::size_t pixel =
            static_cast<std::size_t>(x * kSamples + s % kSamples) +
            static_cast<std::size_t>(fine) * static_cast<std::size_t>(y * kSamples + s / kSamples);
        if (!std::isfinite(depth[pixel])) continue;
        sum += color[pixel];
        ++hits;
      }
      if (hits == 0) continue;
      picture.covered[picture.index(x, y)] = hits * 2 >= kSamples * kSamples ? 1 : 0;
      const float share = static_cast<float>(hits) / (kSamples * kSamples);
      for (int c = 0; c < 3; ++c) {
        const float value = srgbByte(sum[c] / static_cast<float>(hits));
        picture.pixels[picture.index(x, y)][c] =
            static_cast<std::uint8_t>(value * share + static_cast<float>(ground[c]) * (1 - share));
      }
    }
  }
  return picture;
}

}  // namespace kelp::sheet
