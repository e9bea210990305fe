// SPDX-License-Identifier: MIT
// Eight floats, or four doubles, at once, on processors with AVX2: what kelp uses of lanes.h by the same names, and every lane comes to the same bits, since
// AVX2 rounds as SSE2 does and nothing is contracted. A program for any x86-64 asks hasEightLanes() when it runs. What computes with them is written
// once, for `Floats`, in a file *.inl, which a .cpp includes for Lanes in a namespace `four`, and between KELP_EIGHT_LANES_BEGIN and _END for Lanes8 in
// a namespace `eight`. In such a file a lambda would not be a function for AVX2 everywhere; plain functions are.
// For kelp's libraries; hosts need none of it.
#pragma once

#include "kelp/formats/lanes.h"

// Not on Windows: GCC does not align the stack to 32 bytes there (GCC bug 54412).
#if defined(KELP_LANES_SSE2) && defined(__x86_64__) && defined(__GNUC__) && !defined(_WIN32) && !defined(__CYGWIN__)
#define KELP_EIGHT_LANES 1
#include <immintrin.h>

// Functions between these two may use AVX2, and are to be called only where hasEightLanes().
#if defined(__clang__)
#define KELP_EIGHT_LANES_BEGIN _Pragma("clang attribute push(__attribute__((target(\"avx2\"))), apply_to = function)")
#define KELP_EIGHT_LANES_END _Pragma("clang attribute pop")
#else
#define KELP_EIGHT_LANES_BEGIN _Pragma("GCC push_options") _Pragma("GCC target(\"avx2\")")
#define KELP_EIGHT_LANES_END _Pragma("GCC pop_options")
#endif

