// SPDX-License-Identifier: MIT
// Where a pack's cage puts points of a mesh, in double precision, as the pack's own numbers say.
#pragma once

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <filesystem>
#include <string>
#include <vector>

#include <glm/glm.hpp>
#include <glm/gtc/quaternion.hpp>

#include "gltf_truth.h"
#include "kelp/bake/bake.h"
#include "kelp/formats/cage.h"

namespace kelp::bake::test {

class MorphedPack {
 public:
  explicit MorphedPack(const std::filesystem::path& path, int cell = 0) : truth(path) {
    Settings settings;
    settings.resolution = 128;
    settings.resolution_given = true;
    settings.threads = 2;
    if (cell != 0) settings.cell = cell;
    pack = bake::bake(path, settings, report);
    const Result<Cage> made = makeCage(body().cages[0].source(), body().size, 1, body().cell, 0, nullptr,
                                       std::uint64_t{1} << 30, memory_);
    EXPECT_TRUE(made);
    cage_ = *made;
    to_voxels_ = glm::inverse(glm::dmat4(glm::dmat4x3(body().to_object)));
    voxel_ = glm::length(glm::dvec3(body().to_object[0]));
  }
  const RawPart& body() const { return pack.parts.at(0); }
  // The index of a part; 0: there is none.
  std::size_t named(const std::string& name) const {
    for (std::size_t i = 1; i < pack.parts.size(); ++i)
      if (pack.parts[i].name == name) return i;
    return 0;
  }

  // Where the nodes are at a time of a clip, in the object.
  std::vector<glm::dvec3> nodesAt(int clip, double time) const {
    std::vector<glm::dmat4> motions;
    std::vector<double> weights;
    for (std::uint32_t part = 0; part < pack.parts.size(); ++part) {
      const glm::dmat4 local = motionOf(pack.clips.at(static_cast<std::size_t>(clip)), part, time);
      const glm::dmat4 pivot(glm::dmat4x3(pack.parts[part].pivot)), its = pivot * local * glm::inverse(pivot);
      const int parent = pack.parts[part].parent;
      motions.push_back(parent < 0 ? its : motions[static_cast<std::size_t>(parent)] * its);
      weights.push_back(local[3].x);
    }
    return posed(motions, weights);
  }

  // The mean distance, in voxels, from where the file has the nodes' meshes at a time of its animation, of
  // the points that either moves.
  double farAt(const std::vector<int>& nodes, int animation, double time) const {
    return far(nodes, nodesAt(animation, time),
               [&](int node) { return truth.worldCorners(node, animation, time); });
  }
  // The same of a part's morph target at weight 1, which is target `target` of each of the nodes' meshes.
  double farAlone(const std::vector<int>& nodes, std::size_t part, std::size_t target, std::size_t targets,
                  const std::vector<double>& rest = {}) const {
    std::vector<double> weights(pack.parts.size(), 0.0), of_mesh(targets, 0.0);
    if (!rest.empty()) of_mesh = rest;
    weights[part] = 1;
    of_mesh[target] += 1;
    return far(nodes, posed(std::vector<glm::dmat4>(pack.parts.size(), glm::dmat4(1)), weights),
               [&](int node) { return truth.worldCornersAt(node, -1, 0, of_mesh); });
  }

  GltfTruth truth;
  Report report;
  RawPack pack;

 private:
  static glm::dmat4 motionOf(const RawClip& clip, std::uint32_t part, double time) {
    glm::dmat4 translated(1), turned(1), scaled(1);
    for (const RawTrack& track : clip.tracks) {
      if (track.part != part) continue;
      std::size_t k = 0;
      while (k + 1 < track.keys.size() && static_cast<double>(track.keys[k + 1].time) <= time) ++k;
      const Key &a = track.keys[k], &b = track.keys[std::min(k + 1, track.keys.size() - 1)];
      const double from = static_cast<double>(a.time), to = static_cast<double>(b.time),
                   share = to > from && time > from ? (time - from) / (to - from) : 0;
      const glm::dvec4 value = glm::mix(glm::dvec4(a.value), glm::dvec4(b.value), share);
      if (track.target == Target::kPartRotation) {
        const glm::dvec4 one(a.value), other(b.value);
        turned =
            glm::mat4_cast(glm::slerp(glm::normalize(glm::dquat(one.w, one.x, one.y, one.z)),
                                      glm::normalize(glm::dquat(other.w, other.x, other.y, other.z)), share));
      } else if (track.target == Target::kPartScale) {
        for (int axis = 0; axis < 3; ++axis) scaled[axis][axis] = 1 + value[axis];
      } else {
        translated[3] = glm::dvec4(glm::dvec3(value), 1);
      }
    }
    return translated * turned * scaled;
  }

