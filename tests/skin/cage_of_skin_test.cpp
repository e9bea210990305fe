// SPDX-License-Identifier: MIT
// Cages of skins whose weights are known in closed form; weights against dense equations; the fit against
// points that are placed and posed here.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <random>
#include <vector>

#include "kelp/common/dense_index.h"
#include "kelp/fields/fields.h"
#include "kelp/formats/cage.h"
#include "skin_shapes.h"
#include "weights.h"

namespace kelp::bake {
namespace {

using test::SkinnedShape;

// The finest cage of a result, as readers make it.
struct Finest {
  Finest(const SkinCage& of, const glm::ivec3& size) {
    const Result<Cage> made = makeCage(of.cages[0].source(), size, 5, of.cell, 0, nullptr, 1u << 30, memory);
    EXPECT_TRUE(made) << made.error().detail;
    cage = *made;
    EXPECT_EQ(of.influences.size(), cage.nodes());
  }
  CageMemory memory;
  Cage cage;
};

double weightOf(const Influences& node, std::uint32_t joint) {
  for (int i = 0; i < 4; ++i)
    if (node.weights[i] != 0 && node.parts[i] == joint) return node.weights[i] / 255.0;
  return 0;
}

void expectSound(const SkinCage& made, std::size_t joints) {
  for (const Influences& node : made.influences) {
    int sum = 0;
    for (int i = 0; i < 4; ++i) {
      sum += node.weights[i];
      if (node.weights[i] == 0) {
        ASSERT_EQ(node.parts[i], 0);
        continue;
      }
      ASSERT_LT(node.parts[i], joints);
      if (i > 0) {
        ASSERT_LT(node.parts[i - 1], node.parts[i]);
      }
    }
    ASSERT_EQ(sum, 255);
  }
}

// Interpolation in tetrahedra is exact for what is linear, so nodes have the weights of the ramp.
TEST(CageOfSkin, NodesHaveWeightsThatAreLinear) {
  SkinnedShape shape = test::tube(2);
  for (const int cell : {4, 8}) {
    const SkinCage made = shape.cage(cell);
    EXPECT_EQ(made.cell, cell);
    ASSERT_EQ(made.joints.size(), 2u);
    expectSound(made, 2);
    const Finest finest(made, shape.whole.size);
    for (std::uint32_t n = 0; n < finest.cage.nodes(); ++n) {
      const double y = finest.cage.rest(n).y, upper = std::clamp((y - 32) / 64, 0.0, 1.0);
      const bool at_kink = std::abs(std::abs(y - 64) - 32) <= 2 * cell;
      ASSERT_NEAR(weightOf(made.influences[n], 1), upper, at_kink ? 0.05 : 0.02) << y;
    }
  }
}

TEST(CageOfSkin, OneJointMovesAll) {
  SkinnedShape shape = test::tube(1);
  for (const Influences& node : shape.cage(8).influences)
    ASSERT_EQ(node, (Influences{{0, 0, 0, 0}, {255, 0, 0, 0}}));
}

// Two boxes side by side, of joints that have nothing to do with each other.
TEST(CageOfSkin, ComponentsThatTouchAreCutWhereTheirWeightsDiffer) {
  for (const std::uint32_t other : {1u, 0u}) {
    SkinnedShape shape;
    shape.addJoint(-1, {0, 0, 0});
    shape.addJoint(-1, {2, 0, 0});
    shape.addBox({-1, 0, -1}, {1, 4, 1}, 0);
    shape.addBox({1.001, 0, -1}, {3, 4, 1}, other);
    shape.finish(64);
    const SkinCage made = shape.cage(8);
    const Finest finest(made, shape.whole.size);
    std::vector<int> touching_points(2, 0);
    for (std::uint32_t c = 0; c < finest.cage.cells(); ++c)
      for (int corner = 0; corner < 8; ++corner) {
        const std::uint32_t node = finest.cage.node(c, corner);
        ASSERT_NEAR(weightOf(made.influences[node], 0) + weightOf(made.influences[node], 1), 1, 1e-9);
        // Each follows one of them alone.
        ASSERT_TRUE(weightOf(made.influences[node], 0) == 1 || weightOf(made.influences[node], 1) == 1);
        if (finest.cage.rest(node).x == 32)
          ++touching_points[weightOf(made.influences[node], 1) == 1 ? 1 : 0];
      }
    EXPECT_GT(touching_points[0], 0);
    EXPECT_EQ(touching_points[1] > 0, other == 1);
    EXPECT_EQ(made.cages[0].split_points.empty(), other == 0);
  }
}

// A bar that is bent like a hairpin: its two halves touch, and only the mesh at its end joins them.
TEST(CageOfSkin, SurfacesThatTouchAreCutWhereTheMeshDoesNotJoinThem) {
  SkinnedShape shape;
  shape.addJoint(-1, {0, 0, 0});
  shape.addJoint(-1, {2, 0, 0});
  std::vector<std::array<std::uint32_t, 4>> rings;
  const auto addRing = [&](const glm::dvec2& inner, const glm::dvec2& outer, float upper) {
    std::vector<SourceSkin::Influence> influences;
    if (upper < 1) influences.push_back({0, 1 - upper});
    if (upper > 0) influences.push_back({1, upper});
    std::array<std::uint32_t, 4>& ring = rings.emplace_back();
    ring[0] = shape.addVertex({outer, -0.5}, influences);
    ring[1] = shape.addVertex({inner, -0.5}, influences);
    ring[2] = shape.addVertex({inner, 0.5}, influences);
    ring[3] = shape.addVertex({outer, 0.5}, influences);
  };
  for (int y = 0; y <= 7; ++y) addRing({1, y}, {0, y}, 0);
  addRing({1, 7.2}, {0, 8}, 0.4f);
  addRing({1.0001, 7.2}, {2, 8}, 0.6f);
  for (int y = 7; y >= 0; --y) addRing({1.0001, y}, {2, y}, 1);
  const auto addFace = [&](std::uint32_t a, std::uint32_t b, std::uint32_t c, std::uint32_t d) {
    shape.addTriangle(a, b, c);
    shape.addTriangle(a, c, d);
  };
  for (std::size_t r = 0; r + 1 < rings.size(); ++r)
    for (std::size_t k = 0; k < 4; ++k)
      addFace(rings[r][k], rings[r + 1][k], rings[r + 1][(k + 1) % 4], rings[r][(k + 1) % 4]);
  addFace(rings.front()[0], rings.front()[1], rings.front()[2], rings.front()[3]);
  addFace(rings.back()[3], rings.back()[2], rings.back()[1], rings.back()[0]);
  shape.finish(64);
  const SkinCage made = shape.cage(4);
  const Finest finest(made, shape.whole.size);
  int sides[2] = {0, 0};
  for (std::uint32_t n = 0; n < finest.cage.nodes(); ++n) {
    const glm::ivec3 at = finest.cage.rest(n);
    if (at.y > 40) continue;  // the mesh joins them from 56 on
    const double upper = weightOf(made.influences[n], 1);
    ASSERT_LT(std::min(upper, 1 - upper), 0.02) << at.x << " " << at.y;
    if (at.x == 8) ++sides[upper > 0.5];
  }
  EXPECT_GT(sides[0], 10);
  EXPECT_GT(sides[1], 10);
}

// Two long legs touch, and share their upper corner alone: below, nothing joins their long triangles.
TEST(CageOfSkin, LongTrianglesJoinOnlyWhereTheyMeet) {
  SkinnedShape shape;
  shape.addJoint(-1, {0, 0, 0});
  shape.addJoint(-1, {2, 0, 0});
  const std::uint32_t apex = shape.addVertex({1, 8, 0}, {{0, 0.5f}, {1, 0.5f}});
  for (const std::uint32_t leg : {0u, 1u}) {
    const double inner = leg == 0 ? 1.03 : 0.97, outer = leg == 0 ? -1.4 : 3.4;
    std::uint32_t foot[4];
    for (int k = 0; k < 4; ++k)
      foot[k] = shape.addVertex({k == 0 || k == 3 ? outer : inner, 0, k < 2 ? -1.2 : 1.2}, {{leg, 1}});
    if (leg == 1) std::swap(foot[1], foot[3]);
    for (int k = 0; k < 4; ++k) shape.addTriangle(apex, foot[(k + 1) % 4], foot[k]);
    shape.addTriangle(foot[0], foot[1], foot[2]);
    shape.addTriangle(foot[0], foot[2], foot[3]);
  }
  shape.finish(64);
  const SkinCage made = shape.cage(4);
  const Finest finest(made, shape.whole.size);
  const int middle = shape.whole.size.x / 2;
  int sides[2] = {0, 0};
  for (std::uint32_t n = 0; n < finest.cage.nodes(); ++n) {
    const glm::ivec3 at = finest.cage.rest(n);
    if (at.y > 16 || std::abs(at.x - middle) > 4) continue;
    const double second = weightOf(made.influences[n], 1);
    ASSERT_LT(std::min(second, 1 - second), 0.3) << at.x << " " << at.y << " " << at.z;
    ++sides[second > 0.5];
  }
  EXPECT_GT(sides[0], 10);
  EXPECT_GT(sides[1], 10);
}

TEST(CageOfSkin, CellsAreAsLargeAsTheFitAllows) {
  SkinnedShape still = test::bendingTube(3, 0);
  EXPECT_EQ(still.cage(0).cell, 16);
  SkinnedShape bent = test::bendingTube(3, 0.4), folded = test::bendingTube(8, 1.2);
  const SkinCage some = bent.cage(0), more = folded.cage(0);
  EXPECT_LE(more.cell, some.cell);
  for (const auto& [made, shape] : {std::pair(&some, &bent), std::pair(&more, &folded)}) {
    ASSERT_EQ(made->fits.size(), 1u);
    EXPECT_EQ(made->fits[0].clip, "bend");
    EXPECT_LE(made->fits[0].distances.mean, 0.3);
    EXPECT_LE(made->fits[0].distances.p95, 1);
    if (made->cell == 16) continue;
    const SkinDistances coarser = shape->cage(2 * made->cell).fits[0].distances;
    EXPECT_TRUE(coarser.mean > 0.3 || coarser.p95 > 1) << made->cell;
  }
  // More than 256 cells of 8 voxels do not fit along an axis.
  EXPECT_EQ(folded.cage(2).cell, 2);
}

TEST(CageOfSkin, IsTheSameOnAnyNumberOfThreads) {
  SkinnedShape shape = test::bendingTube(3, 0.9);
  const SkinCage one = shape.cage(0), four = shape.cage(0, 4);
  EXPECT_EQ(one.influences, four.influences);
  EXPECT_EQ(one.cages[0].blocks, four.cages[0].blocks);
  EXPECT_EQ(one.fits[0].distances.mean, four.fits[0].distances.mean);
  ASSERT_EQ(one.joints.size(), four.joints.size());
  for (std::size_t j = 0; j < one.joints.size(); ++j)
    EXPECT_EQ(one.joints[j].rig.clips, four.joints[j].rig.clips);
}

// Points of the surface at random, in the cell of the nearest voxel, against the motions of the clip.
TEST(CageOfSkin, ReportsHowFarItIsFromTheSkin) {
  SkinnedShape shape = test::bendingTube(4, 0.9);
  const SkinCage made = shape.cage(16);
  const Finest finest(made, shape.whole.size);
  const glm::dmat4 to_soup = glm::inverse(shape.frame.node_to_voxel);
  std::mt19937 random(5);
  const auto unit = [&] { return random() / 4294967296.0; };
  std::vector<double> distances;
  while (distances.size() < 4000) {
    const double y = unit() * test::kTubeHeight, turn = 6.2831853 * unit(),
                 time = 2 * (std::floor(12 * unit()) + 0.5) / 12;
    const glm::dvec3 at(test::kTubeRadius * std::cos(turn), y, test::kTubeRadius * std::sin(turn));
    std::vector<glm::dmat4> motions;
    for (std::size_t j = 0; j < 4; ++j) {
      const glm::dmat4& frame = shape.skin().joints[j].frame;
      const glm::dmat4 turned =
          frame *
          glm::rotate(glm::dmat4(1), j == 0 ? 0.0 : 0.9 * std::sin(1.5707963 * time), glm::dvec3(0, 0, 1)) *
          glm::inverse(frame);
      motions.push_back(j == 0 ? turned : motions[j - 1] * turned);
    }
    glm::dvec4 skinned(0);
    for (std::size_t j = 0; j < 4; ++j) {
      const double inner = std::clamp(y, 1.6, test::kTubeHeight - 1.6);
      skinned +=
          std::max(0.0, 1 - std::abs(inner - (j + 0.5) * 3.2) / 3.2) * (motions[j] * glm::dvec4(at, 1));
    }
    const glm::dvec3 voxel(shape.frame.node_to_voxel * glm::dvec4(at, 1)), in = voxel / 16.0;
    const glm::ivec3 cube(in);
    std::uint32_t cell = 0;
    while (cell < finest.cage.cells() && finest.cage.place(cell) != cube) ++cell;
    if (cell == finest.cage.cells()) continue;  // a facet cuts the corner of a cell off
    // Barycentric: from corner 0 along the axes in the order in which the coordinates fall.
    glm::dvec3 f = in - glm::dvec3(cube);
    std::array<int, 3> order{0, 1, 2};
    std::sort(order.begin(), order.end(), [&](int a, int b) { return f[a] > f[b]; });
    glm::dvec4 caged(0);
    int corner = 0;
    double before = 1;
    for (int k = 0; k <= 3; ++k) {
      const double after = k < 3 ? f[order[static_cast<std::size_t>(k)]] : 0.0;
      const std::uint32_t node = finest.cage.node(cell, corner);
      const glm::dvec4 rest = to_soup * glm::dvec4(glm::dvec3(finest.cage.rest(node)), 1);
      for (std::uint32_t j = 0; j < 4; ++j)
        caged += (before - after) * weightOf(made.influences[node], j) * (motions[j] * rest);
      if (k < 3) corner |= 1 << order[static_cast<std::size_t>(k)];
      before = after;
    }
    distances.push_back(glm::length(glm::dvec3(caged - skinned)) / shape.frame.voxel_size);
  }
  double mean = 0;
  for (const double distance : distances) mean += distance / static_cast<double>(distances.size());
  std::sort(distances.begin(), distances.end());
  const SkinDistances& told = made.fits[0].distances;
  EXPECT_NEAR(told.mean, mean, 0.1 * mean);
  EXPECT_NEAR(told.p95, distances[3800], 0.1 * told.p95);
  EXPECT_GT(told.max, told.p95);
  EXPECT_GT(mean, 0.1);
}

// Gauss's elimination.
std::vector<double> solved(std::vector<std::vector<double>> matrix, std::vector<double> right) {
  const std::size_t count = right.size();
  for (std::size_t i = 0; i < count; ++i) {
    std::size_t pivot = i;
    for (std::size_t r = i + 1; r < count; ++r)
      if (std::abs(matrix[r][i]) > std::abs(matrix[pivot][i])) pivot = r;
    std::swap(matrix[i], matrix[pivot]);
    std::swap(right[i], right[pivot]);
    for (std::size_t r = i + 1; r < count; ++r) {
      const double factor = matrix[r][i] / matrix[i][i];
      for (std::size_t c = i; c < count; ++c) matrix[r][c] -= factor * matrix[i][c];
      right[r] -= factor * right[i];
    }
  }
  for (std::size_t i = count; i-- > 0;) {
    for (std::size_t c = i + 1; c < count; ++c) right[i] -= matrix[i][c] * right[c];
    right[i] /= matrix[i][i];
  }
  return right;
}

// Samples at random in the cells of a block, of six joints.
TEST(SkinWeights, AreThoseOfDenseEquations) {
  fields::Occupancy block{{12, 16, 12}, {}};
  block.solid.assign(denseCount(block.size), 1);
  const fields::SolidBits bits(block, 1);
  const std::vector<std::uint16_t> none;
  const CagePlaces places(bits, none, 4);
  const Cage& cage = places.cage();
  SkinSamples samples;
  SamplePlaces of;
  samples.first_weighted.push_back(0);
  std::mt19937 random(3);
  const auto unit = [&] { return random() / 4294967296.0; };
  constexpr std::size_t kJoints = 6;
  for (int s = 0; s < 300; ++s) {
    glm::dvec3 at(12 * unit(), 16 * unit(), 12 * unit());
    at[s % 3] = s % 2 ? 0.01 : block.size[s % 3] - 0.01;
    samples.positions.push_back(at);
    samples.areas.push_back(0.5 + unit());
    samples.normals.push_back(glm::normalize(glm::dvec3(unit() - 0.5, unit() - 0.5, unit() - 0.5)));
    double sum = 0;
    std::array<double, kJoints> weights{};
    for (std::size_t j = 0; j < kJoints; ++j) sum += weights[j] = std::exp(-std::abs(at.y - 3.0 * j)) + 0.01;
    for (std::uint32_t j = 0; j < kJoints; ++j) {
      samples.weighted.push_back({j, weights[j] / sum});
      samples.slopes.push_back(0.1 * (unit() - 0.5));
    }
    samples.first_weighted.push_back(samples.weighted.size());
    of.push_back(places.find(at, glm::ivec3(at)));
    ASSERT_TRUE(of.back());
    glm::dvec3 back(0);  // the place is where the sample is
    for (int i = 0; i < 4; ++i) back += of.back()->weights[i] * glm::dvec3(cage.rest(of.back()->nodes[i]));
    ASSERT_LT(glm::distance(back, at), 1e-9);
  }
  const std::size_t nodes = cage.nodes();
  std::vector<std::vector<double>> matrix(nodes, std::vector<double>(nodes, 0));
  std::vector<std::array<double, 4>> over(samples.size());  // what nodes add over a side along the normal
  double diagonal = 0;
  for (std::size_t s = 0; s < samples.size(); ++s) {
    glm::dmat4 corners(1);  // the inverse takes points to the weights of these
    for (int i = 0; i < 4; ++i) corners[i] = glm::dvec4(glm::dvec3(cage.rest(of[s]->nodes[i])), 1);
    const glm::dvec4 change = glm::inverse(corners) * glm::dvec4(4.0 * samples.normals[s], 0);
    for (int i = 0; i < 4; ++i) {
      over[s][i] = change[i];
      diagonal += samples.areas[s] * of[s]->weights[i] * of[s]->weights[i] / static_cast<double>(nodes);
      for (int k = 0; k < 4; ++k)
        matrix[of[s]->nodes[i]][of[s]->nodes[k]] +=
            samples.areas[s] * (of[s]->weights[i] * of[s]->weights[k] + 0.03 * change[i] * change[k]);
    }
  }
  for (std::size_t n = 0; n < nodes; ++n)
    for (std::size_t m = 0; m < nodes; ++m) {
      const glm::ivec3 apart =
          glm::abs(cage.rest(static_cast<std::uint32_t>(n)) - cage.rest(static_cast<std::uint32_t>(m)));
      if (apart.x + apart.y + apart.z != 4 || std::max({apart.x, apart.y, apart.z}) != 4) continue;
      matrix[n][m] -= 0.001 * diagonal;
      matrix[n][n] += 0.001 * diagonal;
    }
  std::vector<std::vector<double>> columns;
  for (std::uint32_t j = 0; j < kJoints; ++j) {
    std::vector<double> right(nodes, 0);
    for (std::size_t s = 0; s < samples.size(); ++s)
      for (int i = 0; i < 4; ++i)
        right[of[s]->nodes[i]] +=
            samples.areas[s] * (of[s]->weights[i] * samples.weights(s)[j].weight +
                                0.03 * over[s][i] * 4 * samples.slopes[kJoints * s + j]);
    columns.push_back(solved(matrix, right));
  }
  const std::vector<Influences> made = NodeSolver(samples, of, cage).weights(kJoints, 2);
  ASSERT_EQ(made.size(), nodes);
  for (std::size_t n = 0; n < nodes; ++n) {
    std::vector<double> kept;
    for (const auto& column : columns) kept.push_back(std::max(column[n], 0.0));
    std::vector<double> sorted = kept;
    std::sort(sorted.rbegin(), sorted.rend());
    const double sum = sorted[0] + sorted[1] + sorted[2] + sorted[3];
    if (sorted[3] - sorted[4] < 1e-6) continue;  // either may be kept
    for (std::uint32_t j = 0; j < kJoints; ++j)
      ASSERT_NEAR(weightOf(made[n], j), kept[j] < sorted[3] ? 0 : kept[j] / sum, 1.5 / 255) << n << " " << j;
  }
}

TEST(SkinWeights, AreRoundedSoThatTheySumToOne) {
  EXPECT_EQ(roundedWeights({{0.5, 7}, {0.5, 3}}), (Influences{{3, 7, 0, 0}, {128, 127, 0, 0}}));
  EXPECT_EQ(roundedWeights({{2, 9}}), (Influences{{9, 0, 0, 0}, {255, 0, 0, 0}}));
  // The fifth falls out; one that rounds to nothing too.
  EXPECT_EQ(roundedWeights({{1, 0}, {0.9, 1}, {0.8, 2}, {0.7, 3}, {0.6, 4}}).parts[3], 3);
  EXPECT_EQ(roundedWeights({{1000, 5}, {1, 2}}), (Influences{{5, 0, 0, 0}, {255, 0, 0, 0}}));
}

}  // namespace
}  // namespace kelp::bake
