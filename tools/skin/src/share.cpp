// SPDX-License-Identifier: MIT
#include "share.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include "collapse.h"
#include "kelp/common/dense_index.h"
#include "kelp/common/parallel.h"
#include "kelp/fields/fields.h"
#include "kelp/voxelize/surface/triangle_bvh.h"
#include "rigid.h"
#include "sweep_fit.h"

namespace kelp::bake {
namespace {

// The refined triangles as a mesh whose nearest points can be asked for.
Topology meshOf(const SkinSamples& samples, const SkinSpace& space) {
  Topology mesh;
  for (const glm::dvec3& at : samples.positions)
    mesh.lattice.emplace_back(glm::round(at * (space.voxels / kLatticeStep)));
  for (const auto& corners : samples.triangles) {
    SolidTriangle& triangle = mesh.triangles.emplace_back();
    triangle.vertex = corners;
  }
  return mesh;
}

// Of all parts at all moments: posed <- bind pose.
class PartMotions {
 public:
  PartMotions(const SkinSamples& samples, const SkinMoments& moments, const SkinLabels& labels,
              const PartTree& tree)
      : tree_(tree), rigid_(tree.sweeps.size()), swept_(tree.sweeps.size()) {
    const std::vector<std::vector<std::uint32_t>> members = labels.members();
    for (std::size_t p = 0; p < members.size(); ++p) {
      if (!tree.sweeps[p]) {
        rigid_[p] = fitMotions(samples, moments, members[p], labels.joints[p]);
        continue;
      }
      for (const SkinPose& pose : SweepFit(samples, *tree.sweeps[p], members[p]).poses(moments, 1).of_moments)
        swept_[p].emplace_back(*tree.sweeps[p], pose);
    }
  }

  // A swept part moves at a place as its section there; sections of one number as one.
  int section(std::uint32_t part, const glm::dvec3& at) const {
    if (!tree_.sweeps[part]) return 0;
    const SkinSweep& sweep = *tree_.sweeps[part];
    return static_cast<int>(std::floor(static_cast<double>(sweep.straightened(sweep.toPart(at)).y) / kThick));
  }
  std::vector<glm::dmat4x3> of(std::uint32_t part, int section) const {
    if (!tree_.sweeps[part]) return rigid_[part];
    std::vector<glm::dmat4x3> motions;
    for (const PosedSweep& posed : swept_[part])
      motions.push_back(posed.sectionMotion((section + 0.5) * kThick));
    return motions;
  }

 private:
  static constexpr double kThick = 2;  // voxels
  const PartTree& tree_;
  std::vector<std::vector<glm::dmat4x3>> rigid_;
  std::vector<std::vector<PosedSweep>> swept_;
};

// The direction from a to b at each edge of the seam, across it: the mean around, since edges lie askew.
std::vector<glm::dvec3> waysAcross(const SkinSamples& samples, const SkinLabels& labels, const Seam& seam) {
  constexpr double kAround = 5;
  std::vector<glm::dvec3> at, way, out;
  for (const std::uint32_t e : seam.edges) {
    const SkinSamples::Edge& edge = samples.edges[e];
    const double sign = labels.parts[edge.a] == seam.a ? 1 : -1;
    at.push_back(0.5 * (samples.positions[edge.a] + samples.positions[edge.b]));
    way.push_back(sign * edge.width * (samples.positions[edge.b] - samples.positions[edge.a]));
  }
  for (const glm::dvec3& here : at) {
    glm::dvec3 sum(0);
    for (std::size_t i = 0; i < at.size(); ++i)
      if (glm::dot(at[i] - here, at[i] - here) <= kAround * kAround) sum += way[i];
    const double length = glm::length(sum);
    out.push_back(length > 0 ? sum / length : glm::dvec3(0));
  }
  return out;
}

}  // namespace

VoxelOwners shareVoxels(const SkinSamples& samples, const SkinSpace& space, const SkinLabels& labels,
                        const VoxelGrid& whole, int threads) {
  const Topology mesh = meshOf(samples, space);
  const TriangleBvh bvh(mesh);
  std::vector<std::uint16_t> of_surface(whole.surface.size());
  parallelRanges(whole.surface.size(), 256, threads, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const glm::dvec3 center = glm::dvec3(voxelAt(whole.size, whole.surface[i].index)) + 0.5;
      const Nearest nearest = bvh.nearest(center);
      std::size_t corner = 0;
      for (std::size_t c = 1; c < 3; ++c)
        if (nearest.weights[static_cast<int>(c)] > nearest.weights[static_cast<int>(corner)]) corner = c;
      of_surface[i] =
          static_cast<std::uint16_t>(labels.parts[mesh.triangles[nearest.triangle].vertex[corner]]);
    }
  });
  VoxelOwners out;
  {
    std::vector<std::uint8_t> is_surface(whole.solid.size(), 0);
    for (const SurfaceSample& sample : whole.surface) is_surface[sample.index] = 1;
    out.surface = fields::nearestSet(is_surface, whole.size, threads);
  }
  // From a surface voxel's place to its number.
  const auto numberOf = [&](std::uint32_t index) {
    const auto at = std::lower_bound(
        whole.surface.begin(), whole.surface.end(), index,
        [](const SurfaceSample& sample, std::uint32_t wanted) { return sample.index < wanted; });
    return static_cast<std::uint32_t>(at - whole.surface.begin());
  };
  out.owner.assign(whole.solid.size(), VoxelOwners::kEmpty);
  parallelRanges(whole.solid.size(), 1 << 16, threads, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      if (!whole.solid[i]) continue;
      out.surface[i] = numberOf(out.surface[i]);
      out.owner[i] = of_surface[out.surface[i]];
    }
  });
  out.counts.assign(labels.joints.size(), 0);
  for (const std::uint16_t part : out.owner)
    if (part != VoxelOwners::kEmpty) ++out.counts[part];
  return out;
}

