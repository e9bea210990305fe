// SPDX-License-Identifier: MIT
#include "cpu_backend.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <type_traits>

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

// A vertex in clip space without z, and what is handed on.
struct Vertex {
  glm::vec3 at, near;
  int texel = 0;
  std::uint32_t face = 0;
};
template <class Proxy>
Vertex vertexOf(const Proxy& prototype, std::uint32_t instance, int number) {
  Proxy proxy = prototype;
  proxy.gl_InstanceID = static_cast<int>(instance);
  proxy.gl_VertexID = number;
  proxy.main();
  const glm::vec4& at = proxy.gl_Position;
  EXPECT_FLOAT_EQ(at.z, 0.5f * at.w);  // between the planes in both clip ranges
  Vertex vertex{{at.x, at.y, at.w}, proxy.kelp_near, proxy.kelp_texel};
  if constexpr (requires { proxy.kelp_face; }) vertex.face = proxy.kelp_face;
  return vertex;
}

// Calls cover(pixel, near) for every pixel whose center the triangle covers, and that is not `covered`.
template <class Cover>
void rasterize(const Vertex (&vertices)[3], const glm::ivec2& size, std::vector<bool>& covered,
               Cover&& cover) {
  const glm::dmat3 corners(vertices[0].at, vertices[1].at, vertices[2].at);
  if (glm::determinant(corners) == 0) return;
  const glm::dmat3 to_shares = glm::inverse(corners);
  for (int y = 0; y < size.y; ++y) {
    for (int x = 0; x < size.x; ++x) {
      const auto i = static_cast<std::size_t>(y * size.x + x);
      if (covered[i]) continue;
      // Shares of the corners, over w.
      glm::dvec3 shares = to_shares * glm::dvec3(2.0 * (glm::dvec2(x, y) + 0.5) / glm::dvec2(size) - 1.0, 1);
      if (!(std::min({shares.x, shares.y, shares.z}) >= 0)) continue;
      shares /= shares.x + shares.y + shares.z;
      covered[i] = true;
      cover(glm::ivec2(x, y),
            glm::vec3(shares.x * glm::dvec3(vertices[0].near) + shares.y * glm::dvec3(vertices[1].near) +
                      shares.z * glm::dvec3(vertices[2].near)));
    }
  }
}

bool passes(float depth, float before, bool reversed) { return reversed ? depth >= before : depth <= before; }

// Calls use(Fragment stage) for the program of a call.
template <class Use>
void withProgram(Program program, bool distances, Use&& use) {
  const bool swept = has(program, Program::kSwept), shadow = has(program, Program::kFogShadow);
  if (program == Program::kCaged) return use(shader::Caged());
  if (program == Program::kAnyBend) return distances ? use(shader::ByDistances()) : use(shader::AnyBend());
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
  constexpr bool kCaged = std::is_same_v<Fragment, shader::Caged>;
  std::conditional_t<kCaged, shader::CagedProxy, shader::Proxy> proxy;
  Fragment fragment;
  proxy.kelp_pool.memory = fragment.kelp_pool.memory = &memory;
  proxy.kelp_records.memory = fragment.kelp_records.memory = &memory;
  fragment.kelp_scene_depth.memory = &memory;
  setUniforms(proxy, data.uniforms, call.first);
  setUniforms(fragment, data.uniforms, call.first);
  const int vertices = static_cast<int>(call.vertices);
  for (std::uint32_t i = 0; i < call.count; ++i) {
    // Triangles of a strip cover no pixel twice.
    std::vector<bool> covered(static_cast<std::size_t>(size.x * size.y));
    for (int first = 0; first + 2 < vertices; first += kCaged ? 3 : 1) {
      Vertex triangle[3];
      for (int k = 0; k < 3; ++k) triangle[k] = vertexOf(proxy, i, first + k);
      if (kCaged) std::fill(covered.begin(), covered.end(), false);
      rasterize(triangle, size, covered, [&](const glm::ivec2& pixel, const glm::vec3& near) {
        Fragment stage = fragment;  // an invocation
        stage.kelp_near = near;
        stage.kelp_texel = triangle[2].texel;
        if constexpr (kCaged) stage.kelp_face = triangle[2].face;
        stage.gl_FragCoord = glm::vec4(glm::vec2(pixel) + 0.5f, 0, 1);
        shade(stage, pixel, static_cast<std::size_t>(pixel.y * size.x + pixel.x));
      });
    }
  }
  reads_outside_ += memory.reads_outside;
}

void CpuBackend::draw(const draw::DrawData& data, draw::Pass pass, bool reversed_depth, Picture& picture,
                      std::span<const float> given) {
  std::vector<float> copied;
  for (const draw::Call& call : data.calls) {
    EXPECT_EQ(has(call.program, Program::kFog), pass == draw::Pass::kFog);
    const bool distances = has(features_, draw::Features::kDistances);
    if (distances) {
      EXPECT_TRUE(call.program == Program::kAnyBend || pass == draw::Pass::kFog);
    }
    if (call.copies_depth) copied = picture.depths;
    const std::span<const float> scene = given.empty() ? std::span<const float>(copied) : given;
    withProgram(call.program, distances, [&]<class Fragment>(const Fragment&) {
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
    withProgram(call.program, has(features_, draw::Features::kDistances), [&]<class Fragment>(Fragment) {
      if constexpr (requires(Fragment stage) { stage.kelpSurfaceAt({}, {}, {}); }) {
        drawCall<Fragment>(
            data, call, {}, size, [&](Fragment& stage, const glm::ivec2& pixel, std::size_t i) {
              stage.kelp_scene = 0;
              const auto ray = stage.kelpPixelRay(pixel);
              if (!ray.good) return;
              const int level = stage.kelpPixelLevel(pixel);
              if (!stage.kelpLoadLevel(level)) return;
              auto hit = stage.kelpNoHit(0);
              if constexpr (std::is_same_v<Fragment, shader::Caged>)
                hit =
                    stage.kelpWalkCaged(stage.kelp_face, stage.kelp_near, ray.ray, ray.range.x, ray.range.y);
              else
                hit = stage.kelpTrace(stage.kelp_near, ray.ray, ray.range.x, ray.range.y);
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
