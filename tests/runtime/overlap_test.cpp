// SPDX-License-Identifier: MIT
// closestPoint(), overlaps() and sphereCast() against brute force.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "caged_instance.h"
#include "swept_instance.h"

namespace kelp::runtime {
namespace {

// Of each case; a million in all, or some seconds' worth. Brute force over a swept solid takes several times
// as long.
int shareOf(const test::BentInstance& bent, int cases) {
  return bent.instance.asset->pack().parts()[0].bend == Bend::kSweep ? cases / 8 : cases;
}
int shapes(const test::BentInstance& bent) {
  return shareOf(bent, test::allTests() ? 20'000 : test::shareOf(200));
}
int casts(const test::BentInstance& bent) {
  // A million with cages alone.
  if (test::allTests() && !bent.instance.asset->pack().parts()[0].cages.empty()) return 100'000;
  return shareOf(bent, test::allTests() ? 67'000 : test::shareOf(400));
}

// The error of the truth itself: it may be this far too large, in voxels.
constexpr double kStep = 0.25;

// The solid of a level: whole blocks of 2^level voxels in which any is solid.
fields::Occupancy blocksOf(const fields::Occupancy& volume, int level) {
  fields::Occupancy blocks{volume.size, std::vector<std::uint8_t>(volume.solid.size())};
  const auto each = [&](const auto& use) {
    glm::ivec3 v;
    for (v.z = 0; v.z < volume.size.z; ++v.z)
      for (v.y = 0; v.y < volume.size.y; ++v.y)
        for (v.x = 0; v.x < volume.size.x; ++v.x) use(v);
  };
  // Of a block, its first voxel says whether any is solid.
  const auto first = [&](const glm::ivec3& v) { return blocks.index(v >> level << level); };
  each([&](const glm::ivec3& v) { blocks.solid[first(v)] |= volume.solid[volume.index(v)]; });
  each([&](const glm::ivec3& v) { blocks.solid[blocks.index(v)] = blocks.solid[first(v)]; });
  return blocks;
}

struct ShapeQuery : testing::Test {
  fields::Occupancy volume = test::ballClump({60, 80, 50}, 20, 2);
  test::Layers layers{volume};
  std::vector<std::byte> bytes = test::bytesOf(test::distancePackOf(volume));
  MemorySource source{bytes};
  std::unique_ptr<Asset> asset = test::loadDistances(source);

  test::SweptVolume swept;
  test::CagedDistances caged{twoLegs({60, 80, 50}), 8};

  // In all poses of Figure 6, turned, scaled, mirrored; with several segments; with coarser levels only;
  // swept; and with cages.
  void inAllPoses(const std::function<void(test::BentInstance&)>& check) const {
    unsigned seed = 1;
    for (const test::FigurePose& figure : test::kFigure6) {
      SCOPED_TRACE(figure.name);
      const glm::vec3 scale = seed % 2 == 0 ? glm::vec3(2, 2, -2) : glm::vec3(0.5f, 1.5f, 0.5f);
      test::BentInstance bent(*asset, layers, test::figureKnots(figure),
                              test::turned(static_cast<float>(seed), scale, {10, -20, 3}), seed);
      ++seed;
      check(bent);
    }
    const fields::Occupancy reed = test::dust({24, 90, 30}, 60, 3);
    const test::Layers reed_layers(reed);
    const std::vector<std::byte> reed_bytes = test::bytesOf(test::distancePackOf(reed, test::straightStem()));
    const MemorySource reed_source(reed_bytes);
    const auto stem = test::loadDistances(reed_source);
    for (const std::vector<Knot>& knots : {test::straightStem(), test::bentStem()}) {
      SCOPED_TRACE("several segments");
      test::BentInstance bent(*stem, reed_layers, knots, test::turned(4, {-1, 2, 1}, {7, 1, 0}), seed++);
      check(bent);
    }
    for (const int finest : {1, 2}) {
      const auto coarse = test::loadDistances(source, finest);
      const test::Layers blocks(blocksOf(volume, finest));
      for (const int figure : {0, 1, 4}) {
        SCOPED_TRACE(finest);
        test::BentInstance bent(*coarse, blocks,
                                test::figureKnots(test::kFigure6[static_cast<std::size_t>(figure)]),
                                test::turned(3, glm::vec3(2, 2, 2), {1, 2, 3}), seed++);
        bent.voxel *= 1 << finest;
        check(bent);
      }
    }
    swept.inPoses(2, [&](const std::string&, test::BentInstance& bent) { check(bent); });
    caged.inPoses([&](const std::string&, test::BentInstance& bent) { check(bent); });
  }
};

TEST_F(ShapeQuery, ClosestPointIsOfTheSolidAndNearest) {
  inAllPoses([](test::BentInstance& bent) {
    for (int i = 0; i < shapes(bent); ++i) {
      const glm::vec3 point = i % 2 == 0 ? bent.anywhere() : bent.beside();
      const double truth = bent.distanceOf(glm::dvec3(point));
      const ClosestPoint found = closestPoint(bent.instance, point).value();
      ASSERT_NEAR(glm::distance(found.point, point), found.distance, 1e-4 * bent.voxel + 1e-5 * truth);
      ASSERT_LE(bent.distanceOf(glm::dvec3(found.point)), kStep * bent.voxel) << "not of the solid";
      ASSERT_LE(double{found.distance}, truth + bent.voxel);
      ASSERT_FALSE(found.ran_out);
      const float reach = static_cast<float>(0.99 * truth);
      if (truth > 2 * bent.voxel) {
        ASSERT_EQ(closestPoint(bent.instance, point, 0.7f * reach)->part, std::nullopt);
      }
      if (truth > 0.01 * bent.voxel) {  // the truth is within this reach, so something must be found
        const ClosestPoint near =
            closestPoint(bent.instance, point, static_cast<float>(1.0001 * truth)).value();
        ASSERT_EQ(near.part, 0) << truth / bent.voxel;
        ASSERT_LE(double{near.distance}, truth + bent.voxel);
      }
    }
  });
}

TEST_F(ShapeQuery, SpheresOverlapAsTheyShould) {
  inAllPoses([](test::BentInstance& bent) {
    int touched = 0, count = 4 * shapes(bent);
    for (int i = 0; i < count; ++i) {
      const glm::vec3 center = bent.beside();
      const double truth = bent.distanceOf(glm::dvec3(center));
      const double radius = truth + bent.voxel * (4 * bent.unit() - 2.5);
      const Sphere sphere{center, static_cast<float>(std::max(radius, 0.01 * bent.voxel))};
      const bool found = overlaps(bent.instance, sphere).value().has_value();
      touched += found;
      ASSERT_TRUE(found || truth > double{sphere.radius}) << truth / bent.voxel;
      ASSERT_TRUE(!found || truth <= double{sphere.radius} + (1 + kStep) * bent.voxel)
          << truth / bent.voxel << " " << sphere.radius / bent.voxel;
    }
    EXPECT_GT(touched, 0);
    EXPECT_LT(touched, count);
  });
}

TEST_F(ShapeQuery, CapsulesOverlapAsTheyShould) {
  inAllPoses([](test::BentInstance& bent) {
    for (int i = 0; i < shapes(bent); ++i) {
      const glm::vec3 a = bent.beside(3);
      const glm::vec3 b = a + glm::vec3(bent.voxel * 20 * bent.unit() * bent.direction());
      const Capsule capsule{a, b, static_cast<float>(bent.voxel * 4 * bent.unit())};
      double truth = INFINITY;
      for (double t = 0; t <= 1; t += 1.0 / 64)
        truth = std::min(truth, bent.distanceOf(glm::mix(glm::dvec3(a), glm::dvec3(b), t)));
      const bool found = overlaps(bent.instance, capsule).value().has_value();
      ASSERT_TRUE(found || truth > double{capsule.radius});
      ASSERT_TRUE(!found || truth <= double{capsule.radius} + (1 + kStep + 10.0 / 64) * bent.voxel);
    }
  });
}

TEST_F(ShapeQuery, BoxesOverlapAsTheyShould) {
  inAllPoses([](test::BentInstance& bent) {
    for (int i = 0; i < shapes(bent) / 2; ++i) {
      const glm::dvec3 half = bent.voxel * (0.5 + 6.0 * glm::dvec3(bent.unit(), bent.unit(), bent.unit()));
      const OrientedBox box{bent.beside(2.5), glm::vec3(half),
                            glm::angleAxis(static_cast<float>(6 * bent.unit()), glm::vec3(bent.direction()))};
      const glm::dquat turn(box.rotation);
      double truth = INFINITY;
      bool touches = false;
      constexpr int kSide = 6;
      for (int k = 0; k < kSide * kSide * kSide; ++k) {
        const glm::dvec3 share =
            glm::dvec3(k % kSide, k / kSide % kSide, k / kSide / kSide) * (2.0 / (kSide - 1)) - 1.0;
        const glm::dvec3 p = glm::dvec3(box.center) + turn * (share * half);
        const glm::dvec3 near = bent.inside(p) ? p : bent.nearest(p);
        truth = std::min(truth, glm::distance(near, p));
        const glm::dvec3 local = glm::abs(glm::conjugate(turn) * (near - glm::dvec3(box.center)));
        touches |= glm::all(glm::lessThan(local, 0.9999 * half));
      }
      const bool found = overlaps(bent.instance, box).value().has_value();
      ASSERT_TRUE(found || !touches);
      const double apart = glm::length(half) / (kSide - 1);  // between a point of the box and its samples
      ASSERT_TRUE(!found || touches || truth <= apart + (1 + kStep) * bent.voxel);
    }
  });
}

TEST_F(ShapeQuery, SphereCastsStopBeforeContactAndNeverTunnel) {
  inAllPoses([](test::BentInstance& bent) {
    int hits = 0, near = 0, tunnels = 0, ran_out = 0;
    for (int i = 0; i < casts(bent); ++i) {
      const glm::vec3 from = bent.anywhere();
      const glm::vec3 to = i % 3 == 0 ? bent.anywhere() : from + 2.0f * (bent.beside(2) - from);
      const double radius = i % 5 == 0 ? 0.0 : bent.voxel * std::exp(glm::mix(-3.0, 2.5, bent.unit()));
      const SphereCast cast = sphereCast(bent.instance, from, to, static_cast<float>(radius)).value();
      ran_out += cast.ran_out;
      const glm::dvec3 way = glm::dvec3(to) - glm::dvec3(from);
      const double length = glm::length(way), free = double{cast.t} * length;
      for (double s = 0; s < free;) {
        const double room = bent.distanceOf(glm::dvec3(from) + s / length * way) - radius;
        if (room < -1e-5 * bent.voxel) {
          ++tunnels;
          break;
        }
        s += std::max(room - kStep * bent.voxel, 0.1 * bent.voxel);
      }
      if (!cast.hit) {
        ASSERT_TRUE(cast.t == 1 || cast.ran_out);
        continue;
      }
      ++hits;
      ASSERT_NEAR(glm::length(cast.away), 1, 1e-4);
      near += bent.distanceOf(glm::dvec3(cast.center)) - radius <= (1 + kStep) * bent.voxel;
    }
    // Cages may draw voxels out to needles, which take longer and are told less exactly.
    const bool caged = !bent.instance.asset->pack().parts()[0].cages.empty();
    EXPECT_EQ(tunnels, 0);
    EXPECT_LE(ran_out, caged ? casts(bent) / 1000 : 0);
    EXPECT_GT(hits, casts(bent) / 4);
    EXPECT_GE(near, hits * (caged ? 95 : 99) / 100);
  });
}

// Parallelepipeds: the voxels of the undeformed part in a world that shears. Exact.
class ShearedVoxels {
 public:
  ShearedVoxels(const fields::Occupancy& volume, const glm::dmat4& to_world) : to_world_(to_world) {
    for (int i = 0; i < volume.size.x * volume.size.y * volume.size.z; ++i) {
      const glm::ivec3 v(i % volume.size.x, i / volume.size.x % volume.size.y,
                         i / volume.size.x / volume.size.y);
      if (volume.solid[volume.index(v)]) voxels_.emplace_back(v);
    }
  }
  double distanceOf(const glm::dvec3& world) const {
    double least = INFINITY;
    for (const glm::dvec3& voxel : voxels_)
      least = std::min(least, toVoxel(world - glm::dvec3(to_world_ * glm::dvec4(voxel, 1))));
    return least;
  }

 private:
  // The nearest point lies within a corner, an edge, a face or the inside: tries all 27, by the normal
  // equations of the coordinates that are free there.
  double toVoxel(const glm::dvec3& world) const {
    double least = INFINITY;
    for (int place = 0; place < 27; ++place) {
      const glm::ivec3 at(place % 3, place / 3 % 3, place / 9);  // 0, 1, or 2: free
      glm::dmat3 squares(1);
      glm::dvec3 right(0);
      glm::dvec3 rest = world;
      for (int i = 0; i < 3; ++i) rest -= at[i] == 1 ? glm::dvec3(to_world_[i]) : glm::dvec3(0);
      for (int i = 0; i < 3; ++i) {
        for (int j = 0; j < 3; ++j)
          if (at[i] == 2 && at[j] == 2) squares[j][i] = glm::dot(to_world_[i], to_world_[j]);
        if (at[i] == 2) right[i] = glm::dot(glm::dvec3(to_world_[i]), rest);
      }
      const glm::dvec3 share = glm::inverse(squares) * right;
      if (glm::any(glm::lessThan(share, glm::dvec3(0))) || glm::any(glm::greaterThan(share, glm::dvec3(1))))
        continue;
      least = std::min(least, glm::length(rest - glm::dmat3(to_world_) * share));
    }
    return least;
  }

  glm::dmat4 to_world_;
  std::vector<glm::dvec3> voxels_;
};

TEST_F(ShapeQuery, AnswersWithinTwoVoxelsWhereTheMatrixShears) {
  const fields::Occupancy grains = test::dust({12, 16, 9}, 30, 6);
  const std::vector<std::byte> grain_bytes = test::bytesOf(test::distancePackOf(grains));
  const MemorySource grain_source(grain_bytes);
  const auto loaded = test::loadDistances(grain_source);
  for (const float shear : {0.3f, 1.0f, 3.0f, 8.0f}) {
    SCOPED_TRACE(shear);
    std::mt19937 random(7);
    std::normal_distribution<float> normal;
    for (int k = 0; k < 12; ++k) {
      glm::mat4 matrix = test::turned(static_cast<float>(k), {1, k % 2 == 0 ? 1.0f : -0.7f, 1}, {3, 2, 1});
      matrix[0] += shear * normal(random) * matrix[1] + shear * normal(random) * matrix[2];
      matrix[1] += shear * normal(random) * matrix[2];
      const Instance instance{loaded.get(), nullptr, matrix};
      const glm::dmat4 to_world(partToWorld(instance, 0).value());
      const ShearedVoxels truth(grains, to_world);
      double voxel = 0;
      for (int i = 0; i < 3; ++i) voxel = std::max(voxel, glm::length(glm::dvec3(to_world[i])));
      int touched = 0, hits = 0;
      const int count = (test::allTests() ? 20'000 : test::shareOf(200)) / 8;
      for (int i = 0; i < count; ++i) {
        const auto unit = [&] { return std::uniform_real_distribution<double>(-0.3, 1.3)(random); };
        const auto anywhere = [&] {
          return glm::vec3(to_world *
                           glm::dvec4(glm::dvec3(grains.size) * glm::dvec3(unit(), unit(), unit()), 1));
        };
        const glm::vec3 point = anywhere(), to = anywhere();
        const double apart = truth.distanceOf(glm::dvec3(point));
        const ClosestPoint found = closestPoint(instance, point).value();
        ASSERT_NEAR(found.distance, apart, 0.01 * voxel);
        ASSERT_LE(truth.distanceOf(glm::dvec3(found.point)), 1e-4 * voxel) << "not of the solid";
        if (apart > 0.01 * voxel) {
          ASSERT_EQ(closestPoint(instance, point, static_cast<float>(1.001 * apart))->part, 0);
        }
        const float radius = static_cast<float>(std::max(apart + 3 * voxel * (unit() - 0.5), 0.0));
        const bool touches = overlaps(instance, Sphere{point, radius}).value().has_value();
        touched += touches;
        ASSERT_TRUE(touches || apart > double{radius} * (1 - 1e-6));
        ASSERT_TRUE(!touches || apart <= double{radius} + 2 * voxel);
        const SphereCast cast = sphereCast(instance, point, to, 0.3f * radius).value();
        ASSERT_FALSE(cast.ran_out);
        hits += cast.hit;
        for (double t = 0; t < 1; t += 1.0 / 32) {
          const glm::dvec3 center = glm::mix(glm::dvec3(point), glm::dvec3(to), t * double{cast.t});
          ASSERT_GE(truth.distanceOf(center), double{0.3f * radius} * (1 - 1e-6) * (t * double{cast.t} > 0));
        }
        if (cast.hit) {
          ASSERT_LE(truth.distanceOf(glm::dvec3(cast.center)), double{0.3f * radius} + 2 * voxel);
        }
      }
      EXPECT_GT(touched, count / 8);
      EXPECT_GT(hits, count / 8);
    }
  }
}

// A way as long as floats can tell, right through the middle of a box that is a meter high.
TEST_F(ShapeQuery, LongWaysDoNotTunnel) {
  const std::vector<std::byte> box_bytes =
      test::bytesOf(test::distancePackOf(test::dust({64, 64, 64}, 1, 1)));
  const MemorySource box_source(box_bytes);
  const auto loaded = test::loadDistances(box_source);
  Instance instance{loaded.get()};
  const Box box = bounds(instance);
  instance.to_world = glm::translate(glm::mat4(1), -0.5f * (box.min + box.max));
  std::mt19937 random(5);
  std::normal_distribution<float> normal;
  for (const float length : {1e2f, 1e4f, 1e6f, 1e7f, 1e8f, 1e9f, 1e12f}) {
    SCOPED_TRACE(length);
    for (int i = 0; i < 300; ++i) {
      const glm::vec3 from =
          length * glm::normalize(glm::vec3(normal(random), normal(random), normal(random)));
      const SphereCast cast = sphereCast(instance, from, -from, i % 2 == 0 ? 0.0f : 0.01f).value();
      ASSERT_TRUE(cast.hit && !cast.ran_out);
      ASSERT_LE(cast.t, 0.5f);
      ASSERT_GT(double{cast.t}, 0.5 - 2e-6 - 1.0 / double{length});
      EXPECT_TRUE(*overlaps(instance, Capsule{from, -from, 0.01f}));
    }
    for (int axis = 0; axis < 3; ++axis) {
      glm::vec3 from(0);
      from[axis] = length;
      glm::vec3 beside(0);
      beside[(axis + 1) % 3] = 2;
      EXPECT_FALSE(sphereCast(instance, from + beside, beside - from, 0.01f)->hit);
    }
  }
}

// A list answers what the best of its instances answers, with boxes or without.
TEST_F(ShapeQuery, ListsAnswerForTheNearest) {
  std::vector<Instance> list;
  std::vector<Box> boxes;
  std::mt19937 random(3);
  std::uniform_real_distribution<float> unit(-4, 4);
  for (int i = 0; i < 30; ++i) {
    list.push_back({asset.get(), nullptr,
                    test::turned(unit(random), glm::vec3(1), {unit(random), unit(random), unit(random)})});
    boxes.push_back(bounds(list.back()));
  }
  for (int i = 0; i < 500; ++i) {
    const glm::vec3 p(unit(random), unit(random), unit(random)), q(unit(random), unit(random), unit(random));
    const float radius = 0.1f * std::abs(unit(random));
    float bound = kFarAway, closest = kFarAway, t = 1;
    std::optional<int> first;
    for (int k = 0; k < 30; ++k) {
      const Instance& one = list[static_cast<std::size_t>(k)];
      bound = std::min(bound, distance(one, p)->bound);
      closest = std::min(closest, closestPoint(one, p)->distance);
      t = std::min(t, sphereCast(one, p, q, radius)->t);
      if (!first && *overlaps(one, Sphere{p, radius})) first = k;
    }
    for (const std::span<const Box> given : {std::span<const Box>(), std::span<const Box>(boxes)}) {
      const Distance found = *distance(list, p, given);
      EXPECT_EQ(found.bound, bound);
      EXPECT_EQ(distance(list[static_cast<std::size_t>(found.instance)], p)->bound, bound);
      EXPECT_NEAR(closestPoint(list, p, kFarAway, given)->distance, closest, 0.02f);
      EXPECT_NEAR(sphereCast(list, p, q, radius, given)->t, t, 1e-5f);
      EXPECT_EQ(*overlaps(list, Sphere{p, radius}, given), first);
    }
  }
  EXPECT_EQ(distance(std::span<const Instance>(), glm::vec3(0))->part, std::nullopt);
}

// Codes that lie, as far as the reader lets them: answers mean nothing, but they come.
TEST_F(ShapeQuery, LyingDistancesHangNothing) {
  std::mt19937 random(9);
  int loaded_packs = 0;
  for (int pack_number = 0; pack_number < 6; ++pack_number) {
    RawPack pack = test::distancePackOf(volume);
    for (RawDistances& level : pack.parts[0].distances) {
      for (std::uint32_t& cell : level.cells) {
        if (!(cell & kCellSolid) && random() % 2 == 0) cell = random() % 2 == 0 ? kFarInside : kFarOutside;
      }
      for (std::size_t i = 0; i < level.codes.size(); ++i) {
        const bool lies = pack_number % 2 == 0 && random() % 3 == 0;
        if (lies && level.codes[i] > 1 && !isInside(level.codes[i])) level.codes[i] = 1;
      }
    }
    std::vector<std::byte> lying;
    const Sink sink = Sink::into(lying);
    if (!writePack(pack, sink)) continue;
    MemorySource lying_source(lying);
    AssetOptions options;
    options.distance_level = 0;
    const auto loaded = Asset::open(lying_source.source(), options).value();
    if (!loaded->loadAll()) continue;
    ++loaded_packs;
    for (int n = 0; n < test::shareOf(3); ++n) {
      const std::size_t figure = std::array{0u, 4u, 6u}[static_cast<std::size_t>(pack_number + n) % 3];
      test::BentInstance bent(*loaded, layers, test::figureKnots(test::kFigure6[figure]), glm::mat4(1), 3);
      for (int i = 0; i < test::shareOf(20); ++i) {
        const glm::vec3 p = bent.anywhere(), q = bent.anywhere();
        const Result<Distance> found = distance(bent.instance, p);
        ASSERT_TRUE(found && !std::isnan(found->bound));
        EXPECT_TRUE(closestPoint(bent.instance, p));
        EXPECT_TRUE(overlaps(bent.instance, Sphere{p, 0.1f}));
        EXPECT_TRUE(overlaps(bent.instance, OrientedBox{p, glm::vec3(0.1f)}));
        EXPECT_TRUE(sphereCast(bent.instance, p, q, 0.05f));
      }
    }
  }
  EXPECT_GT(loaded_packs, 4);
}

}  // namespace
}  // namespace kelp::runtime
