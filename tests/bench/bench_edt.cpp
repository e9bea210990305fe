// SPDX-License-Identifier: MIT
// Throughput of the exact distance transform against the scalar separable one of
// tests/fields/reference_fields.h, interleaved in one run.
//   bench_edt [threads] [rounds]
#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <vector>

#include "kelp/fields/fields.h"
#include "reference_fields.h"
#include "volumes.h"

namespace {

using kelp::fields::Occupancy;

double seconds(const auto& work) {
  const auto start = std::chrono::steady_clock::now();
  work();
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

double median(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  return values[values.size() / 2];
}

void compare(const char* name, const Occupancy& volume, int threads, int rounds) {
  std::vector<std::uint32_t> squared(volume.solid.size()), expected;
  std::vector<double> ours, naive;
  for (int round = 0; round < rounds; ++round) {
    ours.push_back(
        seconds([&] { kelp::fields::squaredDistance(volume.solid, volume.size, squared, threads); }));
    // The yardstick is slow and steady: once is enough.
    if (round == 0)
      naive.push_back(seconds([&] { expected = kelp::test::naiveSeparable(volume.solid, volume.size); }));
  }
  const double clearance = seconds([&] { (void)kelp::fields::squaredClearance(volume, threads); });
  const double millions = static_cast<double>(squared.size()) * 1e-6;
  std::printf(
      "%-20s %4d^3 %9.1f ms %9.0f Mvoxel/s   naive %9.1f ms   ratio %6.1f   clearance %7.1f ms   %s\n", name,
      volume.size.x, median(ours) * 1e3, millions / median(ours), median(naive) * 1e3,
      median(naive) / median(ours), clearance * 1e3, squared == expected ? "equal" : "DIFFERENT");
}

}  // namespace

int main(int argc, char** argv) {
  const int threads = argc > 1 ? std::atoi(argv[1]) : 0;
  const int rounds = std::max(1, argc > 2 ? std::atoi(argv[2]) : 5);
  std::printf("threads: %d (0: all), median of %d rounds\n", threads, rounds);
  for (const int side : {256, 384}) {
    const glm::ivec3 size(side);
    const auto squaredFromCenter = [&](const glm::ivec3& v) {
      const glm::ivec3 d = 2 * v - size + 1;
      return d.x * d.x + d.y * d.y + d.z * d.z;
    };
    compare("noise, half full", kelp::test::randomVolume(size, 0.5, 1), threads, rounds);
    compare("noise, 1 in 10000", kelp::test::randomVolume(size, 0.0001, 2), threads, rounds);
    compare("solid sphere",
            kelp::test::volumeWhere(size,
                                    [&](const glm::ivec3& v) { return squaredFromCenter(v) < side * side; }),
            threads, rounds);
    // The medial axis in the middle, and every pencil full of parabolas that later ones hide.
    compare("inside of a sphere",
            kelp::test::volumeWhere(size,
                                    [&](const glm::ivec3& v) { return squaredFromCenter(v) > side * side; }),
            threads, rounds);
    compare("one voxel", kelp::test::volumeWhere(size, [&](const glm::ivec3& v) { return v == size / 3; }),
            threads, rounds);
  }
}
