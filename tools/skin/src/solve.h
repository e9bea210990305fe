// SPDX-License-Identifier: MIT
// Linear least squares whose unknowns each meet only near ones.
#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include <glm/glm.hpp>

namespace kelp::bake {

// Twelve neighbouring unknowns at a time: four vectors.
class NormalEquations {
 public:
  explicit NormalEquations(std::size_t unknowns);
  // weight times the square of (the sum over k of effects[k] times vector k from `first` on) - wanted.
  void add(std::size_t first, const std::array<glm::dmat3, 4>& effects, const glm::dvec3& wanted,
           double weight);
  // weight times the square of the vector that begins at `first`.
  void damp(std::size_t first, double weight);
  // The unknowns that make the sum least (Cholesky). Zeros if it is not positive definite.
  std::vector<double> solve() const;

 private:
  static constexpr std::size_t kBand = 12;  // entry (i, j) is 0 unless i - j < kBand
  double& at(std::size_t i, std::size_t j) { return lower_[i * kBand + (i - j)]; }

  std::size_t unknowns_;
  std::vector<double> lower_;  // of the symmetric matrix: of each row, its diagonal and leftwards
  std::vector<double> right_;
};

}  // namespace kelp::bake
