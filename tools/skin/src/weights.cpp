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

// What nodes count in the change of what is interpolated at a place, over a cell's side along a direction.
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

// Nodes that edges join to no sample get the weights of the sample nearest to the first of them. So does a
// node without weights.
void followNearest(const SkinSamples& samples, const SamplePlaces& places, const Cage& cage,
                   const std::vector<Edge>& edges, std::vector<std::vector<JointWeight>>& weights) {
  std::vector<std::uint32_t> above(cage.nodes());
  std::iota(above.begin(), above.end(), 0u);
  const auto find = [&](std::uint32_t i) {
    while (above[i] != i) i = above[i] = above[above[i]];
    return i;
  };
  for (const auto& [a, b] : edges) {
    const std::uint32_t one = find(a), other = find(b);
    above[std::max(one, other)] = std::min(one, other);
  }
  const SampleFinder finder(samples, cage.side * cage.grid);
  std::vector<bool> sampled(cage.nodes(), false);
  for (const auto& place : places)
    if (place) sampled[find(place->nodes[0])] = true;
  for (std::uint32_t n = 0; n < cage.nodes(); ++n) {
    if (sampled[find(n)] && !weights[n].empty()) continue;
    if (!sampled[find(n)] && find(n) != n) {
      weights[n] = weights[find(n)];
      continue;
    }
    weights[n].clear();
    for (const SkinSamples::Weighted& w : samples.weights(finder.nearest(glm::dvec3(cage.rest(n)))))
      weights[n].push_back({w.weight, w.joint});
  }
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

std::vector<Influences> weightsOfNodes(const SkinSamples& samples, const SamplePlaces& places,
                                       const Cage& cage, std::size_t joints, int threads) {
  const std::vector<Edge> edges = edgesOf(cage);
  Eigen::SimplicialLDLT<Matrix> solver(equations(samples, places, cage, edges));
  if (solver.info() != Eigen::Success) throw std::runtime_error("the weights of a cage have no solution");
  const std::vector<std::vector<Follower>> followers = followersOf(samples, places, joints);
  std::vector<std::vector<JointWeight>> weights(cage.nodes());
  // Some joints at a time: their weights at all nodes would fill the memory.
  constexpr std::size_t kTogether = 16;
  for (std::size_t first = 0; first < joints; first += kTogether) {
    std::array<Eigen::VectorXd, kTogether> solved;
    const std::size_t count = std::min(kTogether, joints - first);
    parallelRanges(count, 1, threads, [&](std::size_t begin, std::size_t end) {
      for (std::size_t j = begin; j < end; ++j)
        if (!followers[first + j].empty())
          solved[j] = solver.solve(rightSide(samples, places, cage, followers[first + j]));
    });
    constexpr double kLeast = 1e-4;
    for (std::size_t j = 0; j < count; ++j)
      for (Eigen::Index n = 0; n < solved[j].size(); ++n)
        if (solved[j][n] > kLeast)
          weights[static_cast<std::size_t>(n)].push_back(
              {solved[j][n], static_cast<std::uint32_t>(first + j)});
  }
  followNearest(samples, places, cage, edges, weights);
  std::vector<Influences> rounded;
  rounded.reserve(weights.size());
  for (std::vector<JointWeight>& list : weights) rounded.push_back(roundedWeights(std::move(list)));
  return rounded;
}

}  // namespace kelp::bake
