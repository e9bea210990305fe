// SPDX-License-Identifier: MIT
#include "fairing.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

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
  // The patch, and around it a band to the points beyond.
  Plate(const Patch& patch, std::span<const glm::dvec3> beyond)
      : mesh_(patch.mesh), rim_(static_cast<int>(patch.rim)), count_(static_cast<int>(mesh_.n_vertices())) {
    for (const glm::dvec3& p : beyond) mesh_.add_vertex(toPoint(p));
    for (int i = 0; i < rim_; ++i) {
      const int next = (i + 1) % rim_;
      const OpenMesh::VertexHandle a(i), b(next), c(count_ + i), d(count_ + next);
      mesh_.add_face(b, a, c);
      mesh_.add_face(b, c, d);
    }
    number();
  }

  void settle() {
    weigh();
    std::vector<glm::dvec3> x(order_.size(), glm::dvec3(0));
    EnvelopeMatrix matrix(envelope_);
    // One row of the Laplacian a point that is not beyond the rim.
    std::vector<std::pair<OpenMesh::SmartVertexHandle, double>> row;
    for (int v = 0; v < count_; ++v) {
      row.assign(1, {at(v), 0.0});
      for (const OpenMesh::SmartHalfedgeHandle half_edge : at(v).outgoing_halfedges()) {
        const double weight = weights_[index(half_edge.edge())];
        row.emplace_back(half_edge.to(), weight);
        row[0].second -= weight;
      }
      for (const auto& [p, a] : row) {
        const std::uint32_t i = number_[index(p)];
        if (i == kFixed) continue;
        for (const auto& [q, b] : row) {
          const std::uint32_t k = number_[index(q)];
          const double product = a * b / areas_[static_cast<std::size_t>(v)];
          if (k == kFixed) {
            x[i] -= product * pointOf(mesh_, q);
          } else if (k <= i) {
            matrix.at(i, k) += product;
          }
        }
      }
    }
    matrix.decompose();
    matrix.solve(x);
    for (std::size_t i = 0; i < order_.size(); ++i) mesh_.set_point(order_[i], toPoint(x[i]));
  }

  void moveTo(Patch& patch) const {
    for (const OpenMesh::VertexHandle vertex : order_) patch.mesh.set_point(vertex, mesh_.point(vertex));
  }

 private:
  static std::size_t index(OpenMesh::BaseHandle handle) { return static_cast<std::size_t>(handle.idx()); }
  OpenMesh::SmartVertexHandle at(int vertex) const {
    return OpenMesh::make_smart(OpenMesh::VertexHandle(vertex), mesh_);
  }

  // Numbers for the points within such that neighbours' neighbours have near ones.
  void number() {
    number_.assign(mesh_.n_vertices(), kFixed);
    std::vector<bool> seen(mesh_.n_vertices(), false);
    std::vector<OpenMesh::SmartVertexHandle> front;
    for (int seed = 0; seed < count_; ++seed) {
      if (seen[static_cast<std::size_t>(seed)]) continue;
      seen[static_cast<std::size_t>(seed)] = true;
      front.assign(1, at(seed));
      for (std::size_t next = 0; next < front.size(); ++next) {
        const OpenMesh::SmartVertexHandle v = front[next];
        if (v.idx() >= rim_) {
          number_[index(v)] = static_cast<std::uint32_t>(order_.size());
          order_.push_back(v);
        }
        for (const OpenMesh::SmartVertexHandle to : v.vertices()) {
          // Along the rim the search would come in from all sides at once.
          if (to.idx() >= count_ || seen[index(to)] || (v.idx() < rim_ && to.idx() < rim_)) continue;
          seen[index(to)] = true;
          front.push_back(to);
        }
      }
    }
    envelope_.resize(order_.size());
    for (std::uint32_t i = 0; i < order_.size(); ++i) envelope_[i] = i;
    for (int v = 0; v < count_; ++v) {
      std::uint32_t least = number_[static_cast<std::size_t>(v)];
      const auto widen = [&](std::uint32_t n) {
        if (n != kFixed) envelope_[n] = std::min(envelope_[n], least);
      };
      for (const OpenMesh::SmartVertexHandle to : at(v).vertices())
        least = std::min(least, number_[index(to)]);
      widen(number_[static_cast<std::size_t>(v)]);
      for (const OpenMesh::SmartVertexHandle to : at(v).vertices()) widen(number_[index(to)]);
    }
  }

  // Cotangents and areas of the shape as it is.
  void weigh() {
    weights_.assign(mesh_.n_edges(), 0.0);
    areas_.assign(mesh_.n_vertices(), 1e-9);
    for (const OpenMesh::SmartHalfedgeHandle half_edge : mesh_.halfedges()) {
      if (half_edge.is_boundary()) continue;
      const OpenMesh::SmartVertexHandle opposite = half_edge.next().to();
      const glm::dvec3 p = pointOf(mesh_, opposite), u = pointOf(mesh_, half_edge.from()) - p,
                       v = pointOf(mesh_, half_edge.to()) - p;
      const double twice = glm::length(glm::cross(u, v));
      // Needles must not outweigh all else.
      weights_[index(half_edge.edge())] +=
          std::clamp(glm::dot(u, v) / (twice + 1e-12), -kSteepest, kSteepest) * 0.5;
      areas_[index(opposite)] += twice / 6;
    }
  }
  static constexpr double kSteepest = 10;

  HalfEdgeMesh mesh_;
  int rim_, count_;  // the first vertices are the rim, then those within, then those beyond
  std::vector<double> weights_, areas_;  // of edges, of vertices
  std::vector<std::uint32_t> number_, envelope_;
  std::vector<OpenMesh::SmartVertexHandle> order_;
};

}  // namespace

void fairPatch(Patch& patch, std::span<const glm::dvec3> beyond) {
  constexpr int kRounds = 3;
  Plate plate(patch, beyond);
  for (int round = 0; round < kRounds; ++round) plate.settle();
  plate.moveTo(patch);
}

}  // namespace kelp::bake
