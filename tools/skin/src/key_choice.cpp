// SPDX-License-Identifier: MIT
#include "key_choice.h"

#include <algorithm>
#include <cmath>

namespace kelp::bake {

std::vector<std::size_t> chooseKeys(
    std::size_t count, double tolerance,
    const std::function<double(std::size_t, std::size_t, std::size_t)>& error) {
  const auto fits = [&](std::size_t from, std::size_t to, std::size_t a, std::size_t b) {
    for (std::size_t i = from; i <= to; ++i)
      if (error(i, a, b) > tolerance) return false;
    return true;
  };
  const std::size_t last = count - 1;
  if (fits(0, last, last / 2, last / 2)) return {last / 2};
  struct Span {
    std::size_t a, b, worst;
    double error;
  };
  const auto spanOf = [&](std::size_t a, std::size_t b) {
    Span span{a, b, a, 0};
    for (std::size_t i = a + 1; i < b; ++i)
      if (const double its = error(i, a, b); its > span.error) {
        span.error = its;
        span.worst = i;
      }
    return span;
  };
  std::vector<std::size_t> keys{0, last};
  std::vector<Span> open{spanOf(0, last)};
  while (!open.empty()) {
    const Span span = open.back();
    open.pop_back();
    if (span.error <= tolerance) continue;
    keys.push_back(span.worst);
    open.push_back(spanOf(span.a, span.worst));
    open.push_back(spanOf(span.worst, span.b));
  }
  std::sort(keys.begin(), keys.end());
  for (std::size_t k = 1; k + 1 < keys.size();) {
    if (fits(keys[k - 1] + 1, keys[k + 1] - 1, keys[k - 1], keys[k + 1]))
      keys.erase(keys.begin() + static_cast<std::ptrdiff_t>(k));
    else
      ++k;
  }
  return keys;
}

float roundedKey(double value, double step) {
  const double power = std::exp2(std::floor(std::log2(step)));
  return static_cast<float>(std::round(value / power) * power);
}

double shareOf(const std::vector<float>& times, std::size_t i, std::size_t a, std::size_t b) {
  if (a == b) return 0;
  return (static_cast<double>(times[i]) - static_cast<double>(times[a])) /
         (static_cast<double>(times[b]) - static_cast<double>(times[a]));
}

}  // namespace kelp::bake
