// SPDX-License-Identifier: MIT
// What must not change the fill of a real body: how its triangles are wound, what overlaps it, what is hidden
// within.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdio>
#include <ostream>
#include <random>
#include <string>
#include <vector>

#include "kelp/bake/bake.h"
#include "support/assets.h"

namespace kelp {
namespace {

using Voxels = std::vector<std::uint8_t>;

struct BodyFile {
  const char* name;
  const char* path;
};

void PrintTo(const BodyFile& file, std::ostream* out) { *out << file.path; }

class FillLaws : public testing::TestWithParam<BodyFile> {
 protected:
  static constexpr int kResolution = 64;

  void SetUp() override {
    KELP_ASSET(path, GetParam().path);
    model_ = bake::importFile(path, {});
    body_ = model_.parts[0].soup;
    body_.uvs.clear();
    body_.colors.clear();
    low_ = glm::vec3(1e30f);
    high_ = glm::vec3(-1e30f);
    for (const auto& triangle : body_.triangles) {
      for (const std::uint32_t v : triangle.vertex) {
        low_ = glm::min(low_, body_.positions[v]);
        high_ = glm::max(high_, body_.positions[v]);
      }
    }
    const glm::vec3 extent = high_ - low_;
    voxel_ = std::max({extent.x, extent.y, extent.z}) / kResolution;
  }

  // In the frame of `box`, whatever `soup` covers.
  Voxels fill(const bake::TriangleSoup& soup, const bake::TriangleSoup& box) {
    model_.parts[0].soup = soup;
    const bake::Frame frame = bake::makeFrame(box, Axis::kPlusY, static_cast<double>(voxel_), "test");
    return bake::voxelize(model_, model_.parts[0], frame, bake::Fill::kAuto, 2, {}).grid.solid;
  }

  bake::SourceModel model_;
  bake::TriangleSoup body_;
  glm::vec3 low_{0}, high_{0};
  float voxel_ = 1;
};

bake::TriangleSoup joined(bake::TriangleSoup a, const bake::TriangleSoup& b) {
  const auto first = static_cast<std::uint32_t>(a.positions.size());
  a.positions.insert(a.positions.end(), b.positions.begin(), b.positions.end());
  for (bake::TriangleSoup::Triangle triangle : b.triangles) {
    for (std::uint32_t& v : triangle.vertex) v += first;
    a.triangles.push_back(triangle);
  }
  return a;
}

void turn(bake::TriangleSoup::Triangle& triangle) { std::swap(triangle.vertex[0], triangle.vertex[1]); }

TEST_P(FillLaws, WindingsDoNotMatter) {
  const Voxels plain = fill(body_, body_);
  ASSERT_GT(std::count(plain.begin(), plain.end(), 1), 10000);
  bake::TriangleSoup turned = body_;
  for (auto& triangle : turned.triangles) turn(triangle);
  EXPECT_EQ(fill(turned, body_), plain) << "all turned";
  std::mt19937 random(1);
  turned = body_;
  for (auto& triangle : turned.triangles) {
    if (random() % 2 == 0) turn(triangle);
  }
  EXPECT_EQ(fill(turned, body_), plain) << "a random half turned";
}

TEST_P(FillLaws, ACopyThatOverlapsMakesTheUnion) {
  bake::TriangleSoup copy = body_;
  for (glm::vec3& p : copy.positions) p += (high_ - low_) * glm::vec3(0.06f, 0.09f, 0.11f);
  const bake::TriangleSoup both = joined(body_, copy);
  const Voxels a = fill(body_, both), b = fill(copy, both), together = fill(both, both);
  // Not one by one: where two bodies touch, a gap between them that is thinner than a voxel may close or not;
  // and a body on its own is given its volume to half a percent.
  std::size_t sum = 0, differ = 0, shared = 0;
  for (std::size_t i = 0; i < together.size(); ++i) {
    const bool either = a[i] || b[i];
    sum += either;
    shared += a[i] && b[i];
    differ += (together[i] != 0) != either;
  }
  std::printf("%s: %zu voxels, %zu in both, %zu differ\n", GetParam().name, sum, shared, differ);
  EXPECT_GT(shared, sum / 5) << "they hardly overlap";
  EXPECT_LE(differ, sum / 200);
}

TEST_P(FillLaws, AShellWithinIsNotSeen) {
  const Voxels plain = fill(body_, body_);
  // A ball in the middle of the deepest of the solid, by the distance to what is empty along the axes.
  const bake::Frame frame = bake::makeFrame(body_, Axis::kPlusY, static_cast<double>(voxel_), "test");
  const glm::ivec3 size = frame.size;
  const auto solid = [&](const glm::ivec3& v) {
    return glm::all(glm::greaterThanEqual(v, glm::ivec3(0))) && glm::all(glm::lessThan(v, size)) &&
           plain[static_cast<std::size_t>(v.x + size.x * (v.y + size.y * v.z))] != 0;
  };
  glm::ivec3 place(0);
  int reach = 0;
  for (int i = 0; i < size.x * size.y * size.z; ++i) {
    const glm::ivec3 v(i % size.x, i / size.x % size.y, i / (size.x * size.y));
    const auto clear = [&](int r) {
      for (int corner = 0; corner < 27; ++corner) {
        if (!solid(v + r * glm::ivec3(corner % 3 - 1, corner / 3 % 3 - 1, corner / 9 - 1))) return false;
      }
      return true;
    };
    while (clear(reach + 1)) place = v, ++reach;
  }
  ASSERT_GE(reach, 3);
  // An octahedron.
  const glm::dvec3 centre(glm::inverse(frame.node_to_voxel) * glm::dvec4(glm::dvec3(place) + 0.5, 1.0));
  for (const bool inward : {false, true}) {
    bake::TriangleSoup shell;
    for (int k = 0; k < 6; ++k) {
      glm::vec3 p(centre);
      p[k / 2] += static_cast<float>(k % 2 ? -reach : reach) * voxel_;
      shell.positions.push_back(p);
    }
    for (std::uint32_t k = 0; k < 8; ++k) {
      bake::TriangleSoup::Triangle triangle = body_.triangles[0];
      triangle.vertex = {k & 1, 2 + (k >> 1 & 1), 4 + (k >> 2 & 1)};
      const bool backward = ((k & 1) + (k >> 1 & 1) + (k >> 2 & 1)) % 2 == 1;
      if (backward != inward) turn(triangle);
      shell.triangles.push_back(triangle);
    }
    EXPECT_EQ(fill(joined(body_, shell), body_), plain) << (inward ? "wound inward" : "wound outward");
  }
}

INSTANTIATE_TEST_SUITE_P(Closed, FillLaws,
                         testing::Values(BodyFile{"spot", "mesh/common3d/spot.obj"},
                                         BodyFile{"armadillo", "mesh/converted/armadillo.obj"}),
                         [](const auto& file) { return std::string(file.param.name); });

}  // namespace
}  // namespace kelp
