// SPDX-License-Identifier: MIT
#include "seam_steps.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include "collapse.h"
#include "rigid.h"
#include "sweep_fit.h"

namespace kelp::bake {
namespace {

// Of all parts at all moments: posed <- bind pose.
class PartMotions {
 public:
  PartMotions(const SkinSamples& samples, const SkinMoments& moments, const SkinLabels& labels,
              const PartTree& tree)
      : tree_(tree), rigid_(tree.sweeps.size()), swept_(tree.sweeps.size()) {
    const std::vector<std::vector<std::uint32_t>> members = labels.members();
    for (std::size_t p = 0; p < members.size(); ++p) {
      if (!tree.sweeps[p]) {
        rigid_[p] = fitRigid(samples, moments, members[p], labels.joints[p]);
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
