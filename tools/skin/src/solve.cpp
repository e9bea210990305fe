// SPDX-License-Identifier: MIT
#include "solve.h"

#include <algorithm>
#include <cmath>

namespace kelp::bake {

NormalEquations::NormalEquations(std::size_t unknowns)
    : unknowns_(unknowns), lower_(unknowns * kBand, 0), right_(unknowns, 0) {}

void NormalEquations::add(std::size_t first, const std::array<glm::dmat3, 4>& effects,
                          const glm::dvec3& wanted, double weight) {
  for (std::size_t a = 0; a < 4; ++a) {
    const glm::dmat3 back = weight * glm::transpose(effects[a]);
    const glm::dvec3 right = back * wanted;
    for (int i = 0; i < 3; ++i) right_[first + 3 * a + static_cast<std::size_t>(i)] += right[i];
    for (std::size_t b = 0; b <= a; ++b) {
      const glm::dmat3 block = back * effects[b];
      for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j) {
          const std::size_t row = first + 3 * a + static_cast<std::size_t>(i),
                            column = first + 3 * b + static_cast<std::size_t>(j);
          if (column <= row) at(row, column) += block[j][i];
        }
    }
  }
}

void NormalEquations::damp(std::size_t first, double weight) {
  for (std::size_t i = first; i < first + 3; ++i) at(i, i) += weight;
}

std::vector<double> NormalEquations::solve() const {
  NormalEquations factor = *this;
  for (std::size_t i = 0; i < unknowns_; ++i) {
    const std::size_t low = i + 1 >= kBand ? i + 1 - kBand : 0;
    for (std::size_t j = low; j <= i; ++j) {
      double sum = factor.at(i, j);
      for (std::size_t k = std::max(low, j + 1 >= kBand ? j + 1 - kBand : 0); k < j; ++k)
        sum -= factor.at(i, k) * factor.at(j, k);
      if (i != j)
        factor.at(i, j) = sum / factor.at(j, j);
      else if (sum > 0)
        factor.at(i, i) = std::sqrt(sum);
      else
        return std::vector<double>(unknowns_, 0);
    }
  }
  std::vector<double> x = right_;
  for (std::size_t i = 0; i < unknowns_; ++i) {
    for (std::size_t k = i + 1 >= kBand ? i + 1 - kBand : 0; k < i; ++k) x[i] -= factor.at(i, k) * x[k];
    x[i] /= factor.at(i, i);
  }
  for (std::size_t i = unknowns_; i-- > 0;) {
    for (std::size_t k = i + 1; k < std::min(unknowns_, i + kBand); ++k) x[i] -= factor.at(k, i) * x[k];
    x[i] /= factor.at(i, i);
  }
  return x;
}

}  // namespace kelp::bake