  std::vector<glm::dvec3> posed(const std::vector<glm::dmat4>& motions,
                                const std::vector<double>& weights) const {
    std::vector<glm::dvec3> nodes;
    for (std::uint32_t n = 0; n < cage_.nodes(); ++n) nodes.emplace_back(cage_.rest(n));
    for (const RawMorph& morph : body().morphs)
      for (std::size_t i = 0; i < morph.nodes.size(); ++i)
        nodes[morph.nodes[i]] +=
            weights[morph.part] * static_cast<double>(morph.step) * glm::dvec3(morph.offsets[i]);
    const glm::dmat4 to_object(glm::dmat4x3(body().to_object));
    for (std::uint32_t n = 0; n < cage_.nodes(); ++n) {
      glm::dvec4 at(0);
      for (int i = 0; i < 4; ++i)
        at += body().influences[n].weights[i] / 255.0 *
              (motions[body().influences[n].parts[i]] * (to_object * glm::dvec4(nodes[n], 1)));
      nodes[n] = glm::dvec3(at);
    }
    return nodes;
  }

  template <class Corners>
  double far(const std::vector<int>& nodes, const std::vector<glm::dvec3>& caged_nodes,
             const Corners& corners) const {
    double sum = 0, area = 0;
    for (const int node : nodes) {
      const std::vector<glm::dvec3> before = truth.worldCorners(node, -1, 0), after = corners(node);
      for (std::size_t t = 0; t < before.size(); t += 3) {
        const glm::dvec3 across = glm::cross(before[t + 1] - before[t], before[t + 2] - before[t]);
        for (const glm::dvec3& shares :
             {glm::dvec3(0.6, 0.3, 0.1), glm::dvec3(0.1, 0.6, 0.3), glm::dvec3(0.3, 0.1, 0.6)}) {
          const auto mix = [&](const std::vector<glm::dvec3>& of) {
            return shares.x * of[t] + shares.y * of[t + 1] + shares.z * of[t + 2];
          };
          const glm::dvec3 from = mix(before), wanted = mix(after),
                           caged = place(from, from - 0.6 * voxel_ * glm::normalize(across), caged_nodes);
          if (glm::distance(caged, from) < 1e-4 * voxel_ && glm::distance(wanted, from) < 1e-4 * voxel_)
            continue;
          sum += glm::length(across) * glm::distance(caged, wanted);
          area += glm::length(across);
        }
      }
    }
    return area > 0 ? sum / area / voxel_ : 0;
  }

  // `within`: just below the surface, in the voxel that goes with the point.
  glm::dvec3 place(const glm::dvec3& point, const glm::dvec3& within,
                   const std::vector<glm::dvec3>& nodes) const {
    const glm::dvec3 at(to_voxels_ * glm::dvec4(point, 1)), inner(to_voxels_ * glm::dvec4(within, 1));
    const std::uint32_t cell = cellAt(inner);
    const glm::dvec3 f = at / static_cast<double>(cage_.side) - glm::dvec3(cage_.place(cell));
    std::array<int, 3> order{0, 1, 2};
    std::sort(order.begin(), order.end(), [&](int a, int b) { return f[a] > f[b]; });
    glm::dvec3 out(0);
    double before = 1;
    for (int k = 0, corner = 0; k <= 3; ++k) {
      const double after = k < 3 ? f[order[static_cast<std::size_t>(k)]] : 0;
      out += (before - after) * nodes[cage_.node(cell, corner)];
      before = after;
      if (k < 3) corner |= 1 << order[static_cast<std::size_t>(k)];
    }
    return out;
  }

  // The cell whose voxel this is, or the nearest.
  std::uint32_t cellAt(const glm::dvec3& inner) const {
    const glm::ivec3 voxel(glm::clamp(glm::floor(inner), glm::dvec3(0), glm::dvec3(body().size - 1)));
    const glm::ivec3 cube = voxel / cage_.side, in = voxel - cage_.side * cube;
    const auto bit = static_cast<std::uint32_t>(in.x + cage_.side * (in.y + cage_.side * in.z));
    std::uint32_t best = 0;
    double least = INFINITY;
    for (std::uint32_t c = 0; c < cage_.cells(); ++c) {
      if (cage_.place(c) == cube &&
          (cage_.cell(c)[1] == 0 || (cage_.words[cage_.maskAt(c, 0) + bit / 32] >> bit % 32 & 1)))
        return c;
      const double apart =
          glm::distance((glm::dvec3(cage_.place(c)) + 0.5) * static_cast<double>(cage_.side), inner);
      if (apart >= least) continue;
      least = apart;
      best = c;
    }
    return best;
  }

  CageMemory memory_;
  Cage cage_;
  glm::dmat4 to_voxels_{1};
  double voxel_ = 1;
};

}  // namespace kelp::bake::test
