// SPDX-License-Identifier: MIT
#include "shapes.h"

#include <array>
#include <cmath>
#include <numbers>
#include <utility>

namespace kelp::test {
namespace {

constexpr float kPi = std::numbers::pi_v<float>;

}  // namespace

bake::SourceModel makeModel(bake::TriangleSoup soup, const std::string& name) {
  bake::SourceModel model;
  model.format = "test";
  model.materials.emplace_back();
  bake::SourcePart& part = model.parts.emplace_back();
  part.name = name;
  part.soup = std::move(soup);
  return model;
}

void addTriangle(bake::TriangleSoup& soup, const glm::vec3& a, const glm::vec3& b, const glm::vec3& c) {
  const std::uint32_t first = static_cast<std::uint32_t>(soup.positions.size());
  soup.positions.insert(soup.positions.end(), {a, b, c});
  bake::TriangleSoup::Triangle triangle;
  triangle.vertex = {first, first + 1, first + 2};
  soup.triangles.push_back(triangle);
}

void addBox(bake::TriangleSoup& soup, const glm::vec3& low, const glm::vec3& high, int skip) {
  for (int face = 0; face < 6; ++face) {
    if (face == skip) continue;
    const int axis = face / 2, u = (axis + 1) % 3, v = (axis + 2) % 3;
    std::array<glm::vec3, 4> corner;
    for (int k = 0; k < 4; ++k) {
      glm::vec3 p;
      p[axis] = face % 2 ? high[axis] : low[axis];
      p[u] = k == 1 || k == 2 ? high[u] : low[u];
      p[v] = k >= 2 ? high[v] : low[v];
      corner[static_cast<std::size_t>(k)] = p;
    }
    if (face % 2 == 0) std::swap(corner[1], corner[3]);
    addTriangle(soup, corner[0], corner[1], corner[2]);
    addTriangle(soup, corner[0], corner[2], corner[3]);
  }
}

void addSphere(bake::TriangleSoup& soup, const glm::vec3& center, float radius, int rings,
               const std::function<bool(float)>& keep) {
  const auto point = [&](int ring, int step) {
    if (ring == 0) return center - glm::vec3(0, radius, 0);
    if (ring == rings) return center + glm::vec3(0, radius, 0);
    const float latitude = kPi * (static_cast<float>(ring) / static_cast<float>(rings) - 0.5f);
    const float longitude = kPi * static_cast<float>(step % (2 * rings)) / static_cast<float>(rings);
    return center + radius * glm::vec3(std::cos(latitude) * std::cos(longitude), std::sin(latitude),
                                       std::cos(latitude) * std::sin(longitude));
  };
  for (int ring = 0; ring < rings; ++ring) {
    if (keep && !keep(kPi * ((static_cast<float>(ring) + 0.5f) / static_cast<float>(rings) - 0.5f))) continue;
    for (int step = 0; step < 2 * rings; ++step) {
      if (ring > 0) addTriangle(soup, point(ring, step), point(ring + 1, step), point(ring, step + 1));
      if (ring + 1 < rings)
        addTriangle(soup, point(ring, step + 1), point(ring + 1, step), point(ring + 1, step + 1));
    }
  }
}

void addTorus(bake::TriangleSoup& soup, float major, float minor, int steps) {
  const auto point = [&](int i, int j) {
    const float a = 2 * kPi * static_cast<float>(i % steps) / static_cast<float>(steps),
                b = 2 * kPi * static_cast<float>(j % steps) / static_cast<float>(steps);
    const float r = major + minor * std::cos(b);
    return glm::vec3(r * std::cos(a), minor * std::sin(b), r * std::sin(a));
  };
  for (int i = 0; i < steps; ++i) {
    for (int j = 0; j < steps; ++j) {
      addTriangle(soup, point(i, j), point(i, j + 1), point(i + 1, j));
      addTriangle(soup, point(i + 1, j), point(i, j + 1), point(i + 1, j + 1));
    }
  }
}

void addRod(bake::TriangleSoup& soup, const glm::vec3& a, const glm::vec3& b, float radius) {
  const glm::vec3 along = glm::normalize(b - a);
  const glm::vec3 side =
      glm::normalize(glm::cross(along, std::abs(along.x) < 0.5f ? glm::vec3(1, 0, 0) : glm::vec3(0, 0, 1)));
  const glm::vec3 up = glm::cross(along, side);
  constexpr int kSides = 12;
  const auto offset = [&](int k) {
    const float angle = 2 * kPi * static_cast<float>(k % kSides) / static_cast<float>(kSides);
    return radius * (std::cos(angle) * side + std::sin(angle) * up);
  };
  for (int k = 0; k < kSides; ++k) {
    addTriangle(soup, a + offset(k), a + offset(k + 1), b + offset(k));
    addTriangle(soup, b + offset(k), a + offset(k + 1), b + offset(k + 1));
    addTriangle(soup, a, a + offset(k + 1), a + offset(k));
    addTriangle(soup, b, b + offset(k), b + offset(k + 1));
  }
}

void turnInsideOut(bake::TriangleSoup& soup) {
  for (bake::TriangleSoup::Triangle& triangle : soup.triangles)
    std::swap(triangle.vertex[1], triangle.vertex[2]);
}

bool Baked::at(int x, int y, int z) const {
  const glm::ivec3 size = grid().size;
  return grid().solid[static_cast<std::size_t>(x) +
                      static_cast<std::size_t>(size.x) *
                          (static_cast<std::size_t>(y) +
                           static_cast<std::size_t>(size.y) * static_cast<std::size_t>(z))] != 0;
}

Baked voxelizeUnit(const bake::SourceModel& model, bake::Fill fill, int threads) {
  Baked baked;
  const bake::SourcePart& part = model.parts.front();
  baked.frame = bake::makeFrame(part.soup, part.rig.axis.value_or(Axis::kPlusY), 1.0, part.name);
  baked.result = bake::voxelize(model, part, baked.frame, fill, threads, {});
  for (const std::uint8_t voxel : baked.grid().solid) baked.solid += voxel != 0;
  return baked;
}

}  // namespace kelp::test
