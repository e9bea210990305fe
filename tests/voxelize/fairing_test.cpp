// SPDX-License-Identifier: MIT
// Caps that are bent as thin plates, against closed forms: a plate without load is biharmonic.
#include "fairing.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <numbers>
#include <vector>

#include "plain_patch.h"

namespace kelp::bake {
namespace {

constexpr double kRadius = 10;
constexpr int kCorners = 60;

using Height = std::function<double(double x, double y)>;

struct Plate {
  Patch patch;
  std::vector<glm::dvec3> beyond;
};

// A disc whose rim, and the points a step beyond it, lie on the surface z = height(x, y). The points within
// start in the plane.
Plate clampedTo(const Height& height) {
  std::vector<glm::dvec3> rim;
  Plate plate;
  const double step = 2 * std::numbers::pi * kRadius / kCorners;
  for (int i = 0; i < kCorners; ++i) {
    const double angle = 2 * std::numbers::pi * i / kCorners, c = std::cos(angle), s = std::sin(angle);
    rim.emplace_back(kRadius * c, kRadius * s, 0);
    const double x = (kRadius + step) * c, y = (kRadius + step) * s;
    plate.beyond.emplace_back(x, y, height(x, y));
  }
  plate.patch = spanPolygon(rim);
  for (int i = 0; i < kCorners; ++i) {
    OpenMesh::Vec3d& p = plate.patch.mesh.point(OpenMesh::VertexHandle(i));
    p[2] = height(p[0], p[1]);
  }
  return plate;
}

// The largest distance in z between the points of a faired patch and a surface.
double farthest(const Patch& patch, const Height& height) {
  double most = 0;
  for (const glm::dvec3& p : PlainPatch(patch).points)
    most = std::max(most, std::abs(p.z - height(p.x, p.y)));
  return most;
}

// Each of these is biharmonic, so a plate that is clamped along it takes its shape.
TEST(Fairing, APlateClampedAlongABiharmonicSurfaceTakesItsShape) {
  const struct {
    const char* name;
    Height height;
  } surfaces[] = {
      {"plane", [](double x, double y) { return 0.3 * x - 0.2 * y + 5; }},
      // Without load, clamped at the slope s: w = s (r^2 - R^2) / (2 R). The middle sinks by s R / 2.
      {"bowl", [](double x, double y) { return 0.1 * (x * x + y * y - kRadius * kRadius) / (2 * kRadius); }},
      {"saddle", [](double x, double y) { return 0.005 * (x * x - y * y); }},
      {"monkey saddle", [](double x, double y) { return 0.0005 * (x * x * x - 3 * x * y * y); }},
  };
  for (const auto& surface : surfaces) {
    Plate plate = clampedTo(surface.height);
    ASSERT_GT(plate.patch.mesh.n_vertices(), 150u);
    fairPatch(plate.patch, plate.beyond);
    double range = 0;
    for (const glm::dvec3& p : PlainPatch(plate.patch).points)
      range = std::max(range, std::abs(surface.height(p.x, p.y) - surface.height(0, 0)));
    EXPECT_LT(farthest(plate.patch, surface.height), 0.05 * range) << surface.name;
  }
}

// What a flat disc already is, it stays: in the plane to rounding.
TEST(Fairing, AFlatRimKeepsThePlateInItsPlane) {
  Plate plate = clampedTo([](double, double) { return 0.0; });
  fairPatch(plate.patch, plate.beyond);
  EXPECT_LT(farthest(plate.patch, [](double, double) { return 0.0; }), 1e-9);
}

TEST(Fairing, OnlyPointsWithinMove) {
  Plate plate = clampedTo([](double x, double y) { return 0.02 * x * y; });
  const PlainPatch before(plate.patch);
  fairPatch(plate.patch, plate.beyond);
  const PlainPatch after(plate.patch);
  ASSERT_EQ(after.points.size(), before.points.size());
  EXPECT_EQ(after.triangles, before.triangles);
  for (std::uint32_t i = 0; i < before.rim; ++i) EXPECT_EQ(after.points[i], before.points[i]);
}

// The plate does not know where it is, which way it is turned and how large it is.
TEST(Fairing, MovesTurnsAndScalesWithItsRim) {
  Plate plate = clampedTo([](double x, double y) { return 0.01 * x * x + 0.1 * y; });
  const glm::dvec3 u = glm::normalize(glm::dvec3(1, 2, -3)),
                   v = glm::normalize(glm::cross(u, glm::dvec3(0, 1, 1)));
  const glm::dmat3 turn = 3.0 * glm::dmat3(u, v, glm::cross(u, v));
  const auto moved = [&](const glm::dvec3& p) { return turn * p + glm::dvec3(100, -70, 40); };
  Plate other = plate;
  for (const OpenMesh::VertexHandle v : other.patch.mesh.vertices())
    other.patch.mesh.set_point(v, toPoint(moved(pointOf(other.patch.mesh, v))));
  for (glm::dvec3& p : other.beyond) p = moved(p);
  fairPatch(plate.patch, plate.beyond);
  fairPatch(other.patch, other.beyond);
  for (const OpenMesh::VertexHandle v : plate.patch.mesh.vertices())
    EXPECT_LT(glm::distance(moved(pointOf(plate.patch.mesh, v)), pointOf(other.patch.mesh, v)), 1e-6);
}

// The linear system is solved: of all shapes near it the faired one has the least energy. The energy is the
// sum of the squared cotangent Laplacians, each over its point's area, computed here edge by edge.
TEST(Fairing, NoMoveOfASinglePointLowersTheEnergy) {
  Plate plate = clampedTo([](double x, double y) { return 0.004 * (x * x + x * y) + 0.002 * y * y; });
  fairPatch(plate.patch, plate.beyond);
  fairPatch(plate.patch, plate.beyond);  // on to where the weights do not change any more
  PlainPatch plain(plate.patch);
  auto& points = plain.points;
  auto& triangles = plain.triangles;
  const std::uint32_t rim = plain.rim;
  const std::uint32_t first = static_cast<std::uint32_t>(points.size());
  points.insert(points.end(), plate.beyond.begin(), plate.beyond.end());
  for (std::uint32_t i = 0; i < rim; ++i) {
    const std::uint32_t next = (i + 1) % rim;
    triangles.push_back({next, i, first + i});
    triangles.push_back({next, first + i, first + next});
  }
  // Weights of the shape as it came out: they stay while a point is moved.
  std::vector<std::array<double, 3>> cotangent(triangles.size());
  std::vector<double> area(points.size(), 0);
  for (std::size_t t = 0; t < triangles.size(); ++t) {
    for (std::size_t k = 0; k < 3; ++k) {
      const glm::dvec3 p = points[triangles[t][k]], a = points[triangles[t][(k + 1) % 3]] - p,
                       b = points[triangles[t][(k + 2) % 3]] - p;
      const double angle = std::acos(glm::dot(a, b) / (glm::length(a) * glm::length(b)));
      cotangent[t][k] = 1 / std::tan(angle);
      area[triangles[t][k]] += glm::length(glm::cross(a, b)) / 6;
    }
  }
  const auto energy = [&] {
    std::vector<glm::dvec3> laplacian(points.size(), glm::dvec3(0));
    for (std::size_t t = 0; t < triangles.size(); ++t) {
      for (std::size_t k = 0; k < 3; ++k) {
        const std::uint32_t a = triangles[t][(k + 1) % 3], b = triangles[t][(k + 2) % 3];
        laplacian[a] += 0.5 * cotangent[t][k] * (points[b] - points[a]);
        laplacian[b] += 0.5 * cotangent[t][k] * (points[a] - points[b]);
      }
    }
    double sum = 0;
    for (std::uint32_t i = 0; i < first; ++i) sum += glm::dot(laplacian[i], laplacian[i]) / area[i];
    return sum;
  };
  const double least = energy();
  for (std::uint32_t i = rim; i < first; i += 7) {
    for (int axis = 0; axis < 3; ++axis) {
      for (const double by : {-0.05, 0.05}) {
        points[i][axis] += by;
        EXPECT_GT(energy(), least) << "point " << i << " along " << axis;
        points[i][axis] -= by;
      }
    }
  }
}

}  // namespace
}  // namespace kelp::bake