namespace kelp {

inline bool hasEightLanes() { return __builtin_cpu_supports("avx2"); }

KELP_EIGHT_LANES_BEGIN

struct Lanes8 {
  static constexpr int kCount = 8;
  __m256 v;
  Lanes8() {}
  // GCC copies what it takes for 32 bytes of memory in two halves, and a load of the whole then waits for both. Nor does it take the functions that it adds to
  // a struct of Lanes8 for functions with AVX2: such a struct is not copied, or says how.
  [[gnu::always_inline]] Lanes8(const Lanes8& other) : v(other.v) {}
  [[gnu::always_inline]] Lanes8& operator=(const Lanes8& other) {
    v = other.v;
    return *this;
  }
  Lanes8(__m256 lanes) : v(lanes) {}
  Lanes8(float all) : v(_mm256_set1_ps(all)) {}
  static Lanes8 load(const float* eight) { return _mm256_loadu_ps(eight); }
  static Lanes8 of(Lanes low, Lanes high) { return _mm256_insertf128_ps(_mm256_castps128_ps256(low.v), high.v, 1); }
  void store(float* eight) const { _mm256_storeu_ps(eight, v); }
  Lanes low() const { return _mm256_castps256_ps128(v); }
  Lanes high() const { return _mm256_extractf128_ps(v, 1); }
  // In each half.
  template <int kLane>
  Lanes8 all() const { return _mm256_permute_ps(v, _MM_SHUFFLE(kLane, kLane, kLane, kLane)); }
};
inline Lanes8 operator+(Lanes8 a, Lanes8 b) { return _mm256_add_ps(a.v, b.v); }
inline Lanes8 operator-(Lanes8 a, Lanes8 b) { return _mm256_sub_ps(a.v, b.v); }
inline Lanes8 operator*(Lanes8 a, Lanes8 b) { return _mm256_mul_ps(a.v, b.v); }
inline Lanes8 operator/(Lanes8 a, Lanes8 b) { return _mm256_div_ps(a.v, b.v); }
inline Lanes8 min(Lanes8 a, Lanes8 b) { return _mm256_min_ps(a.v, b.v); }
inline Lanes8 max(Lanes8 a, Lanes8 b) { return _mm256_max_ps(a.v, b.v); }
inline Lanes8 sqrt(Lanes8 a) { return _mm256_sqrt_ps(a.v); }
inline Lanes8 abs(Lanes8 a) { return _mm256_andnot_ps(_mm256_set1_ps(-0.0f), a.v); }
inline Lanes8 copysign(Lanes8 a, Lanes8 sign) {
  const __m256 bit = _mm256_set1_ps(-0.0f);
  return _mm256_or_ps(_mm256_andnot_ps(bit, a.v), _mm256_and_ps(bit, sign.v));
}
inline unsigned lessBits(Lanes8 a, Lanes8 b) { return static_cast<unsigned>(_mm256_movemask_ps(_mm256_cmp_ps(a.v, b.v, _CMP_LT_OS))); }
inline Lanes8 selectLess(Lanes8 which, Lanes8 than, Lanes8 a, Lanes8 b) {
  const __m256 mask = _mm256_cmp_ps(which.v, than.v, _CMP_LT_OS);
  return _mm256_or_ps(_mm256_and_ps(mask, a.v), _mm256_andnot_ps(mask, b.v));
}
inline Lanes8 exponentOf(Lanes8 a) {
  return _mm256_cvtepi32_ps(_mm256_sub_epi32(_mm256_srli_epi32(_mm256_castps_si256(a.v), 23), _mm256_set1_epi32(127)));
}
inline Lanes8 fractionOf(Lanes8 a) {
  return _mm256_or_ps(_mm256_and_ps(a.v, _mm256_castsi256_ps(_mm256_set1_epi32(0x7fffff))), _mm256_set1_ps(1.0f));
}
// In each half.
inline void transpose(Lanes8& a, Lanes8& b, Lanes8& c, Lanes8& d) {
  const __m256 ab = _mm256_unpacklo_ps(a.v, b.v), cd = _mm256_unpacklo_ps(c.v, d.v);
  const __m256 ab_high = _mm256_unpackhi_ps(a.v, b.v), cd_high = _mm256_unpackhi_ps(c.v, d.v);
  a = _mm256_shuffle_ps(ab, cd, _MM_SHUFFLE(1, 0, 1, 0));
  b = _mm256_shuffle_ps(ab, cd, _MM_SHUFFLE(3, 2, 3, 2));
  c = _mm256_shuffle_ps(ab_high, cd_high, _MM_SHUFFLE(1, 0, 1, 0));
  d = _mm256_shuffle_ps(ab_high, cd_high, _MM_SHUFFLE(3, 2, 3, 2));
}

struct DoubleLanes4 {
  __m256d v;
  DoubleLanes4(__m256d lanes) : v(lanes) {}
  DoubleLanes4(double all) : v(_mm256_set1_pd(all)) {}
  static DoubleLanes4 load(const double* four) { return _mm256_loadu_pd(four); }
};
inline DoubleLanes4 operator+(DoubleLanes4 a, DoubleLanes4 b) { return _mm256_add_pd(a.v, b.v); }
inline DoubleLanes4 operator-(DoubleLanes4 a, DoubleLanes4 b) { return _mm256_sub_pd(a.v, b.v); }
inline DoubleLanes4 operator*(DoubleLanes4 a, DoubleLanes4 b) { return _mm256_mul_pd(a.v, b.v); }
inline DoubleLanes4 lowHalf(Lanes8 a) { return _mm256_cvtps_pd(_mm256_castps256_ps128(a.v)); }
inline DoubleLanes4 highHalf(Lanes8 a) { return _mm256_cvtps_pd(_mm256_extractf128_ps(a.v, 1)); }
inline Lanes rounded(DoubleLanes4 four) { return _mm256_cvtpd_ps(four.v); }
inline Lanes8 rounded(DoubleLanes4 low, DoubleLanes4 high) { return Lanes8::of(rounded(low), rounded(high)); }

inline void loadFours(const float* const* places, std::ptrdiff_t offset, Lanes8& a, Lanes8& b, Lanes8& c, Lanes8& d) {
  a = Lanes8::of(Lanes::load(places[0] + offset), Lanes::load(places[4] + offset));
  b = Lanes8::of(Lanes::load(places[1] + offset), Lanes::load(places[5] + offset));
  c = Lanes8::of(Lanes::load(places[2] + offset), Lanes::load(places[6] + offset));
  d = Lanes8::of(Lanes::load(places[3] + offset), Lanes::load(places[7] + offset));
  transpose(a, b, c, d);
}
inline void storeFours(Lanes8 a, Lanes8 b, Lanes8 c, Lanes8 d, float* const* places, std::ptrdiff_t offset) {
  transpose(a, b, c, d);
  a.low().store(places[0] + offset), b.low().store(places[1] + offset), c.low().store(places[2] + offset), d.low().store(places[3] + offset);
  a.high().store(places[4] + offset), b.high().store(places[5] + offset), c.high().store(places[6] + offset), d.high().store(places[7] + offset);
}

KELP_EIGHT_LANES_END

}  // namespace kelp
#endif
