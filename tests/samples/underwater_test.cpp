// SPDX-License-Identifier: MIT
// What moves in the underwater scene, without a window: paths, bodies on paths, the current, and where things
// stand.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "arguments.h"
#include "camera.h"
#include "current.h"
#include "floor_mesh.h"
#include "path.h"
#include "random.h"
#include "scatter.h"
#include "swimmer.h"
#include "terrain.h"

namespace underwater {
namespace {

constexpr float kPi = std::numbers::pi_v<float>;

std::vector<glm::vec3> circle(float radius, int points) {
  std::vector<glm::vec3> all;
  for (int i = 0; i < points; ++i) {  // to the right, seen from above: x east, z south
    const float angle = 2 * kPi * static_cast<float>(i) / static_cast<float>(points);
    all.push_back({radius * std::cos(angle), 1, radius * std::sin(angle)});
  }
  return all;
}

std::vector<glm::vec3> knot() {
  return {{3, 1, 0}, {0.5f, 1.6f, 1}, {-2, 0.8f, 2.5f}, {-3.5f, 1.2f, -1}, {0, 2, -0.5f}, {2, 1.1f, -3}};
}

// Catmull and Rom's basis as they published it, in double.
glm::dvec3 catmullRom(const std::vector<glm::vec3>& points, double u) {
  const auto n = points.size();
  const auto i = static_cast<std::size_t>(u) % n;
  const double t = u - std::floor(u);
  const glm::dvec3 a(points[(i + n - 1) % n]), b(points[i]), c(points[(i + 1) % n]), d(points[(i + 2) % n]);
  return 0.5 * (2.0 * b + t * (c - a) + t * t * (2.0 * a - 5.0 * b + 4.0 * c - d) +
                t * t * t * (3.0 * b - a - 3.0 * c + d));
}

TEST(Path, IsAsLongAsItsChordsAndWalkedAtOneSpeed) {
  const std::vector<glm::vec3> points = knot();
  const ClosedPath path(points);
  constexpr int kSteps = 120000;
  double length = 0;
  float worst = 0;
  glm::dvec3 before = catmullRom(points, 0);
  for (int i = 1; i <= kSteps; ++i) {
    const glm::dvec3 at = catmullRom(points, static_cast<double>(points.size()) * i / kSteps);
    length += glm::length(at - before);
    before = at;
    if (i % 500 == 0)
      worst = std::max(worst, glm::distance(path.at(static_cast<float>(length)), glm::vec3(at)));
  }
  EXPECT_NEAR(path.length(), length, 1e-4 * length);
  EXPECT_LT(worst, 2e-3f);  // metres: the place after s metres is the place after s metres of chords
}

TEST(Path, ClosesWithoutACorner) {
  const ClosedPath path(knot());
  EXPECT_LT(glm::distance(path.at(0), path.at(path.length())), 1e-4f);
  EXPECT_LT(glm::distance(path.at(-0.7f), path.at(5 * path.length() - 0.7f)), 1e-3f);
  glm::vec3 before = path.direction(-0.001f);
  for (float s = 0; s < path.length(); s += 0.01f) {
    const glm::vec3 now = path.direction(s);
    EXPECT_NEAR(glm::length(now), 1, 1e-5f);
    EXPECT_GT(glm::dot(before, now), 0.98f) << s;
    before = now;
  }
}

TEST(Path, TurnsAsACircleDoes) {
  for (const float radius : {1.5f, 4.0f}) {
    const ClosedPath path(circle(radius, 48));
    EXPECT_NEAR(path.length(), 2 * kPi * radius, 1e-3f * radius);
    for (float s = 0.3f; s < path.length(); s += 0.37f) {
      EXPECT_NEAR(path.turn(s), 1 / radius, 0.03f / radius);
      EXPECT_NEAR(glm::dot(path.direction(s), path.at(s) - glm::vec3(0, 1, 0)), 0, 2e-3f * radius);
      const Lane lane{&path, 0.4f, -0.3f};  // the right hand is towards the middle
      EXPECT_NEAR(glm::length(glm::vec2(lane.at(s).x, lane.at(s).z)), radius - 0.4f, 2e-3f * radius);
      EXPECT_NEAR(lane.at(s).y, 0.7f, 1e-4f);
      EXPECT_GT(glm::dot(lane.direction(s), path.direction(s)), 0.999f);
    }
  }
}

// A fish of 0.5 m and 100 voxels that swims along +x, as the sample models do.
kelp::Part fishPart(std::span<const kelp::Knot> knots) {
  kelp::Part part;
  part.size = {40, 100, 20};
  const float s = 0.005f;
  part.to_object = glm::mat4x3(glm::vec3(0, s, 0), glm::vec3(-s, 0, 0), glm::vec3(0, 0, s),
                               glm::vec3(0.25f, -0.12f, -0.05f));
  part.knots = knots;
  return part;
}

std::vector<kelp::Knot> straight() {
  std::vector<kelp::Knot> knots;
  for (const float at : {0.0f, 0.35f, 0.7f, 1.0f}) knots.push_back({at, {0, at, 0}, {0, 1, 0}});
  return knots;
}

TEST(Swimmer, IsStraightOnAStraightLane) {
  const std::vector<kelp::Knot> rest = straight();
  const Anatomy anatomy = Anatomy::of(fishPart(rest));
  EXPECT_NEAR(anatomy.length, 0.5f, 1e-5f);
  const ClosedPath path(circle(500, 48));
  const Lane lane{&path, 0, 0};
  std::vector<kelp::Knot> knots = rest;
  layOnLane(anatomy, swimFrame(anatomy, lane, 100, 1, 0), lane, 100, 1, knots);
  for (std::size_t i = 0; i < knots.size(); ++i) {
    // half a metre of a circle of 500
    EXPECT_LT(glm::distance(knots[i].position, rest[i].position), 0.003f) << i;
    EXPECT_LT(glm::distance(knots[i].tangent, rest[i].tangent), 0.003f) << i;
  }
}

TEST(Swimmer, LiesOnItsLaneHeadFirstAndUpright) {
  const std::vector<kelp::Knot> rest = straight();
  const Anatomy anatomy = Anatomy::of(fishPart(rest));
  for (const float radius : {1.0f, 3.0f}) {
    const ClosedPath path(circle(radius, 64));
    const Lane lane{&path, 0.1f, 0.2f};
    for (float head = 0; head < path.length(); head += 0.61f) {
      const float scale = 1.2f;
      const glm::mat4 frame = swimFrame(anatomy, lane, head, scale, 0);
      std::vector<kelp::Knot> knots = rest;
      layOnLane(anatomy, frame, lane, head, scale, knots);
      ASSERT_TRUE(kelp::checkKnots(knots));
      EXPECT_GT(glm::dot(glm::vec3(frame * glm::vec4(1, 0, 0, 0)), path.direction(head - 0.3f)),
                0.99f * scale);  // +x of the model leads
      EXPECT_GT((frame * glm::vec4(0, 1, 0, 0)).y, 0.999f * scale);
      const glm::mat4 to_world = frame * anatomy.voxel_to_object;
      for (std::size_t i = 0; i + 1 < knots.size(); ++i) {
        for (const float t : {0.0f, 0.3f, 0.6f, 1.0f}) {
          const glm::vec3 middle =
              evaluate(kelp::makeSegment(knots[i], knots[i + 1], 100), t) + glm::vec3(20, 0, 10);
          const glm::vec3 at = to_world * glm::vec4(middle, 1);
          EXPECT_NEAR(glm::length(glm::vec2(at.x, at.z)), radius - 0.1f, 0.004f)
              << radius << " " << head << " " << i;
          EXPECT_NEAR(at.y, 1.2f, 0.004f);
        }
      }
      const glm::vec3 nose = to_world * glm::vec4(100.0f * knots.front().position + glm::vec3(20, 0, 10), 1);
      EXPECT_LT(glm::distance(nose, lane.at(head)), 1e-3f);
      const glm::vec3 tail = to_world * glm::vec4(100.0f * knots.back().position + glm::vec3(20, 0, 10), 1);
      EXPECT_LT(glm::distance(tail, lane.at(head - scale * 0.5f)), 1e-3f);
    }
  }
}

TEST(Current, LeansAsItSaysAndRollsOn) {
  Random random(5);
  for (int i = 0; i < 300; ++i) {
    const glm::vec2 at = random.inDisc(kReefRadius);
    const double seconds = random.between(0, 4000);
    EXPECT_LE(glm::length(currentAt(at, seconds)), 0.26f);
    EXPECT_LT(glm::distance(currentAt(at, seconds), currentAt(at, seconds + 0.02)), 0.005f);
    EXPECT_LT(glm::distance(currentAt(at, seconds), currentAt(at + glm::vec2(0.1f), seconds)), 0.02f);
  }
  EXPECT_GT(glm::distance(currentAt({0, 0}, 0), currentAt({0, 0}, 2)), 0.02f);
}

TEST(Scatter, IsTheSameEveryTimeAndOnlyAdds) {
  const std::vector<Site> few = scatter(150, 3), many = scatter(400, 3);
  ASSERT_EQ(few.size(), 150u);
  ASSERT_EQ(many.size(), 400u);
  for (std::size_t i = 0; i < few.size(); ++i) {
    EXPECT_EQ(few[i].at, many[i].at);
    EXPECT_EQ(few[i].plant, many[i].plant);
    EXPECT_EQ(few[i].yaw, many[i].yaw);
  }
  EXPECT_NE(scatter(1, 4)[0].at, few[0].at);
  EXPECT_TRUE(scatter(0, 3).empty());
}

TEST(Scatter, KeepsApartAndInside) {
  const std::vector<Site> sites = scatter(400, 7);
  int of[static_cast<int>(Plant::kCount)] = {};
  float nearest = 1e9f;
  for (std::size_t i = 0; i < sites.size(); ++i) {
    ++of[static_cast<int>(sites[i].plant)];
    EXPECT_LE(glm::length(sites[i].at), kReefRadius);
    if (sites[i].plant == Plant::kKelp) {
      EXPECT_GT(glm::length(sites[i].at), 1.2f * kGladeRadius);  // none where the camera circles
    }
    EXPECT_GT(sites[i].scale, 0.3f);
    EXPECT_LT(sites[i].scale, 3.5f);
    for (std::size_t k = 0; k < i; ++k) nearest = std::min(nearest, glm::distance(sites[i].at, sites[k].at));
  }
  for (const int count : of) EXPECT_GT(count, 40);
  // metres; thrown at random, 400 in this disc come within some 0.03 m of one another
  EXPECT_GT(nearest, 0.2f);
}

TEST(Terrain, SlopesAsItsHeightSays) {
  Random random(1);
  for (int i = 0; i < 200; ++i) {
    const glm::vec2 at = random.inDisc(40);
    const float h = 0.01f,
                dx = (sandHeight(at + glm::vec2(h, 0)) - sandHeight(at - glm::vec2(h, 0))) / (2 * h);
    const float dz = (sandHeight(at + glm::vec2(0, h)) - sandHeight(at - glm::vec2(0, h))) / (2 * h);
    EXPECT_LT(glm::distance(sandNormal(at), glm::normalize(glm::vec3(-dx, 1, -dz))), 2e-3f);
    EXPECT_LT(std::abs(sandHeight(at)), 0.5f);
  }
}

TEST(Terrain, MeshCoversTheDiscOnceFacingUp) {
  const FloorMesh mesh = makeFloorMesh(20, 12, 32);
  double area = 0;
  for (std::size_t i = 0; i < mesh.indices.size(); i += 3) {
    const glm::vec3 &a = mesh.vertices.at(mesh.indices[i]).position,
                    &b = mesh.vertices.at(mesh.indices[i + 1]).position,
                    &c = mesh.vertices.at(mesh.indices[i + 2]).position;
    const float upward = 0.5f * glm::cross(b - a, c - a).y;
    EXPECT_GT(upward, 0);
    area += upward;
  }
  EXPECT_NEAR(area, 0.5 * 32 * std::sin(2 * kPi / 32) * 20 * 20, 0.1);  // of the regular polygon
  for (const FloorMesh::Vertex& vertex : mesh.vertices)
    EXPECT_EQ(vertex.position.y, sandHeight({vertex.position.x, vertex.position.z}));
}

TEST(CameraOfTheReef, CirclesInTheGladeAndStaysInTheWater) {
  Camera camera;
  glm::vec3 before(0);
  for (double seconds = 0; seconds < 300; seconds += 0.5) {
    camera.circle(seconds);
    const glm::vec2 ground(camera.at().x, camera.at().z);
    EXPECT_GT(camera.at().y, sandHeight(ground) + 0.5f);
    EXPECT_LT(glm::length(ground), 1.1f * kGladeRadius);
    // sees the glade
    EXPECT_GT(glm::dot(-glm::normalize(ground), glm::vec2(camera.forward().x, camera.forward().z)), 0.9f);
    if (seconds > 0) {
      EXPECT_LT(glm::distance(camera.at(), before), 0.15f);
    }
    before = camera.at();
  }
  const glm::vec4 ahead = camera.worldToEye() * glm::vec4(camera.at() + 2.0f * camera.forward(), 1);
  EXPECT_LT(glm::distance(glm::vec3(ahead), glm::vec3(0, 0, -2)), 1e-4f);
  for (const glm::vec3& wish : {glm::vec3(0, -3, 1), glm::vec3(2, 3, 0), glm::vec3(-1, -1, 3)}) {
    for (int i = 0; i < 600; ++i) {
      camera.look({0.01f, 0.002f});
      camera.swim(wish, 0.05f);
      EXPECT_GE(camera.at().y, sandHeight({camera.at().x, camera.at().z}) + 0.2499f);
      EXPECT_LT(camera.at().y, kSurface);
      EXPECT_LE(glm::length(glm::vec2(camera.at().x, camera.at().z)), 1.3001f * kReefRadius);
    }
  }
  EXPECT_FALSE(camera.circling());
}

TEST(ArgumentsOfTheReef, AreReadOrRefused) {
  const auto read = [](std::vector<const char*> words) {
    words.insert(words.begin(), "underwater");
    return parse(static_cast<int>(words.size()), words.data());
  };
  const auto all =
      read({"--plants", "60", "packs", "--size", "320x240", "--start", "2.5", "--frames", "3", "out.ppm"});
  ASSERT_TRUE(all);
  EXPECT_EQ(all->packs, "packs");
  EXPECT_EQ(all->plants, 60);
  EXPECT_EQ(all->size, glm::ivec2(320, 240));
  EXPECT_EQ(all->start, 2.5);
  EXPECT_EQ(all->frames, 3);
  EXPECT_EQ(all->picture, "out.ppm");
  EXPECT_TRUE(read({"packs"}));
  for (const std::vector<const char*>& words : std::vector<std::vector<const char*>>{{},
                                                                                     {"a", "b"},
                                                                                     {"a", "--plants"},
                                                                                     {"a", "--plants", "-1"},
                                                                                     {"a", "--plants", "6x"},
                                                                                     {"a", "--size", "320"},
                                                                                     {"a", "--size", "0x9"},
                                                                                     {"a", "--frames", "0"},
                                                                                     {"a", "--frames", "two"},
                                                                                     {"a", "--start", "nan"},
                                                                                     {"a", "--start", "inf"},
                                                                                     {"a", "--fast"},
                                                                                     {"--plants", "6"}}) {
    EXPECT_FALSE(read(words)) << (words.empty() ? "" : words.back());
  }
}

}  // namespace
}  // namespace underwater
