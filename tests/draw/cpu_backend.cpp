// SPDX-License-Identifier: MIT
#include "cpu_backend.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "shader_stage.h"

namespace kelp::test {
namespace {

using draw::Program;

template <class Stage>
void setUniforms(Stage& stage, const draw::Uniforms& from, std::uint32_t first) {
  stage.kelp_first_instance = from.first_instance + static_cast<int>(first);
  stage.kelp_motion = from.motion != 0;
  stage.kelp_depth_only = from.depth_only != 0;
  stage.kelp_clip_low = from.clip_low;
  stage.kelp_scene = from.scene;
  stage.kelp_display = from.display != 0;
  stage.kelp_sun_direction = from.sun_direction;
  stage.kelp_sun_color = from.sun_color;
  stage.kelp_sky_color = from.sky_color;
  stage.kelp_ground_color = from.ground_color;
  stage.kelp_shading = from.shading;
  stage.kelp_self_shadow = from.self_shadow != 0;
  stage.kelp_occlusion_rays = from.occlusion_rays;
  stage.kelp_occlusion_reach = from.occlusion_reach;
  stage.kelp_sun_radius = from.sun_radius;
  stage.kelp_occlusion = from.occlusion != 0;
}

// The six corners of a proxy's strip, in clip space without z, and what is interpolated between them.
struct Strip {
  glm::vec3 corners[6], near[6];
  int texel = 0;
};
Strip stripOf(const shader::Proxy& prototype, std::uint32_t instance) {
  Strip strip;
  for (int i = 0; i < 6; ++i) {
    shader::Proxy proxy = prototype;
    proxy.gl_InstanceID = static_cast<int>(instance);
    proxy.gl_VertexID = i;
    proxy.main();
    const glm::vec4& at = proxy.gl_Position;
    EXPECT_FLOAT_EQ(at.z, 0.5f * at.w);  // between the planes in both clip ranges
    strip.corners[i] = {at.x, at.y, at.w};
    strip.near[i] = proxy.kelp_near;
    strip.texel = proxy.kelp_texel;
  }
  return strip;
}

// Calls cover(pixel, near) once for every pixel whose center the strip covers.
template <class Cover>
void rasterize(const Strip& strip, const glm::ivec2& size, Cover&& cover) {
  struct Triangle {
    glm::dmat3 to_shares;
    int first;
  };
  std::vector<Triangle> triangles;
  for (int i = 0; i < 4; ++i) {
    const glm::dmat3 corners(strip.corners[i], strip.corners[i + 1], strip.corners[i + 2]);
    if (glm::determinant(corners) != 0) triangles.push_back({glm::inverse(corners), i});
  }
  for (int y = 0; y < size.y; ++y) {
    for (int x = 0; x < size.x; ++x) {
      const glm::dvec3 at(2.0 * (glm::dvec2(x, y) + 0.5) / glm::dvec2(size) - 1.0, 1);
      for (const Triangle& triangle : triangles) {
        // Shares of the corners, over w.
        glm::dvec3 shares = triangle.to_shares * at;
        if (!(std::min({shares.x, shares.y, shares.z}) >= 0)) continue;
        shares /= shares.x + shares.y + shares.z;
        const glm::vec3* const near = strip.near + triangle.first;
        cover(glm::ivec2(x, y), glm::vec3(shares.x * glm::dvec3(near[0]) + shares.y * glm::dvec3(near[1]) +
                                          shares.z * glm::dvec3(near[2])));
        break;
      }
    }
  }
}

bool passes(float depth, float before, bool reversed) { return reversed ? depth >= before : depth <= before; }

// Calls use(Fragment stage) for the program of a call.
template <class Use>
void withProgram(Program program, Use&& use) {
  const bool swept = has(program, Program::kSwept), shadow = has(program, Program::kFogShadow);
  if (program == Program::kEitherBend) return use(shader::EitherBend());
  if (!has(program, Program::kFog)) return swept ? use(shader::Swept()) : use(shader::Sheared());
  if (shadow) return swept ? use(shader::SweptFogShadow()) : use(shader::ShearedFogShadow());
  if (has(program, Program::kFogHeat))
    return swept ? use(shader::SweptFogHeat()) : use(shader::ShearedFogHeat());
  return swept ? use(shader::SweptFog()) : use(shader::ShearedFog());
}

}  // namespace

Picture::Picture(const glm::ivec2& its_size, float far_depth) : size(its_size) {
  const std::size_t pixels = static_cast<std::size_t>(size.x) * static_cast<std::size_t>(size.y);
  colors.assign(pixels, glm::vec4(0));
  depths.assign(pixels, far_depth);
}

CpuBackend::CpuBackend(std::uint64_t pool_bytes, draw::Features features, std::uint32_t fill)
    : features_(features), pool_(static_cast<std::size_t>(pool_bytes / 4), fill) {}

void CpuBackend::copy(std::span<const draw::Copy> copies) {
  std::vector<std::pair<std::uint64_t, std::uint64_t>> ranges;
  for (const draw::Copy& copy : copies) {
    ASSERT_EQ(copy.offset % 4, 0u);
    ASSERT_FALSE(copy.words.empty());
    const std::uint64_t first = copy.offset / 4, end = first + copy.words.size();
    ASSERT_LE(end, pool_.size());
    ranges.emplace_back(first, end);
    std::copy(copy.words.begin(), copy.words.end(), pool_.begin() + static_cast<std::ptrdiff_t>(first));
  }
  std::sort(ranges.begin(), ranges.end());
  for (std::size_t i = 1; i < ranges.size(); ++i)
    ASSERT_LE(ranges[i - 1].second, ranges[i].first) << "copies overlap";
}

template <class Fragment, class Shade>
void CpuBackend::drawCall(const draw::DrawData& data, const draw::Call& call,
                          std::span<const float> scene_depth, const glm::ivec2& size, Shade&& shade) {
  const ShaderMemory memory{pool_, data.records, scene_depth, size};
  shader::Proxy proxy;
  Fragment fragment;
  proxy.kelp_pool.memory = fragment.kelp_pool.memory = &memory;
  proxy.kelp_records.memory = fragment.kelp_records.memory = &memory;
  fragment.kelp_scene_depth.memory = &memory;
  setUniforms(proxy, data.uniforms, call.first);
  setUniforms(fragment, data.uniforms, call.first);
  for (std::uint32_t i = 0; i < call.count; ++i) {
    const Strip strip = stripOf(proxy, i);
    rasterize(strip, size, [&](const glm::ivec2& pixel, const glm::vec3& near) {
      Fragment stage = fragment;  // an invocation
      stage.kelp_near = near;
      stage.kelp_texel = strip.texel;
      stage.gl_FragCoord = glm::vec4(glm::vec2(pixel) + 0.5f, 0, 1);
      shade(stage, pixel, static_cast<std::size_t>(pixel.y * size.x + pixel.x));
    });
  }
  reads_outside_ += memory.reads_outside;
}

void CpuBackend::draw(const draw::DrawData& data, draw::Pass pass, bool reversed_depth, Picture& picture,
                      std::span<const float> given) {
  std::vector<float> copied;
  for (const draw::Call& call : data.calls) {
    EXPECT_EQ(has(call.program, Program::kFog), pass == draw::Pass::kFog);
    EXPECT_EQ(call.program == Program::kEitherBend,
              pass != draw::Pass::kFog && has(features_, draw::Features::kDistances));
    if (call.copies_depth) copied = picture.depths;
    const std::span<const float> scene = given.empty() ? std::span<const float>(copied) : given;
    withProgram(call.program, [&]<class Fragment>(const Fragment&) {
      drawCall<Fragment>(
          data, call, scene, picture.size, [&](Fragment& stage, const glm::ivec2&, std::size_t i) {
            stage.main();
            if (stage.discarded) return;
            const float depth = std::clamp(stage.gl_FragDepth, 0.0f, 1.0f);
            if (!passes(depth, picture.depths[i], reversed_depth)) return;
            if (pass == draw::Pass::kFog) {  // premultiplied, over what is there
              picture.colors[i] = stage.kelp_color + (1 - stage.kelp_color.a) * picture.colors[i];
              return;
            }
            picture.depths[i] = depth;
            if (pass == draw::Pass::kColor) picture.colors[i] = stage.kelp_color;
          });
    });
  }
}

std::vector<Seen> CpuBackend::seen(const draw::DrawData& data, bool reversed_depth, const glm::ivec2& size) {
  Picture picture(size, reversed_depth ? 0.0f : 1.0f);
  std::vector<Seen> out(picture.depths.size());
  for (const draw::Call& call : data.calls) {
    withProgram(call.program, [&]<class Fragment>(Fragment) {
      if constexpr (requires(Fragment stage) { stage.kelpSurfaceAt({}, {}, {}); }) {
        drawCall<Fragment>(
            data, call, {}, size, [&](Fragment& stage, const glm::ivec2& pixel, std::size_t i) {
              stage.kelp_scene = 0;
              const auto ray = stage.kelpPixelRay(pixel);
              if (!ray.good) return;
              if (!stage.kelpLoadLevel(stage.kelpPixelLevel(pixel))) return;
              const auto hit = stage.kelpTrace(stage.kelp_near, ray.ray, ray.range.x, ray.range.y);
              const float depth = stage.kelpDepthOf(ray.clip_at + hit.s * ray.clip_slope);
              if (!hit.found || !passes(depth, picture.depths[i], reversed_depth)) return;
              picture.depths[i] = depth;
              stage.kelpLoadLevel(stage.kelp_level + hit.coarser);
              const auto surface = stage.kelpSurfaceAt(hit, stage.kelp_near + hit.s * ray.ray, ray.ray);
              out[i] = {surface.instance, surface.part, surface.level, surface.voxel, surface.normal};
            });
      }
    });
  }
  return out;
}

}  // namespace kelp::test
