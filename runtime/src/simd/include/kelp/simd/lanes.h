// SPDX-License-Identifier: MIT
// Four floats, or two doubles, in one value: for what the runtime computes for thousands of instances a
// frame. SSE2 where the processor has it, plain C++ elsewhere, with the same results to the last bit. min()
// and max() return their second argument if one argument is NaN.
#pragma once

#include <cmath>
#include <cstddef>
#include <cstring>

#if defined(__SSE2__) || defined(_M_X64)
#define KELP_LANES_SSE2 1
#include <emmintrin.h>
#endif

namespace kelp::simd {

// One number for each of eight items that are computed together, four at a time.
struct EightFloats {
  alignas(32) float of[8];
};

#if defined(KELP_LANES_SSE2)

struct Lanes {
  static constexpr int kCount = 4;
  __m128 v;
  Lanes() = default;
  Lanes(__m128 lanes) : v(lanes) {}
  Lanes(float all) : v(_mm_set1_ps(all)) {}
  static Lanes of(float a, float b, float c, float d) { return _mm_setr_ps(a, b, c, d); }
  static Lanes load(const float* four) { return _mm_loadu_ps(four); }
  void store(float* four) const { _mm_storeu_ps(four, v); }
  float first() const { return _mm_cvtss_f32(v); }
  template <int kLane>
  Lanes all() const {
    return _mm_shuffle_ps(v, v, _MM_SHUFFLE(kLane, kLane, kLane, kLane));
  }
  // Lane i of the result is lane i + 1 of this; the last lane is lane 0.
  Lanes rotated() const { return _mm_shuffle_ps(v, v, _MM_SHUFFLE(0, 3, 2, 1)); }
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
// Bit i of the result: a < b in lane i.
inline unsigned lessBits(Lanes a, Lanes b) {
  return static_cast<unsigned>(_mm_movemask_ps(_mm_cmplt_ps(a.v, b.v)));
}
// In each lane: a if which < than, else b.
inline Lanes selectLess(Lanes which, Lanes than, Lanes a, Lanes b) {
  const __m128 mask = _mm_cmplt_ps(which.v, than.v);
  return _mm_or_ps(_mm_and_ps(mask, a.v), _mm_andnot_ps(mask, b.v));
}
// A positive number is 2^exponent * fraction, with 1 <= fraction < 2.
inline Lanes exponentOf(Lanes a) {
  return _mm_cvtepi32_ps(_mm_sub_epi32(_mm_srli_epi32(_mm_castps_si128(a.v), 23), _mm_set1_epi32(127)));
}
inline Lanes fractionOf(Lanes a) {
  return _mm_or_ps(_mm_and_ps(a.v, _mm_castsi128_ps(_mm_set1_epi32(0x7fffff))), _mm_set1_ps(1.0f));
}
// Transposes the 4 x 4 matrix with the columns a, b, c, d.
inline void transpose(Lanes& a, Lanes& b, Lanes& c, Lanes& d) { _MM_TRANSPOSE4_PS(a.v, b.v, c.v, d.v); }

struct DoubleLanes {
  __m128d v;
  DoubleLanes(__m128d lanes) : v(lanes) {}
  DoubleLanes(double all) : v(_mm_set1_pd(all)) {}
  static DoubleLanes load(const double* two) { return _mm_loadu_pd(two); }
};
inline DoubleLanes operator+(DoubleLanes a, DoubleLanes b) { return _mm_add_pd(a.v, b.v); }
inline DoubleLanes operator-(DoubleLanes a, DoubleLanes b) { return _mm_sub_pd(a.v, b.v); }
inline DoubleLanes operator*(DoubleLanes a, DoubleLanes b) { return _mm_mul_pd(a.v, b.v); }
// Lanes 0 and 1; lanes 2 and 3.
inline DoubleLanes lowHalf(Lanes a) { return _mm_cvtps_pd(a.v); }
inline DoubleLanes highHalf(Lanes a) { return _mm_cvtps_pd(_mm_movehl_ps(a.v, a.v)); }
inline Lanes rounded(DoubleLanes low, DoubleLanes high) {
  return _mm_movelh_ps(_mm_cvtpd_ps(low.v), _mm_cvtpd_ps(high.v));
}

#else

struct Lanes {
  static constexpr int kCount = 4;
  float v[4];
  Lanes() = default;  // cppcheck-suppress uninitMemberVar ; no value before it gets one, as a float
  Lanes(float all) : v{all, all, all, all} {}
  static Lanes of(float a, float b, float c, float d) {
    const float four[4] = {a, b, c, d};
    return load(four);
  }
  static Lanes load(const float* four) {
    return each([four](int i) { return four[i]; });
  }
  void store(float* four) const { std::memcpy(four, v, sizeof v); }
  float first() const { return v[0]; }
  template <int kLane>
  Lanes all() const {
    return v[kLane];
  }
  Lanes rotated() const {
    return each([this](int i) { return v[(i + 1) % 4]; });
  }
  template <class Function>
  static Lanes each(Function f) {
    Lanes lanes;
    for (int i = 0; i < 4; ++i) lanes.v[i] = f(i);
    return lanes;
  }
};
inline Lanes operator+(Lanes a, Lanes b) {
  return Lanes::each([&](int i) { return a.v[i] + b.v[i]; });
}
inline Lanes operator-(Lanes a, Lanes b) {
  return Lanes::each([&](int i) { return a.v[i] - b.v[i]; });
}
inline Lanes operator*(Lanes a, Lanes b) {
  return Lanes::each([&](int i) { return a.v[i] * b.v[i]; });
}
inline Lanes operator/(Lanes a, Lanes b) {
  return Lanes::each([&](int i) { return a.v[i] / b.v[i]; });
}
inline Lanes min(Lanes a, Lanes b) {
  return Lanes::each([&](int i) { return a.v[i] < b.v[i] ? a.v[i] : b.v[i]; });
}
inline Lanes max(Lanes a, Lanes b) {
  return Lanes::each([&](int i) { return a.v[i] > b.v[i] ? a.v[i] : b.v[i]; });
}
inline Lanes sqrt(Lanes a) {
  return Lanes::each([&](int i) { return std::sqrt(a.v[i]); });
}
inline Lanes abs(Lanes a) {
  return Lanes::each([&](int i) { return std::abs(a.v[i]); });
}
inline Lanes copysign(Lanes a, Lanes sign) {
  return Lanes::each([&](int i) { return std::copysign(a.v[i], sign.v[i]); });
}
inline unsigned lessBits(Lanes a, Lanes b) {
  unsigned bits = 0;
  for (int i = 0; i < 4; ++i) bits |= (a.v[i] < b.v[i] ? 1u : 0u) << i;
  return bits;
}
inline Lanes selectLess(Lanes which, Lanes than, Lanes a, Lanes b) {
  return Lanes::each([&](int i) { return which.v[i] < than.v[i] ? a.v[i] : b.v[i]; });
}
inline Lanes exponentOf(Lanes a) {
  return Lanes::each([&](int i) { return static_cast<float>(std::ilogb(a.v[i])); });
}
inline Lanes fractionOf(Lanes a) {
  return Lanes::each([&](int i) { return std::scalbn(a.v[i], -std::ilogb(a.v[i])); });
}
inline void transpose(Lanes& a, Lanes& b, Lanes& c, Lanes& d) {
  const Lanes columns[4] = {a, b, c, d};
  Lanes* const rows[4] = {&a, &b, &c, &d};
  for (int row = 0; row < 4; ++row) {
    for (int column = 0; column < 4; ++column) rows[row]->v[column] = columns[column].v[row];
  }
}

struct DoubleLanes {
  double v[2];
  DoubleLanes(double low, double high) : v{low, high} {}
  DoubleLanes(double all) : v{all, all} {}
  static DoubleLanes load(const double* two) { return {two[0], two[1]}; }
};
inline DoubleLanes operator+(DoubleLanes a, DoubleLanes b) { return {a.v[0] + b.v[0], a.v[1] + b.v[1]}; }
inline DoubleLanes operator-(DoubleLanes a, DoubleLanes b) { return {a.v[0] - b.v[0], a.v[1] - b.v[1]}; }
inline DoubleLanes operator*(DoubleLanes a, DoubleLanes b) { return {a.v[0] * b.v[0], a.v[1] * b.v[1]}; }
inline DoubleLanes lowHalf(Lanes a) { return {a.v[0], a.v[1]}; }
inline DoubleLanes highHalf(Lanes a) { return {a.v[2], a.v[3]}; }
inline Lanes rounded(DoubleLanes low, DoubleLanes high) {
  return Lanes::of(static_cast<float>(low.v[0]), static_cast<float>(low.v[1]), static_cast<float>(high.v[0]),
                   static_cast<float>(high.v[1]));
}

#endif

// Loads four consecutive numbers from each of four places (place + offset). The first number of every place
// goes to a, the second to b, and so on.
inline void loadFours(const float* const* places, std::ptrdiff_t offset, Lanes& a, Lanes& b, Lanes& c,
                      Lanes& d) {
  a = Lanes::load(places[0] + offset), b = Lanes::load(places[1] + offset),
  c = Lanes::load(places[2] + offset), d = Lanes::load(places[3] + offset);
  transpose(a, b, c, d);
}
// The reverse of loadFours.
inline void storeFours(Lanes a, Lanes b, Lanes c, Lanes d, float* const* places, std::ptrdiff_t offset) {
  transpose(a, b, c, d);
  a.store(places[0] + offset), b.store(places[1] + offset), c.store(places[2] + offset),
      d.store(places[3] + offset);
}

}  // namespace kelp::simd
