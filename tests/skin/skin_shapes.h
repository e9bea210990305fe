// SPDX-License-Identifier: MIT
// Meshes that bend by joints, made in memory.
#pragma once

#include <cmath>
#include <cstdint>
#include <functional>
#include <string>
#include <utility>
#include <vector>

#include <glm/glm.hpp>
#include <glm/gtc/matrix_transform.hpp>

#include "kelp/import/core/frame.h"
#include "kelp/import/core/source_model.h"
#include "kelp/voxelize/voxelize.h"

namespace kelp::bake::test {

struct SkinnedShape {
  SourceModel model;  // one part, with a skin
  Frame frame;
  VoxelGrid whole;

  const TriangleSoup& soup() const { return model.parts[0].soup; }
  const SourceSkin& skin() const { return *model.parts[0].skin; }
  SourceSkin& skin() { return *model.parts[0].skin; }
  void voxelizeWhole() { whole = voxelize(model, model.parts[0], frame, Fill::kSolid, 1, {}).grid; }
};

constexpr double kTubeHeight = 12.8, kTubeRadius = 1.2;

// A closed tube along y with `joints` joints one above the other, each of which moves its stretch; between
// the middles of two stretches the weights go over linearly. 128 voxels high.
inline SkinnedShape tube(int joints, int rings = 33, int corners = 16) {
  SkinnedShape shape;
  SourcePart part;
  part.name = "tube";
  SourceSkin skin;
  TriangleSoup& soup = part.soup;
  const double stretch = kTubeHeight / joints;
  const auto addVertex = [&](double x, double y, double z) {
    soup.positions.emplace_back(x, y, z);
    skin.first_influence.push_back(static_cast<std::uint32_t>(skin.influences.size()));
    for (int j = 0; j < joints; ++j) {
      const double middle = (j + 0.5) * stretch;
      const double inner = std::min(std::max(y, 0.5 * stretch), kTubeHeight - 0.5 * stretch);
      const double weight = 1 - std::abs(inner - middle) / stretch;
      if (weight > 1e-6)
        skin.influences.push_back({static_cast<std::uint32_t>(j), static_cast<float>(weight)});
    }
  };
  for (int ring = 0; ring < rings; ++ring)
    for (int k = 0; k < corners; ++k) {
      const double turn = 2 * 3.14159265358979 * k / corners;
      addVertex(kTubeRadius * std::cos(turn), kTubeHeight * ring / (rings - 1), kTubeRadius * std::sin(turn));
    }
  addVertex(0, 0, 0);
  addVertex(0, kTubeHeight, 0);
  skin.first_influence.push_back(static_cast<std::uint32_t>(skin.influences.size()));
  const auto addTriangle = [&](int a, int b, int c) {
    soup.triangles.push_back(
        {{static_cast<std::uint32_t>(a), static_cast<std::uint32_t>(b), static_cast<std::uint32_t>(c)}, 0});
    soup.skinned.push_back(soup.triangles.back().vertex);
  };
  for (int k = 0; k < corners; ++k) {
    const int next = (k + 1) % corners, top = (rings - 1) * corners;
    for (int ring = 0; ring + 1 < rings; ++ring) {
      const int low = ring * corners, high = low + corners;
      addTriangle(low + k, high + k, low + next);
      addTriangle(low + next, high + k, high + next);
    }
    addTriangle(rings * corners, k, next);
    addTriangle(rings * corners + 1, top + next, top + k);
  }
  for (int j = 0; j < joints; ++j) {
    SourceSkin::Joint& joint = skin.joints.emplace_back();
    joint.name = "bone" + std::to_string(j);
    joint.parent = j - 1;
    joint.origin = {0, j * stretch, 0};
  }
  shape.frame = makeFrame(soup, Axis::kPlusY, kTubeHeight / 128, "tube");
  part.skin = std::move(skin);
  shape.model.parts.push_back(std::move(part));
  shape.model.materials.emplace_back();
  return shape;
}

// The same, bent in the bind pose: its middle line is an arc of so many radians.
inline SkinnedShape curvedTube(int joints, double radians) {
  SkinnedShape shape = tube(joints);
  const double radius = kTubeHeight / radians;
  const auto bend = [&](const glm::dvec3& at) {
    const double turn = at.y / radius;
    return glm::dvec3(radius - (radius - at.x) * std::cos(turn), (radius - at.x) * std::sin(turn), at.z);
  };
  for (glm::vec3& at : shape.model.parts[0].soup.positions) at = glm::vec3(bend(glm::dvec3(at)));
  for (SourceSkin::Joint& joint : shape.skin().joints) joint.origin = bend(joint.origin);
  shape.frame = makeFrame(shape.soup(), Axis::kPlusY, kTubeHeight / 128, "curved tube");
  return shape;
}

// A clip in which joint j turns about its origin by angle(j, time) about z, seen from its parent.
inline SourceSkin::Clip turningClip(const SourceSkin& skin, const std::string& name, double duration,
                                    int samples, const std::function<double(int, double)>& angle) {
  SourceSkin::Clip clip{name, static_cast<float>(duration), {}, {}};
  for (int i = 0; i < samples; ++i) {
    const double time = duration * i / (samples - 1);
    clip.times.push_back(static_cast<float>(time));
    std::vector<glm::dmat4> posed;
    for (std::size_t j = 0; j < skin.joints.size(); ++j) {
      const glm::dvec3& at = skin.joints[j].origin;
      const glm::dmat4 turn =
          glm::translate(glm::dmat4(1), at) *
          glm::rotate(glm::dmat4(1), angle(static_cast<int>(j), time), glm::dvec3(0, 0, 1)) *
          glm::translate(glm::dmat4(1), -at);
      const int parent = skin.joints[j].parent;
      posed.push_back(parent < 0 ? turn : posed[static_cast<std::size_t>(parent)] * turn);
      clip.motions.emplace_back(posed.back());
    }
  }
  return clip;
}

}  // namespace kelp::bake::test
