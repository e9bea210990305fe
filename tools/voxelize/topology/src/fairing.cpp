// SPDX-License-Identifier: MIT
#include "fairing.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>

namespace kelp::bake {
namespace {

constexpr std::uint32_t kFixed = 0xffffffffu;

// A symmetric positive definite matrix of which each row is kept from its first entry to the diagonal.
class EnvelopeMatrix {
 public:
  explicit EnvelopeMatrix(const std::vector<std::uint32_t>& first) : first_(first), begin_(first.size()) {
    std::size_t size = 0;
    for (std::size_t i = 0; i < first.size(); ++i) {
      begin_[i] = size;
      size += i - first[i] + 1;
    }
    values_.assign(size, 0.0);
  }
  double& at(std::size_t row, std::size_t column) { return values_[begin_[row] + column - first_[row]]; }

  // Cholesky's decomposition in place.
  void decompose() {
    for (std::size_t i = 0; i < first_.size(); ++i) {
      for (std::size_t k = first_[i]; k <= i; ++k) {
        const std::size_t from = std::max(first_[i], first_[k]);
        const double* a = values_.data() + begin_[i] + (from - first_[i]);
        const double* b = values_.data() + begin_[k] + (from - first_[k]);
        double sum = at(i, k);
        for (std::size_t c = from; c < k; ++c) sum -= *a++ * *b++;
        at(i, k) = k < i ? sum / at(k, k) : std::sqrt(std::max(sum, 1e-30));
      }
    }
  }
  void solve(std::vector<glm::dvec3>& x) const {
    for (std::size_t i = 0; i < x.size(); ++i) {
      const double* row = values_.data() + begin_[i];
      for (std::size_t c = first_[i]; c < i; ++c) x[i] -= *row++ * x[c];
      x[i] /= *row;
    }
    for (std::size_t i = x.size(); i-- > 0;) {
      const double* row = values_.data() + begin_[i];
      x[i] /= row[i - first_[i]];
      for (std::size_t c = first_[i]; c < i; ++c) x[c] -= *row++ * x[i];
    }
  }

 private:
  const std::vector<std::uint32_t>& first_;
  std::vector<std::size_t> begin_;
  std::vector<double> values_;
};

class Plate {
 public:
  Plate(Patch& patch, std::span<const glm::dvec3> beyond)
      : patch_(patch), points_(patch.points), triangles_(patch.triangles) {
    const std::uint32_t rim = patch.rim, first = static_cast<std::uint32_t>(points_.size());
    points_.insert(points_.end(), beyond.begin(), beyond.end());
    for (std::uint32_t i = 0; i < rim; ++i) {
      const std::uint32_t next = (i + 1) % rim;
      triangles_.push_back({next, i, first + i});
      triangles_.push_back({next, first + i, first + next});
    }
    number();
  }

  void settle() {
    weigh();
    std::vector<glm::dvec3> x(order_.size(), glm::dvec3(0));
    EnvelopeMatrix matrix(envelope_);
    // One row of the Laplacian a point that is not beyond the rim.
    std::vector<std::pair<std::uint32_t, double>> row;
    for (std::uint32_t v = 0; v < patch_.points.size(); ++v) {
      row.assign(1, {v, 0.0});
      for (std::uint32_t i = starts_[v]; i < starts_[v + 1]; ++i) {
        row.emplace_back(around_[i], weights_[i]);
        row[0].second -= weights_[i];
      }
      for (const auto& [p, a] : row) {
        const std::uint32_t i = number_[p];
        if (i == kFixed) continue;
        for (const auto& [q, b] : row) {
          const std::uint32_t k = number_[q];
          const double product = a * b / areas_[v];
          if (k == kFixed) {
            x[i] -= product * points_[q];
          } else if (k <= i) {
            matrix.at(i, k) += product;
          }
        }
      }
    }
    matrix.decompose();
    matrix.solve(x);
    for (std::size_t i = 0; i < order_.size(); ++i) patch_.points[order_[i]] = points_[order_[i]] = x[i];
  }