bool joinSmallParts(const SkinSamples& samples, const SourceSkin& skin,
                    const std::vector<std::uint64_t>& counts, std::uint64_t least, SkinLabels& labels) {
  const std::size_t parts = counts.size();
  const std::vector<Seam> seams = findSeams(samples, labels);
  // The part that each part becomes; a part that stays is itself.
  std::vector<std::uint32_t> into(parts);
  const std::uint64_t largest = *std::max_element(counts.begin(), counts.end());
  bool joined = false;
  for (std::uint32_t p = 0; p < parts; ++p) {
    into[p] = p;
    if (counts[p] >= least || counts[p] == largest) continue;
    const auto isGood = [&](std::uint32_t other) { return other != p && counts[other] >= least; };
    double longest = 0;
    for (const Seam& seam : seams) {
      if (seam.a != p && seam.b != p) continue;
      const std::uint32_t other = seam.a == p ? seam.b : seam.a;
      if (!isGood(other) || seam.length <= longest) continue;
      longest = seam.length;
      into[p] = other;
    }
    for (int above = static_cast<int>(labels.joints[p]); above >= 0 && into[p] == p;
         above = skin.joints[static_cast<std::size_t>(above)].parent)
      for (std::uint32_t other = 0; other < parts && into[p] == p; ++other)
        if (labels.joints[other] == static_cast<std::uint32_t>(above) && isGood(other)) into[p] = other;
    if (into[p] == p)
      into[p] = static_cast<std::uint32_t>(std::max_element(counts.begin(), counts.end()) - counts.begin());
    joined = true;
  }
  if (!joined) return false;
  std::vector<std::uint32_t> place(parts, 0), joints;
  std::vector<SkinChain> chains;
  for (std::uint32_t p = 0; p < parts; ++p) {
    if (into[p] != p) continue;
    place[p] = static_cast<std::uint32_t>(joints.size());
    joints.push_back(labels.joints[p]);
    chains.push_back(std::move(labels.chains[p]));
  }
  for (std::uint32_t& part : labels.parts) part = place[into[part]];
  labels.joints = std::move(joints);
  labels.chains = std::move(chains);
  return true;
}

const SeamSteps::Place& SeamSteps::nearest(const glm::dvec3& at) const {
  const auto squared = [&](const Place& place) { return glm::dot(place.at - at, place.at - at); };
  return *std::min_element(places.begin(), places.end(),
                           [&](const Place& one, const Place& two) { return squared(one) < squared(two); });
}

double SeamSteps::opening(const Place& place, const glm::dvec3& at) const {
  double widest = 0;
  for (const glm::dmat4x3& step : steps[place.motion])
    widest = std::max(widest, glm::dot(at - step * glm::dvec4(at, 1), place.across));
  return widest;
}

std::vector<SeamSteps> stepsAtSeams(const SkinSamples& samples, const SkinMoments& moments,
                                    const SkinSpace& space, const SkinLabels& labels, const PartTree& tree) {
  const PartMotions motions(samples, moments, labels, tree);
  std::vector<SeamSteps> out;
  for (const Seam& seam : findSeams(samples, labels)) {
    SeamSteps& its = out.emplace_back();
    its.a = seam.a;
    its.b = seam.b;
    const std::vector<glm::dvec3> across = waysAcross(samples, labels, seam);
    std::map<std::pair<int, int>, std::uint32_t> numbers;
    for (std::size_t i = 0; i < seam.edges.size(); ++i) {
      const SkinSamples::Edge& edge = samples.edges[seam.edges[i]];
      const glm::dvec3 at = 0.5 * (samples.positions[edge.a] + samples.positions[edge.b]);
      const std::pair<int, int> sections{motions.section(seam.a, at), motions.section(seam.b, at)};
      const auto [number, fresh] = numbers.emplace(sections, static_cast<std::uint32_t>(its.steps.size()));
      if (fresh) {
        const std::vector<glm::dmat4x3> of_a = motions.of(seam.a, sections.first),
                                        of_b = motions.of(seam.b, sections.second);
        its.steps.emplace_back();
        its.back_steps.emplace_back();
        for (std::size_t t = 0; t < of_a.size(); ++t) {
          // What scales leaves its neighbors, and more of their voxels would scale along.
          if (!keepsSize(of_a[t]) || !keepsSize(of_b[t])) continue;
          glm::dmat4x3 step = compose(inverseRigid(of_b[t]), of_a[t]);
          step[3] *= space.voxels;
          its.steps.back().push_back(step);
          its.back_steps.back().push_back(inverseRigid(step));
        }
      }
      its.places.push_back({at * space.voxels, across[i], number->second});
    }
  }
  return out;
}

}  // namespace kelp::bake
