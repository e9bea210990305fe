// SPDX-License-Identifier: MIT
// Four floats at once, for the little that is computed for thousands of instances a frame: SSE2 where there is, plain C++ elsewhere.
// Both round alike. Minimum and maximum answer their second argument where one is not a number.
#pragma once

#include <cmath>
#include <cstring>

#if defined(__SSE2__) || defined(_M_X64)
#define KELP_LANES_SSE2 1
#include <emmintrin.h>
#endif

namespace kelp {

#if defined(KELP_LANES_SSE2)

struct Lanes {
  __m128 v;
  Lanes(__m128 lanes) : v(lanes) {}
  Lanes(float all) : v(_mm_set1_ps(all)) {}
  static Lanes of(float a, float b, float c, float d) { return _mm_setr_ps(a, b, c, d); }
  static Lanes load(const float* four) { return _mm_loadu_ps(four); }
  void store(float* four) const { _mm_storeu_ps(four, v); }
  template <int kLane>
  Lanes all() const { return _mm_shuffle_ps(v, v, _MM_SHUFFLE(kLane, kLane, kLane, kLane)); }
  Lanes rotated() const { return _mm_shuffle_ps(v, v, _MM_SHUFFLE(0, 3, 2, 1)); }  // lane i is lane i + 1 of this
};
inline Lanes operator+(Lanes a, Lanes b) { return _mm_add_ps(a.v, b.v); }
inline Lanes operator-(Lanes a, Lanes b) { return _mm_sub_ps(a.v, b.v); }
inline Lanes operator*(Lanes a, Lanes b) { return _mm_mul_ps(a.v, b.v); }
inline Lanes operator/(Lanes a, Lanes b) { return _mm_div_ps(a.v, b.v); }
inline Lanes min(Lanes a, Lanes b) { return _mm_min_ps(a.v, b.v); }
inline Lanes max(Lanes a, Lanes b) { return _mm_max_ps(a.v, b.v); }
inline Lanes sqrt(Lanes a) { return _mm_sqrt_ps(a.v); }
inline Lanes abs(Lanes a) { return _mm_andnot_ps(_mm_set1_ps(-0.0f), a.v); }
inline Lanes copysign(Lanes a, Lanes sign) {
  const __m128 bit = _mm_set1_ps(-0.0f);
  return _mm_or_ps(_mm_andnot_ps(bit, a.v), _mm_and_ps(bit, sign.v));
}
// Whether a >= b in each of the first three lanes.
inline bool notLess3(Lanes a, Lanes b) { return (_mm_movemask_ps(_mm_cmpge_ps(a.v, b.v)) & 7) == 7; }

#else

struct Lanes {
  float v[4];
  Lanes() = default;
  Lanes(float all) : v{all, all, all, all} {}
  static Lanes of(float a, float b, float c, float d) {
    const float four[4] = {a, b, c, d};
    return load(four);
  }
  static Lanes load(const float* four) { return each([four](int i) { return four[i]; }); }
  void store(float* four) const { std::memcpy(four, v, sizeof v); }
  template <int kLane>
  Lanes all() const { return v[kLane]; }
  Lanes rotated() const { return each([this](int i) { return v[(i + 1) % 4]; }); }
  template <class Function>
  static Lanes each(Function f) {
    Lanes lanes;
    for (int i = 0; i < 4; ++i) lanes.v[i] = f(i);
    return lanes;
  }
};
inline Lanes operator+(Lanes a, Lanes b) { return Lanes::each([&](int i) { return a.v[i] + b.v[i]; }); }
inline Lanes operator-(Lanes a, Lanes b) { return Lanes::each([&](int i) { return a.v[i] - b.v[i]; }); }
inline Lanes operator*(Lanes a, Lanes b) { return Lanes::each([&](int i) { return a.v[i] * b.v[i]; }); }
inline Lanes operator/(Lanes a, Lanes b) { return Lanes::each([&](int i) { return a.v[i] / b.v[i]; }); }
inline Lanes min(Lanes a, Lanes b) { return Lanes::each([&](int i) { return a.v[i] < b.v[i] ? a.v[i] : b.v[i]; }); }
inline Lanes max(Lanes a, Lanes b) { return Lanes::each([&](int i) { return a.v[i] > b.v[i] ? a.v[i] : b.v[i]; }); }
inline Lanes sqrt(Lanes a) { return Lanes::each([&](int i) { return std::sqrt(a.v[i]); }); }
inline Lanes abs(Lanes a) { return Lanes::each([&](int i) { return std::abs(a.v[i]); }); }
inline Lanes copysign(Lanes a, Lanes sign) { return Lanes::each([&](int i) { return std::copysign(a.v[i], sign.v[i]); }); }
inline bool notLess3(Lanes a, Lanes b) { return a.v[0] >= b.v[0] && a.v[1] >= b.v[1] && a.v[2] >= b.v[2]; }

#endif

}  // namespace kelp
