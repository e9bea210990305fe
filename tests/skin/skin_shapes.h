// SPDX-License-Identifier: MIT
// Meshes that bend by joints, made in memory.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include <glm/glm.hpp>
#include <glm/gtc/matrix_transform.hpp>
#include <glm/gtc/quaternion.hpp>

#include "kelp/import/core/frame.h"
#include "kelp/import/core/source_model.h"
#include "kelp/skin/skin.h"
#include "kelp/voxelize/voxelize.h"

namespace kelp::bake::test {

struct SkinnedShape {
  SourceModel model;  // one part, with a skin
  Frame frame;
  VoxelGrid whole;

  TriangleSoup& soup() { return model.parts[0].soup; }
  SourceSkin& skin() { return *model.parts[0].skin; }

  SkinnedShape() {
    model.parts.emplace_back().skin.emplace();
    model.materials.emplace_back();
  }
  std::uint32_t addVertex(const glm::dvec3& at, const std::vector<SourceSkin::Influence>& influences) {
    soup().positions.emplace_back(at);
    skin().first_influence.push_back(static_cast<std::uint32_t>(skin().influences.size()));
    skin().influences.insert(skin().influences.end(), influences.begin(), influences.end());
    return static_cast<std::uint32_t>(soup().positions.size() - 1);
  }
  void addTriangle(std::uint32_t a, std::uint32_t b, std::uint32_t c) {
    soup().triangles.push_back({{a, b, c}, 0});
    soup().skinned.push_back({a, b, c});
  }
  void addJoint(int parent, const glm::dvec3& at) {
    SourceSkin::Joint& joint = skin().joints.emplace_back();
    joint.name = "bone" + std::to_string(skin().joints.size() - 1);
    joint.parent = parent;
    joint.frame = glm::translate(glm::dmat4(1), at);
    joint.inverse_bind = glm::inverse(joint.frame);
    if (parent >= 0) joint.base = skin().joints[static_cast<std::size_t>(parent)].frame;
  }
  // A box that follows one joint.
  void addBox(const glm::dvec3& low, const glm::dvec3& high, std::uint32_t joint) {
    const auto first = static_cast<std::uint32_t>(soup().positions.size());
    for (int i = 0; i < 8; ++i)
      addVertex({i & 1 ? high.x : low.x, i & 2 ? high.y : low.y, i & 4 ? high.z : low.z}, {{joint, 1}});
    constexpr std::uint32_t kFaces[6][4] = {{0, 4, 6, 2}, {1, 3, 7, 5}, {0, 1, 5, 4},
                                            {2, 6, 7, 3}, {0, 2, 3, 1}, {4, 5, 7, 6}};
    for (const auto& face : kFaces) {
      addTriangle(first + face[0], first + face[1], first + face[2]);
      addTriangle(first + face[0], first + face[2], first + face[3]);
    }
  }
  // Ends vertices and voxelizes.
  void finish(int resolution) {
    skin().first_influence.push_back(static_cast<std::uint32_t>(skin().influences.size()));
    const glm::dvec3 extent = rigExtent(soup(), Axis::kPlusY, "shape");
    frame = makeFrame(soup(), Axis::kPlusY, std::max({extent.x, extent.y, extent.z}) / resolution, "shape");
    whole = voxelize(model, model.parts[0], frame, Fill::kSolid, 1, {}).grid;
  }
  // A clip in which joint j turns about its place by angle(j, time) about z, seen from its parent.
  void addClip(const std::string& name, double duration, int samples,
               const std::function<double(int, double)>& angle) {
    SourceSkin::Clip clip;
    clip.name = name;
    clip.duration = static_cast<float>(duration);
    for (int i = 0; i < samples; ++i) {
      const double time = duration * i / (samples - 1);
      clip.times.push_back(static_cast<float>(time));
      for (std::size_t j = 0; j < skin().joints.size(); ++j) {
        const glm::dmat4& frame_of = skin().joints[j].frame;
        const glm::dquat turn = glm::angleAxis(angle(static_cast<int>(j), time), glm::dvec3(0, 0, 1));
        clip.locals.emplace_back(frame_of * glm::mat4_cast(turn) * glm::inverse(frame_of));
        clip.turns.push_back(turn);
      }
    }
    skin().clips.push_back(std::move(clip));
  }
  SkinCage cage(int cell, int threads = 1) {
    return cageOfSkin(soup(), skin(), frame, whole, cell, 5, threads, {});
  }
};

constexpr double kTubeHeight = 12.8, kTubeRadius = 1.2;

// A closed tube along y with `joints` joints one above the other; between the middles of two stretches the
// weights go over linearly. 128 voxels high.
inline SkinnedShape tube(int joints, int rings = 65, int corners = 24) {
  SkinnedShape shape;
  const double stretch = kTubeHeight / joints;
  const auto addVertex = [&](double x, double y, double z) {
    std::vector<SourceSkin::Influence> influences;
    for (int j = 0; j < joints; ++j) {
      const double inner = std::clamp(y, 0.5 * stretch, kTubeHeight - 0.5 * stretch);
      const double weight = 1 - std::abs(inner - (j + 0.5) * stretch) / stretch;
      if (weight > 1e-6) influences.push_back({static_cast<std::uint32_t>(j), static_cast<float>(weight)});
    }
    return shape.addVertex({x, y, z}, influences);
  };
  for (int ring = 0; ring < rings; ++ring)
    for (int k = 0; k < corners; ++k) {
      const double turn = 2 * 3.14159265358979 * k / corners;
      addVertex(kTubeRadius * std::cos(turn), kTubeHeight * ring / (rings - 1), kTubeRadius * std::sin(turn));
    }
  const std::uint32_t bottom = addVertex(0, 0, 0), top = addVertex(0, kTubeHeight, 0);
  const auto at = [&](int ring, int k) { return static_cast<std::uint32_t>(ring * corners + k % corners); };
  for (int k = 0; k < corners; ++k) {
    for (int ring = 0; ring + 1 < rings; ++ring) {
      shape.addTriangle(at(ring, k), at(ring + 1, k), at(ring, k + 1));
      shape.addTriangle(at(ring, k + 1), at(ring + 1, k), at(ring + 1, k + 1));
    }
    shape.addTriangle(bottom, at(0, k), at(0, k + 1));
    shape.addTriangle(top, at(rings - 1, k + 1), at(rings - 1, k));
  }
  for (int j = 0; j < joints; ++j) shape.addJoint(j - 1, {0, j * stretch, 0});
  shape.finish(128);
  return shape;
}

// With a clip that bends it.
inline SkinnedShape bendingTube(int joints, double most) {
  SkinnedShape shape = tube(joints);
  shape.addClip("bend", 2, 61,
                [&](int j, double time) { return j == 0 ? 0.0 : most * std::sin(1.5707963 * time); });
  return shape;
}

}  // namespace kelp::bake::test
