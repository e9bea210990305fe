// SPDX-License-Identifier: MIT
// The shaders as C++ (glsl_to_cpp.py), and what GLSL brings along: samplers, swizzles, gl_ variables.
#pragma once

#include <algorithm>
#include <cstdint>
#include <span>

#include <glm/glm.hpp>

namespace kelp::test {

// What stages read. Reads outside are counted, and answered with 0.
struct ShaderMemory {
  std::span<const std::uint32_t> pool;
  std::span<const glm::uvec4> records;
  std::span<const float> scene_depth;
  glm::ivec2 size{0};  // of the picture
  mutable std::uint64_t reads_outside = 0;

  template <class T>
  T at(std::span<const T> of, std::int64_t x, std::int64_t width, std::int64_t row) const {
    if (x < 0 || x >= width || row < 0 || static_cast<std::uint64_t>(row * width + x) >= of.size()) {
      ++reads_outside;
      return T(0);
    }
    return of[static_cast<std::size_t>(row * width + x)];
  }
};

namespace shader {

using namespace glm;

template <int... kAxes>
struct Swizzle {};
template <int kLength, class T, qualifier kQ, int... kAxes>
const vec<sizeof...(kAxes), T, kQ> operator->*(const vec<kLength, T, kQ>& v, Swizzle<kAxes...>) {
  return {v[kAxes]...};
}
template <class To, int... kAxes, class From>
void kelpAssign(To& to, Swizzle<kAxes...>, const From& from) {
  int i = 0;
  ((to[kAxes] = from[i++]), ...);
}
namespace swizzle {
inline constexpr Swizzle<0, 1> xy, rg;
inline constexpr Swizzle<0, 2> xz;
inline constexpr Swizzle<1, 3> yw;
inline constexpr Swizzle<2, 3> zw;
inline constexpr Swizzle<0, 1, 2> xyz, rgb;
inline constexpr Swizzle<1, 2, 3> yzw;
}  // namespace swizzle

struct Sampler {
  const ShaderMemory* memory = nullptr;
};
struct usampler2DArray : Sampler {};
struct usampler2D : Sampler {};
struct sampler2D : Sampler {};

inline uvec4 texelFetch(const usampler2DArray& of, const ivec3& at, int) {
  // 1024 rows to a layer.
  const std::int64_t row = at.y < 0 || at.y > 1023 ? -1 : std::int64_t{at.z} * 1024 + at.y;
  return uvec4(of.memory->at(of.memory->pool, at.x, 1024, row), 0, 0, 1);
}
inline uvec4 texelFetch(const usampler2D& of, const ivec2& at, int) {
  return of.memory->at(of.memory->records, at.x, 1024, at.y);
}
inline vec4 texelFetch(const sampler2D& of, const ivec2& at, int) {
  return vec4(of.memory->at(of.memory->scene_depth, at.x, of.memory->size.x, at.y), 0, 0, 1);
}

// What every stage has.
struct ShaderStage {
  int gl_InstanceID = 0, gl_VertexID = 0;
  vec4 gl_Position{0}, gl_FragCoord{0};
  float gl_FragDepth = 0;
  struct {
    float near = 0, far = 1, diff = 1;
  } gl_DepthRange;
  bool discarded = false;
};
#define discard       \
  do {                \
    discarded = true; \
    return;           \
  } while (false)
#define uniform
#define highp
#define flat
#define in
#define out
#define layout(...)

struct Proxy : ShaderStage {
// clang-format off
#include "draw.vert"
#include "undef.inl"
  // clang-format on
};

#define KELP_CAGED_ONLY
struct CagedProxy : ShaderStage {
// clang-format off
#include "draw.vert"
#include "undef.inl"
  // clang-format on
};

#define KELP_SHEARED_ONLY
#define KELP_SECONDARY_RAYS
struct Sheared : ShaderStage {
// clang-format off
#include "draw.frag"
#include "undef.inl"
  // clang-format on
};
#define KELP_SWEPT_ONLY
#define KELP_SECONDARY_RAYS
struct Swept : ShaderStage {
// clang-format off
#include "draw.frag"
#include "undef.inl"
  // clang-format on
};
#define KELP_CAGED_ONLY
#define KELP_SECONDARY_RAYS
struct Caged : ShaderStage {
// clang-format off
#include "draw.frag"
#include "undef.inl"
  // clang-format on
};
#define KELP_SECONDARY_RAYS
struct AnyBend : ShaderStage {
// clang-format off
#include "draw.frag"
#include "undef.inl"
  // clang-format on
};
#define KELP_DISTANCES
#define KELP_SECONDARY_RAYS
struct ByDistances : ShaderStage {
// clang-format off
#include "draw.frag"
#include "undef.inl"
  // clang-format on
};

#define KELP_SHEARED_ONLY
struct ShearedFog : ShaderStage {
// clang-format off
#include "fog.frag"
#include "undef.inl"
  // clang-format on
};
#define KELP_SHEARED_ONLY
#define KELP_FOG_HEAT
struct ShearedFogHeat : ShaderStage {
// clang-format off
#include "fog.frag"
#include "undef.inl"
  // clang-format on
};
#define KELP_SHEARED_ONLY
#define KELP_FOG_HEAT
#define KELP_FOG_SHADOW
struct ShearedFogShadow : ShaderStage {
// clang-format off
#include "fog.frag"
#include "undef.inl"
  // clang-format on
};
#define KELP_SWEPT_ONLY
struct SweptFog : ShaderStage {
// clang-format off
#include "fog.frag"
#include "undef.inl"
  // clang-format on
};
#define KELP_SWEPT_ONLY
#define KELP_FOG_HEAT
struct SweptFogHeat : ShaderStage {
// clang-format off
#include "fog.frag"
#include "undef.inl"
  // clang-format on
};
#define KELP_SWEPT_ONLY
#define KELP_FOG_HEAT
#define KELP_FOG_SHADOW
struct SweptFogShadow : ShaderStage {
// clang-format off
#include "fog.frag"
#include "undef.inl"
  // clang-format on
};

#undef discard
#undef uniform
#undef highp
#undef flat
#undef in
#undef out
#undef layout

}  // namespace shader
}  // namespace kelp::test
