// SPDX-License-Identifier: MIT
#include "weights.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <stdexcept>
#include <utility>

#include <Eigen/SparseCholesky>

#include "kelp/common/parallel.h"
#include "kelp/formats/cage.h"

namespace kelp::bake {
namespace {

// How much the differences between neighbors count: of what a node's samples count in the mean.
constexpr double kSmooth = 1e-3;
// How much the change along a sample's normal counts, over a cell's side: of what the sample counts.
constexpr double kUnder = 0.03;
constexpr std::size_t kMost = 4;  // joints of a node

using Matrix = Eigen::SparseMatrix<double>;
using Edge = std::pair<std::uint32_t, std::uint32_t>;

// Edges of the cells, each once.
std::vector<Edge> edgesOf(const Cage& cage) {
  std::vector<Edge> edges;
  for (std::uint32_t c = 0; c < cage.cells(); ++c)
    for (int corner = 0; corner < 8; ++corner)
      for (int axis = 0; axis < 3; ++axis)
        if (!(corner >> axis & 1))
          edges.emplace_back(std::minmax(cage.node(c, corner), cage.node(c, corner | 1 << axis)));
  std::sort(edges.begin(), edges.end());
  edges.erase(std::unique(edges.begin(), edges.end()), edges.end());
  return edges;
}

// How much nodes count in the change of a number interpolated at a place, over a cell's side along a
// direction.
std::array<double, 4> alongNormal(const CagePlaces::Place& place, const Cage& cage,
                                  const glm::dvec3& normal) {
  std::array<double, 4> along{};
  for (std::size_t i = 0; i < 3; ++i) {
    // From node to node, each time by a side along another axis.
    const glm::dvec3 edge(cage.rest(place.nodes[i + 1]) - cage.rest(place.nodes[i]));
    const double its = glm::dot(edge, normal) / cage.side;
    along[i] -= its;
    along[i + 1] += its;
  }
  return along;
}

// The normal equations.
Matrix equations(const SkinSamples& samples, const SamplePlaces& places, const Cage& cage,
                 const std::vector<Edge>& edges) {
  using Entry = Eigen::Triplet<double>;
  std::vector<Entry> entries;
  const auto add = [&](std::uint32_t row, std::uint32_t column, double value) {
    entries.emplace_back(static_cast<int>(row), static_cast<int>(column), value);
  };
  double diagonal = 0;
  for (std::size_t s = 0; s < samples.size(); ++s) {
    if (!places[s]) continue;
    const CagePlaces::Place& place = *places[s];
    const std::array<double, 4> along = alongNormal(place, cage, samples.normals[s]);
    for (std::size_t i = 0; i < 4; ++i)
      for (std::size_t j = 0; j < 4; ++j) {
        const double value = samples.areas[s] * place.weights[i] * place.weights[j];
        add(place.nodes[i], place.nodes[j], value + kUnder * samples.areas[s] * along[i] * along[j]);
        if (i == j) diagonal += value;
      }
  }
  diagonal = diagonal > 0 ? diagonal / cage.nodes() : 1;
  for (const auto& [a, b] : edges) {
    const double stiffness = kSmooth * diagonal;
    add(a, a, stiffness);
    add(b, b, stiffness);
    add(a, b, -stiffness);
    add(b, a, -stiffness);
  }
  constexpr double kRegular = 1e-9;
  for (std::uint32_t n = 0; n < cage.nodes(); ++n) add(n, n, kRegular * diagonal);
  const auto count = static_cast<int>(cage.nodes());
  Matrix matrix(count, count);
  matrix.setFromTriplets(entries.begin(), entries.end());
  return matrix;
}

// The samples that follow each joint, and their weights.
struct Follower {
  std::uint32_t sample;
  double weight, slope;
};

std::vector<std::vector<Follower>> followersOf(const SkinSamples& samples, const SamplePlaces& places,
                                               std::size_t joints) {
  std::vector<std::vector<Follower>> followers(joints);
  for (std::uint32_t s = 0; s < samples.size(); ++s) {
    if (!places[s]) continue;
    for (std::size_t k = samples.first_weighted[s]; k < samples.first_weighted[s + 1]; ++k)
      followers[samples.weighted[k].joint].push_back(
          {s, samples.weighted[k].weight, samples.slopes.empty() ? 0 : samples.slopes[k]});
  }
  return followers;
}

Eigen::VectorXd rightSide(const SkinSamples& samples, const SamplePlaces& places, const Cage& cage,
                          const std::vector<Follower>& followers) {
  Eigen::VectorXd right = Eigen::VectorXd::Zero(cage.nodes());
  for (const auto& [s, weight, slope] : followers) {
    const std::array<double, 4> along = alongNormal(*places[s], cage, samples.normals[s]);
    for (std::size_t i = 0; i < 4; ++i)
      right[places[s]->nodes[i]] +=
          samples.areas[s] * (places[s]->weights[i] * weight + kUnder * along[i] * slope * cage.side);
  }
  return right;
}

}  // namespace

Influences roundedWeights(std::vector<JointWeight> weights) {
  const std::size_t count = std::min(weights.size(), kMost);
  std::partial_sort(weights.begin(), weights.begin() + static_cast<std::ptrdiff_t>(count), weights.end(),
                    [](const JointWeight& a, const JointWeight& b) {
                      return a.weight > b.weight || (a.weight == b.weight && a.joint < b.joint);
                    });
  weights.resize(count);
  double sum = 0;
  for (const JointWeight& w : weights) sum += w.weight;
  // Down to whole 255ths; those that lose most get what is left.
  int left = 255;
  std::array<int, kMost> whole{};
  std::array<double, kMost> lost{};
  for (std::size_t i = 0; i < count; ++i) {
    const double exact = 255 * weights[i].weight / sum;
    whole[i] = static_cast<int>(exact);
    lost[i] = exact - whole[i];
    left -= whole[i];
  }
  for (; left > 0; --left) {
    const auto most =
        static_cast<std::size_t>(std::max_element(lost.begin(), lost.begin() + count) - lost.begin());
    ++whole[most];
    lost[most] -= 1;
  }
  std::vector<std::pair<std::uint32_t, int>> kept;
  for (std::size_t i = 0; i < count; ++i)
    if (whole[i] > 0) kept.emplace_back(weights[i].joint, whole[i]);
  std::sort(kept.begin(), kept.end());
  Influences influences;
  for (std::size_t i = 0; i < kept.size(); ++i) {
    influences.parts[i] = static_cast<std::uint16_t>(kept[i].first);
    influences.weights[i] = static_cast<std::uint8_t>(kept[i].second);
  }
  return influences;
}

struct NodeSolver::Equations {
  std::vector<Edge> edges;
  Eigen::SimplicialLDLT<Matrix> solver;
};

NodeSolver::NodeSolver(const SkinSamples& samples, const SamplePlaces& places, const Cage& cage)
    : samples_(samples),
      places_(places),
      cage_(cage),
      finder_(samples, cage.side * cage.grid),
      equations_(std::make_unique<Equations>()) {
  equations_->edges = edgesOf(cage);
  equations_->solver.compute(equations(samples, places, cage, equations_->edges));
  if (equations_->solver.info() != Eigen::Success)
    throw std::runtime_error("the weights of a cage have no solution");
  findStrays();
}

NodeSolver::~NodeSolver() = default;

void NodeSolver::findStrays() {
  std::vector<std::uint32_t> above(cage_.nodes());
  std::iota(above.begin(), above.end(), 0u);
  const auto find = [&](std::uint32_t i) {
    while (above[i] != i) i = above[i] = above[above[i]];
    return i;
  };
  for (const auto& [a, b] : equations_->edges) {
    const std::uint32_t one = find(a), other = find(b);
    above[std::max(one, other)] = std::min(one, other);
  }
  std::vector<bool> sampled(cage_.nodes(), false);
  for (const auto& place : places_)
    if (place) sampled[find(place->nodes[0])] = true;
  strays_.resize(cage_.nodes());
  for (std::uint32_t n = 0; n < cage_.nodes(); ++n) {
    const std::uint32_t first = find(n);
    if (sampled[first]) continue;
    strays_[n] = first == n ? finder_.nearest(glm::dvec3(cage_.rest(n))) : strays_[first];
  }
}

std::vector<Influences> NodeSolver::weights(std::size_t joints, int threads) const {
  const std::vector<std::vector<Follower>> followers = followersOf(samples_, places_, joints);
  std::vector<std::vector<JointWeight>> weights(cage_.nodes());
  // Some joints at a time: their weights at all nodes would fill the memory.
  constexpr std::size_t kTogether = 16;
  for (std::size_t first = 0; first < joints; first += kTogether) {
    std::array<Eigen::VectorXd, kTogether> solved;
    const std::size_t count = std::min(kTogether, joints - first);
    parallelRanges(count, 1, threads, [&](std::size_t begin, std::size_t end) {
      for (std::size_t j = begin; j < end; ++j)
        if (!followers[first + j].empty())
          solved[j] = equations_->solver.solve(rightSide(samples_, places_, cage_, followers[first + j]));
    });
    constexpr double kLeast = 1e-4;
    for (std::size_t j = 0; j < count; ++j)
      for (Eigen::Index n = 0; n < solved[j].size(); ++n)
        if (solved[j][n] > kLeast)
          weights[static_cast<std::size_t>(n)].push_back(
              {solved[j][n], static_cast<std::uint32_t>(first + j)});
  }
  std::vector<Influences> rounded;
  rounded.reserve(weights.size());
  for (std::uint32_t n = 0; n < cage_.nodes(); ++n) {
    if (strays_[n] || weights[n].empty()) {
      weights[n].clear();
      const std::uint32_t nearest = strays_[n] ? *strays_[n] : finder_.nearest(glm::dvec3(cage_.rest(n)));
      for (const SkinSamples::Weighted& w : samples_.weights(nearest))
        weights[n].push_back({w.weight, w.joint});
    }
    rounded.push_back(roundedWeights(std::move(weights[n])));
  }
  return rounded;
}

std::vector<RawMorph> NodeSolver::morphs(std::size_t count,
                                         const std::function<std::vector<Offset>(std::size_t)>& of_samples,
                                         int threads) const {
  std::vector<RawMorph> out(count);
  parallelRanges(count, 1, threads, [&](std::size_t begin, std::size_t end) {
    for (std::size_t m = begin; m < end; ++m) out[m] = morph(of_samples(m));
  });
  return out;
}

RawMorph NodeSolver::morph(const std::vector<Offset>& of_samples) const {
  RawMorph out;
  if (of_samples.empty()) return out;
  Eigen::MatrixX3d right = Eigen::MatrixX3d::Zero(cage_.nodes(), 3);
  for (const Offset& offset : of_samples) {
    if (!places_[offset.index]) continue;
    const CagePlaces::Place& place = *places_[offset.index];
    for (std::size_t i = 0; i < 4; ++i)
      for (int axis = 0; axis < 3; ++axis)
        right(place.nodes[i], axis) += samples_.areas[offset.index] * place.weights[i] * offset.by[axis];
  }
  const Eigen::MatrixX3d solved = equations_->solver.solve(right);
  constexpr double kLeast = 0.02, kFarthest = 1e9, kFinest = 1.0 / 256;  // voxels
  constexpr double kMostSteps = 32767;
  std::vector<glm::dvec3> offsets;
  double most = 0;
  for (std::uint32_t n = 0; n < cage_.nodes(); ++n) {
    glm::dvec3 by(solved(n, 0), solved(n, 1), solved(n, 2));
    if (strays_[n]) {
      const auto its = std::lower_bound(of_samples.begin(), of_samples.end(), *strays_[n],
                                        [](const Offset& o, std::uint32_t index) { return o.index < index; });
      by = its != of_samples.end() && its->index == *strays_[n] ? its->by : glm::dvec3(0);
    }
    if (glm::length(by) < kLeast) continue;
    out.nodes.push_back(n);
    offsets.push_back(by);
    for (int axis = 0; axis < 3; ++axis) most = std::max(most, std::abs(by[axis]));
  }
  if (most > kFarthest) return {};
  out.step = static_cast<float>(std::max(most / kMostSteps, kFinest));
  for (const glm::dvec3& by : offsets)
    out.offsets.emplace_back(
        glm::clamp(glm::round(by / static_cast<double>(out.step)), -kMostSteps, kMostSteps));
  return out;
}

}  // namespace kelp::bake
