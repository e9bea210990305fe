// SPDX-License-Identifier: MIT
// A proxy whose vertices were moved by the runtime lies where the runtime's rays hit the bent voxels.
#include <limits>
#include <random>

#include "kelp/runtime/instance.h"
#include "proxy_files.h"
#include "support/voxel_points.h"

namespace kelp {
namespace {

using glm::dvec3;

constexpr int kHeight = 80;  // voxels
constexpr double kError = 1.5;

// The distance from a point to the nearest triangle, and the triangles that a ray hits.
struct BentMesh {
  std::vector<std::array<dvec3, 3>> triangles;

  double distance(const dvec3& p) const {
    double least = std::numeric_limits<double>::infinity();
    for (const auto& [a, b, c] : triangles) least = std::min(least, test::squaredTo(p, a, b, c));
    return std::sqrt(least);
  }
  // Calls f(point) for every point where the line through `origin` meets the mesh.
  template <class F>
  void eachHit(const dvec3& origin, const dvec3& direction, F&& f) const {
    for (const auto& [a, b, c] : triangles) {
      const dvec3 normal = glm::cross(b - a, c - a);
      const double slope = glm::dot(direction, normal);
      if (slope == 0) continue;
      const dvec3 p = origin + direction * (glm::dot(a - origin, normal) / slope);
      if (glm::dot(glm::cross(b - a, p - a), normal) >= 0 &&
          glm::dot(glm::cross(c - b, p - b), normal) >= 0 && glm::dot(glm::cross(a - c, p - c), normal) >= 0)
        f(p);
    }
  }
};

BentMesh bent(const test::Mesh& mesh, const runtime::Instance& instance) {
  BentMesh out;
  for (const auto& t : mesh.triangles) {
    auto& triangle = out.triangles.emplace_back();
    for (std::size_t i = 0; i < 3; ++i)
      triangle[i] = toWorld(instance, 0, mesh.points[static_cast<std::size_t>(t[i])]).value();
  }
  return out;
}

// How far flat triangles leave the bent surface of the proxy: at the middles of their sides and their own.
double flatness(const test::Mesh& mesh, const BentMesh& bent, const runtime::Instance& instance) {
  double most = 0;
  for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
    const auto at = [&](const dvec3& weights) {
      dvec3 rest(0), flat(0);
      for (int k = 0; k < 3; ++k) {
        rest += weights[k] *
                dvec3(mesh.points[static_cast<std::size_t>(mesh.triangles[i][static_cast<std::size_t>(k)])]);
        flat += weights[k] * bent.triangles[i][static_cast<std::size_t>(k)];
      }
      most = std::max(most, glm::distance(flat, dvec3(toWorld(instance, 0, glm::vec3(rest)).value())));
    };
    at(dvec3(0.5, 0.5, 0));
    at(dvec3(0, 0.5, 0.5));
    at(dvec3(0.5, 0, 0.5));
    at(dvec3(1.0 / 3));
  }
  return most;
}

// By how much lengths grow at most beside a point at rest, by differences along many directions.
double stretch(const runtime::Instance& instance, const glm::vec3& rest) {
  constexpr float kStep = 0.5f / kHeight;
  double most = 1;
  for (int i = 0; i < 27; ++i) {
    const glm::vec3 direction(i % 3 - 1, i / 3 % 3 - 1, i / 9 - 1);
    if (i == 13) continue;
    const glm::vec3 step = kStep * glm::normalize(direction);
    const glm::vec3 a = toWorld(instance, 0, rest - step).value(),
                    b = toWorld(instance, 0, rest + step).value();
    most = std::max(most, double{glm::distance(a, b)} / (2 * kStep));
  }
  return most;
}

// Whether a face between a solid and an empty voxel is nearer than `most`.
bool nearAFace(const fields::Occupancy& volume, const glm::vec3& p, double most) {
  const auto solid = [&](const glm::ivec3& v) {
    return v == glm::clamp(v, glm::ivec3(0), volume.size - 1) && volume.solid[volume.index(v)] != 0;
  };
  const int reach = static_cast<int>(std::ceil(most));
  const glm::ivec3 cell(glm::floor(p));
  for (int z = -reach; z <= reach; ++z)
    for (int y = -reach; y <= reach; ++y)
      for (int x = -reach; x <= reach; ++x)
        for (int axis = 0; axis < 3; ++axis) {
          const glm::ivec3 v = cell + glm::ivec3(x, y, z);
          glm::ivec3 before = v;
          --before[axis];
          if (solid(v) == solid(before)) continue;
          dvec3 high(v + 1);
          high[axis] = v[axis];
          if (glm::distance(dvec3(p), glm::clamp(dvec3(p), dvec3(v), high)) <= most) return true;
        }
  return false;
}

// In units of the part's height.
const std::vector<Knot> kPoses[] = {
    {{0, {0, 0, 0}, {0, 1, 0}}, {1, {0, 1, 0}, {0, 1, 0}}},
    {{0, {0, 0, 0}, {0, 1, 0}}, {1, {0.4f, 0.85f, 0}, {0.8f, 0.7f, 0.1f}}},
    {{0, {0, 0, 0}, {0.3f, 1, -0.2f}}, {1, {-0.3f, 0.8f, 0.4f}, {-0.6f, 0.8f, 0.5f}}},
    {{0, {0, 0, 0}, {0, 1.2f, 0}}, {1, {0.1f, 1.3f, 0}, {0.3f, 1.3f, 0.2f}}},
    {{0, {0, 0, 0}, {0.5f, 1, 0}}, {1, {0, 1, 0}, {0.5f, 1, 0}}},
};

TEST(BentProxy, LiesWhereRaysHit) {
  if (test::dump({"--version"}).out.find("proxy") == std::string::npos)
    GTEST_SKIP() << "this kelp-dump was built without OpenMesh";
  const test::Scratch folder;
  const fields::Occupancy volume = test::ballClump({50, kHeight, 50}, 60, 2);
  const std::vector<std::byte> bytes = test::bytesOf(test::packOf(volume));
  const std::string pack = folder.write("clump.kelp", std::span<const std::byte>(bytes));
  const test::ProcessResult result = test::dump({"extract", pack, "--proxy", folder / "clump.obj"});
  ASSERT_EQ(result.exit, 0) << result.err;
  const test::Mesh mesh = test::readMesh(folder / "clump.obj");

  MemorySource source(bytes);
  const auto asset = runtime::Asset::open(source.source()).value();
  ASSERT_TRUE(asset->loadAll());
  runtime::Pose pose = runtime::Pose::create(*asset).value();
  std::mt19937 random(7);
  std::uniform_real_distribution<float> unit(0, 1);
  // Compilers evaluate arguments in different orders.
  const auto draw = [&] {
    glm::vec3 v;
    for (int axis = 0; axis < 3; ++axis) v[axis] = unit(random);
    return v;
  };
  double moved = 0;
  for (const std::vector<Knot>& knots : kPoses) {
    const std::ptrdiff_t number = &knots - kPoses;
    ASSERT_TRUE(pose.setKnots(0, knots));
    runtime::Instance instance{asset.get(), &pose};
    instance.to_world = glm::mat4(glm::vec4(0, 0, 1, 0), glm::vec4(0, 1, 0, 0), glm::vec4(-1, 0, 0, 0),
                                  glm::vec4(3, -2, 1, 1));
    const BentMesh proxy = bent(mesh, instance);
    const double flat = flatness(mesh, proxy, instance);
    EXPECT_LT(flat * kHeight, 1) << "pose " << number;
    int hits = 0, points = 0;
    for (int i = 0; i < 400; ++i) {
      const glm::vec3 from = test::voxelToWorld(instance, 0, glm::vec3(50, kHeight, 50) * draw());
      const glm::vec3 direction = draw() - 0.5f;
      const runtime::Ray ray{from - 9.0f * direction, direction};
      if (const auto hit = raycast(instance, ray)) {
        ++hits;
        const double most = flat + (kError + 1) * stretch(instance, hit->rest) / kHeight;
        EXPECT_LE(proxy.distance(hit->position), most) << "pose " << number;
        moved = std::max(
            moved, glm::distance(dvec3(hit->position), dvec3(instance.to_world * glm::vec4(hit->rest, 1))));
      }
      proxy.eachHit(ray.origin, ray.direction, [&](const dvec3& p) {
        const auto rest = toRest(instance, 0, p);
        if (!rest) return;  // beyond the spline's end
        ++points;
        EXPECT_TRUE(nearAFace(volume, test::restToVoxel(instance, 0, *rest), flat * kHeight + kError + 1))
            << "pose " << number;
      });
    }
    EXPECT_GT(hits, 100);
    EXPECT_GT(points, 100);
  }
  EXPECT_GT(moved * kHeight, 20);  // voxels: far more than the error
}

}  // namespace
}  // namespace kelp
