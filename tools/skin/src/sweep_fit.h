// SPDX-License-Identifier: MIT
// The poses of a swept part that follow its samples best.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include <glm/glm.hpp>

#include "moments.h"
#include "sweep.h"

namespace kelp::bake {

// Linear least squares whose unknowns each meet only near ones: twelve neighbors at a time, four vectors.
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

// Fits the knots of one part to its samples, at any moment.
class SweepFit {
 public:
  SweepFit(const SkinSamples& samples, const SkinSweep& sweep, const std::vector<std::uint32_t>& members);

  struct Poses {
    std::vector<SkinPose> of_moments;
    std::size_t folding = 0;  // the first moment in whose pose the part folds; their number: none
    bool fold() const { return folding < of_moments.size(); }
  };
  // Least squares over places and tangents of all knots and a roll of the whole (README.md has the method).
  // All poses are as stiff as the one that folds most easily must be: what became stiffer on the way would
  // jump.
  Poses poses(const SkinMoments& moments, int threads) const;

  // The mean squared distance, weighted by area, of the samples that are fitted to; in skin space.
  double meanSquare(const SkinPose& pose, const SkinMoments& moments, std::size_t moment) const;

 private:
  struct Point {
    std::uint32_t sample = 0;
    double area = 0;
    glm::vec3 straight{0};
    std::size_t span = 0;  // between knots span and span + 1
    double t = 0;          // there
  };
  struct Curve;
  struct Reached;
  std::vector<glm::dvec3> drawn(const SkinMoments& moments, std::size_t moment) const;
  Curve begin(const std::vector<glm::dvec3>& drawn) const;
  std::optional<Reached> reach(Curve& curve, const std::vector<glm::dvec3>& drawn) const;
  Curve step(const Curve& curve, const Reached& reached, const std::vector<glm::dvec3>& drawn,
             double stiffness) const;
  // Fits `pose` to a moment. True if the part would fold in it, or nearly.
  bool pose(const SkinMoments& moments, std::size_t moment, double stiffness, SkinPose& pose) const;
  std::optional<Curve> improve(Curve curve, const std::vector<glm::dvec3>& drawn, double stiffness) const;
  std::vector<Knot> knotsOf(const Curve& curve) const;

  const SkinSamples& samples_;
  const SkinSweep& sweep_;
  std::vector<Point> points_;
  double area_ = 0;
};

}  // namespace kelp::bake