 private:
  // Neighbours, and numbers for the points within such that neighbours' neighbours have near ones.
  void number() {
    const std::size_t count = patch_.points.size();
    std::vector<std::pair<std::uint32_t, std::uint32_t>> pairs;
    for (const auto& t : triangles_) {
      for (std::size_t k = 0; k < 3; ++k) {
        pairs.emplace_back(t[k], t[(k + 1) % 3]);
        pairs.emplace_back(t[(k + 1) % 3], t[k]);
      }
    }
    std::sort(pairs.begin(), pairs.end());
    pairs.erase(std::unique(pairs.begin(), pairs.end()), pairs.end());
    starts_.assign(points_.size() + 1, 0);
    for (const auto& [from, to] : pairs) {
      ++starts_[from + 1];
      around_.push_back(to);
    }
    for (std::size_t i = 0; i < points_.size(); ++i) starts_[i + 1] += starts_[i];

    number_.assign(points_.size(), kFixed);
    std::vector<bool> seen(points_.size(), false);
    std::vector<std::uint32_t> front;
    for (std::uint32_t seed = 0; seed < count; ++seed) {
      if (seen[seed]) continue;
      seen[seed] = true;
      front.assign(1, seed);
      for (std::size_t at = 0; at < front.size(); ++at) {
        const std::uint32_t v = front[at];
        if (v >= patch_.rim) {
          number_[v] = static_cast<std::uint32_t>(order_.size());
          order_.push_back(v);
        }
        for (std::uint32_t i = starts_[v]; i < starts_[v + 1]; ++i) {
          const std::uint32_t to = around_[i];
          // Along the rim the search would come in from all sides at once.
          if (to >= count || seen[to] || (v < patch_.rim && to < patch_.rim)) continue;
          seen[to] = true;
          front.push_back(to);
        }
      }
    }
    envelope_.resize(order_.size());
    for (std::uint32_t i = 0; i < order_.size(); ++i) envelope_[i] = i;
    for (std::uint32_t v = 0; v < count; ++v) {
      std::uint32_t least = number_[v];
      for (std::uint32_t i = starts_[v]; i < starts_[v + 1]; ++i)
        least = std::min(least, number_[around_[i]]);
      if (number_[v] != kFixed) envelope_[number_[v]] = std::min(envelope_[number_[v]], least);
      for (std::uint32_t i = starts_[v]; i < starts_[v + 1]; ++i) {
        const std::uint32_t n = number_[around_[i]];
        if (n != kFixed) envelope_[n] = std::min(envelope_[n], least);
      }
    }
  }

  // Cotangents and areas of the shape as it is.
  void weigh() {
    weights_.assign(around_.size(), 0.0);
    areas_.assign(points_.size(), 1e-9);
    for (const auto& t : triangles_) {
      for (std::size_t k = 0; k < 3; ++k) {
        const std::uint32_t a = t[k], b = t[(k + 1) % 3], c = t[(k + 2) % 3];
        const glm::dvec3 u = points_[a] - points_[c], v = points_[b] - points_[c];
        const double twice = glm::length(glm::cross(u, v));
        // Needles must not outweigh all else.
        const double weight = std::clamp(glm::dot(u, v) / (twice + 1e-12), -kSteepest, kSteepest) * 0.5;
        weights_[place(a, b)] += weight;
        weights_[place(b, a)] += weight;
        areas_[c] += twice / 6;
      }
    }
  }
  std::uint32_t place(std::uint32_t from, std::uint32_t to) const {
    const auto begin = around_.begin();
    return static_cast<std::uint32_t>(std::lower_bound(begin + starts_[from], begin + starts_[from + 1], to) -
                                      begin);
  }
  static constexpr double kSteepest = 10;

  Patch& patch_;
  std::vector<glm::dvec3> points_;  // the patch's, then those beyond
  std::vector<std::array<std::uint32_t, 3>> triangles_;
  std::vector<std::uint32_t> starts_, around_;  // neighbours of each point, ascending
  std::vector<double> weights_, areas_;
  std::vector<std::uint32_t> number_, order_, envelope_;
};

}  // namespace

void fairPatch(Patch& patch, std::span<const glm::dvec3> beyond) {
  constexpr int kRounds = 3;
  Plate plate(patch, beyond);
  for (int round = 0; round < kRounds; ++round) plate.settle();
}

}  // namespace kelp::bake
