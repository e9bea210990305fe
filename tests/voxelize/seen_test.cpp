// SPDX-License-Identifier: MIT
// A baked model as it is seen along the axes, against the triangles that are seen there: a voxel shows a
// surface that lies open, not one that is hidden behind it, and the side of it that is turned towards who
// looks.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>
#include <ostream>
#include <vector>

#include "shapes.h"
#include "support/all_tests.h"
#include "support/assets.h"
#include "truth.h"

namespace kelp {
namespace {

constexpr std::size_t kNone = std::numeric_limits<std::size_t>::max();

// The first triangle on each line through the voxels' middles along an axis, towards its beginning (sign 1:
// looked at from its end) or its end (-1).
struct View {
  int axis, sign;
  // coordinate along the axis; of columns u + size[u] v, with u and v the axes after this one
  std::vector<double> depth;
  std::vector<std::size_t> triangle;
};

View viewOf(const test::MeshTruth& mesh, const glm::ivec3& size, int axis, int sign) {
  const int u = (axis + 1) % 3, v = (axis + 2) % 3;
  const std::size_t columns = static_cast<std::size_t>(size[u]) * static_cast<std::size_t>(size[v]);
  View view{axis, sign, std::vector<double>(columns, -sign * 1e30), std::vector<std::size_t>(columns, kNone)};
  for (std::size_t t = 0; t < mesh.triangles(); ++t) {
    const glm::dvec3 &a = mesh.corners(t)[0], &b = mesh.corners(t)[1], &c = mesh.corners(t)[2];
    const double area = (b[u] - a[u]) * (c[v] - a[v]) - (b[v] - a[v]) * (c[u] - a[u]);
    if (std::abs(area) < 1e-9) continue;
    const auto range = [&](int k) {
      return std::pair(std::max(0, static_cast<int>(std::floor(std::min({a[k], b[k], c[k]})))),
                       std::min(size[k] - 1, static_cast<int>(std::floor(std::max({a[k], b[k], c[k]})))));
    };
    const auto [left, right] = range(u);
    const auto [bottom, top] = range(v);
    for (int y = bottom; y <= top; ++y) {
      for (int x = left; x <= right; ++x) {
        const double p = x + 0.5, q = y + 0.5;
        const double beta = ((p - a[u]) * (c[v] - a[v]) - (q - a[v]) * (c[u] - a[u])) / area;
        const double gamma = ((b[u] - a[u]) * (q - a[v]) - (b[v] - a[v]) * (p - a[u])) / area;
        if (beta < 0 || gamma < 0 || beta + gamma > 1) continue;
        const double depth = a[axis] + beta * (b[axis] - a[axis]) + gamma * (c[axis] - a[axis]);
        const std::size_t column =
            static_cast<std::size_t>(x) + static_cast<std::size_t>(size[u]) * static_cast<std::size_t>(y);
        if ((depth - view.depth[column]) * sign <= 1e-9) continue;
        view.depth[column] = depth;
        view.triangle[column] = t;
      }
    }
  }
  return view;
}

// How many voxels are seen, and of how many that is wrong wherever they are: a voxel of a plate may be right
// from one side alone.
struct Seen {
  std::size_t voxels = 0;
  std::size_t away = 0;      // their normal looks away
  std::size_t material = 0;  // they have another's material
};

Seen compare(const bake::TriangleSoup& soup, const test::MeshTruth& mesh, const bake::VoxelGrid& grid) {
  const glm::ivec3 size = grid.size;
  const auto indexOf = [&](const glm::ivec3& v) {
    return static_cast<std::size_t>(v.x) +
           static_cast<std::size_t>(size.x) *
               (static_cast<std::size_t>(v.y) +
                static_cast<std::size_t>(size.y) * static_cast<std::size_t>(v.z));
  };
  std::vector<std::size_t> sample_at(grid.solid.size(), kNone);
  for (std::size_t i = 0; i < grid.surface.size(); ++i) sample_at[grid.surface[i].index] = i;
  std::vector<Seen> votes(grid.surface.size());  // `voxels`: looks at it that are right
  for (int face = 0; face < 6; ++face) {
    const int axis = face / 2, sign = face % 2 ? 1 : -1, u = (axis + 1) % 3, v = (axis + 2) % 3;
    const View view = viewOf(mesh, size, axis, sign);
    for (std::size_t column = 0; column < view.triangle.size(); ++column) {
      if (view.triangle[column] == kNone) continue;
      glm::ivec3 voxel;
      voxel[u] = static_cast<int>(column % static_cast<std::size_t>(size[u]));
      voxel[v] = static_cast<int>(column / static_cast<std::size_t>(size[u]));
      voxel[axis] = sign > 0 ? size[axis] - 1 : 0;
      while (voxel[axis] >= 0 && voxel[axis] < size[axis] && !grid.solid[indexOf(voxel)]) voxel[axis] -= sign;
      // the line passes beside what the voxel stands for
      if (voxel[axis] < 0 || voxel[axis] >= size[axis] ||
          std::abs(voxel[axis] + 0.5 - view.depth[column]) > 1)
        continue;
      const auto& [a, b, c] = mesh.corners(view.triangle[column]);
      const glm::dvec3 across = glm::normalize(glm::cross(b - a, c - a));
      if (std::abs(across[axis]) < 0.3) continue;  // a grazing look
      const bake::SurfaceSample& sample = grid.surface[sample_at[indexOf(voxel)]];
      Seen& vote = votes[sample_at[indexOf(voxel)]];
      if (glm::dot(glm::dvec3(sample.normal), across) * across[axis] * sign < 0) {
        ++vote.away;
      } else if (sample.source != soup.triangles[view.triangle[column]].material) {
        ++vote.material;
      } else {
        ++vote.voxels;
      }
    }
  }
  Seen seen;
  for (const Seen& vote : votes) {
    seen.voxels += vote.voxels + vote.away + vote.material > 0;
    if (vote.voxels > 0) continue;
    (vote.away > 0 ? seen.away : seen.material) += vote.away + vote.material > 0;
  }
  return seen;
}

// A house: red walls, a thin yellow roof over them that slants by `slope`, on green ground; `turn` swaps the
// axes around.
TEST(Seen, AHouseShowsItsRoofAndNotTheWallsBeneath) {
  for (const float slope : {0.3f, 0.55f, 0.8f, 1.3f}) {
    for (int turn = 0; turn < (test::kSanitized ? 1 : 3); ++turn) {
      bake::TriangleSoup soup;
      const auto paint = [&](std::uint32_t material) {
        for (auto& triangle : soup.triangles) {
          if (triangle.material == 0) triangle.material = material;
        }
      };
      test::addBox(soup, {-40, -3, -40}, {40, 0, 40});
      paint(3);
      test::addBox(soup, {-20, 0, -14}, {20, 12, 14});
      paint(1);
      for (const float side : {-1.0f, 1.0f}) {
        const std::size_t first = soup.positions.size();
        test::addBox(soup, {-24, 0, side < 0 ? -18.0f : 0.0f}, {24, 0.6f, side < 0 ? 0.0f : 18.0f});
        for (std::size_t i = first; i < soup.positions.size(); ++i)
          soup.positions[i].y += 12.1f + slope * (14 - std::abs(soup.positions[i].z));
      }
      paint(2);
      for (glm::vec3& p : soup.positions) p = {p[turn], p[(turn + 1) % 3], p[(turn + 2) % 3]};
      bake::SourceModel model = test::makeModel(soup);
      model.materials.assign(4, {});
      const test::Baked baked = test::voxelizeUnit(model);
      const Seen seen = compare(soup, test::MeshTruth(soup, baked.frame), baked.grid());
      std::printf("slope %g, turn %d: %zu voxels seen, %zu look away, %zu of another material\n",
                  static_cast<double>(slope), turn, seen.voxels, seen.away, seen.material);
      EXPECT_GT(seen.voxels, 5000u);
      EXPECT_EQ(seen.material, 0u);
      // The steepest roof's eaves are seen from both sides: the upper one is shown, and which that is is
      // known of y alone.
      EXPECT_LE(seen.away, turn == 0 ? 0 : seen.voxels * 3 / 100);
    }
  }
}

struct SeenFile {
  const char* name;
  const char* path;
  double away, material;  // at most, of the voxels seen
};

void PrintTo(const SeenFile& file, std::ostream* out) { *out << file.path; }

class SeenFiles : public testing::TestWithParam<SeenFile> {};

TEST_P(SeenFiles, ShowWhatLiesOpen) {
  KELP_ASSET(path, GetParam().path);
  const bake::SourceModel model = bake::importFile(path, {});
  const bake::TriangleSoup& soup = model.parts[0].soup;
  const bake::Frame frame = test::frameOf(soup, 96);
  const bake::VoxelizeResult baked = bake::voxelize(model, model.parts[0], frame, bake::Fill::kAuto, 2, {});
  const Seen seen = compare(soup, test::MeshTruth(soup, frame), baked.grid);
  const double voxels = static_cast<double>(seen.voxels);
  std::printf("%s: %zu voxels seen, %.2f %% look away, %.2f %% of another material\n", GetParam().name,
              seen.voxels, 100 * static_cast<double>(seen.away) / voxels,
              100 * static_cast<double>(seen.material) / voxels);
  EXPECT_GT(seen.voxels, 800u);
  EXPECT_LE(static_cast<double>(seen.away), GetParam().away * voxels);
  EXPECT_LE(static_cast<double>(seen.material), GetParam().material * voxels);
}

INSTANTIATE_TEST_SUITE_P(At96, SeenFiles,
                         testing::Values(SeenFile{"house", "mesh/assimp/OBJ/regr01.obj", 0.065, 0.002},
                                         SeenFile{"engine", "gltf/assimp/2CylinderEngine.glb", 0.075, 0.013},
                                         SeenFile{"spider", "mesh/assimp/OBJ/spider.obj", 0.004, 0.002},
                                         SeenFile{"truck",
                                                  "gltf/draco_testdata/CesiumMilkTruck/CesiumMilkTruck.gltf",
                                                  0.003, 0.008},
                                         SeenFile{"barrel", "gltf/plants/barrel.glb", 0.014, 0.018},
                                         SeenFile{"coral", "gltf/aquarium/coral.glb", 0.05, 0},
                                         SeenFile{"bunny", "mesh/common3d/stanford-bunny.obj", 0.0005, 0},
                                         SeenFile{"armadillo", "mesh/converted/armadillo.obj", 0.0015, 0}),
                         [](const auto& file) { return std::string(file.param.name); });

}  // namespace
}  // namespace kelp
