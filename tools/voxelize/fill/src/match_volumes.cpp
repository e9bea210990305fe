// SPDX-License-Identifier: MIT
#include "kelp/voxelize/fill/fill.h"

#include <algorithm>
#include <cmath>
#include <tuple>

#include "change_rules.h"

namespace kelp::bake {
namespace {

// These numbers were set with tests/voxelize: slender_test (rods of 0.6 to 3 voxels' radius in five
// directions, boxes, plates and blades of a voxel) and truth_test (real meshes at 256 voxels).

// The voxels of all bodies together may differ by this share from their volume. Bodies whose rounding evens
// out keep within it without any change: a sphere of 128 voxels does.
constexpr double kSlack = 0.005;
// A body's own volume is not what is seen if more than this share of its surface lies within or against
// others.
constexpr double kMaxShared = 0.05;
// The volume of a body is a guess if caps are more than this share of its surface.
constexpr double kMaxCaps = 0.01;
// This many voxels at one height are a flat side along the grid. It changes as a whole.
constexpr std::size_t kFlat = 32;
// Only voxels whose centers are nearer than this to the surface change, in voxels. At half a voxel a flat
// side would move by a whole one.
constexpr float kReach = 0.49f;

// The number of voxels that the bodies have too many; below 0, too few. Bodies within others do not count.
class Surplus {
 public:
  // kKept voxels are not counted yet: which body they belong to is found later (addKept).
  Surplus(const Topology& mesh, const std::vector<Scanned>& scanned) : bodies_(mesh.components.size()) {
    for (std::size_t c = 0; c < bodies_.size(); ++c) {
      const Component& component = mesh.components[c];
      if (!component.solid || component.thin || component.cap_area > kMaxCaps * component.area ||
          static_cast<double>(scanned[c].shared) > kMaxShared * static_cast<double>(scanned[c].faces))
        continue;
      Body& body = bodies_[c];
      body.counts = true;
      // The scanlines tell how much of the volume the component holds twice.
      body.volume = std::abs(component.volume) -
                    static_cast<double>(scanned[c].wound - scanned[c].length) * kLatticeStep;
      body.surplus = static_cast<double>(scanned[c].centers) - body.volume;
    }
    sum();
  }

  // Adds the kKept voxels to the bodies that they are near, and drops bodies that sheets lie against.
  void addKept(const ChangeRules& rules, const std::vector<std::uint64_t>& touched,
               const std::vector<std::uint8_t>& voxels) {
    std::vector<std::size_t> nears(bodies_.size(), 0), sheets(bodies_.size(), 0);
    for (std::size_t i = 0; i < touched.size(); ++i) {
      const ChangeRules::Near& near = rules.near(i);
      if (near.component == kCap) continue;
      ++nears[near.component];
      if (near.sheet) ++sheets[near.component];
      if (voxels[touched[i]] == kKept) bodies_[near.component].surplus += 1;
    }
    for (std::size_t c = 0; c < bodies_.size(); ++c) {
      if (static_cast<double>(sheets[c]) > kMaxShared * static_cast<double>(nears[c]))
        bodies_[c].counts = false;
    }
    sum();
  }

  bool counts(std::uint32_t component) const { return bodies_[component].counts; }
  double volume() const { return volume_; }
  double all() const { return all_; }
  // `more`: voxels that may change it yet.
  bool isSettled(double more = 0) const { return std::abs(all_) + more <= kSlack * volume_; }
  // True if a change by so many voxels brings a body, and all together, nearer to its volume.
  bool wants(std::uint32_t component, double voxels) const {
    const double body = bodies_[component].surplus;
    return std::abs(body + voxels) <= std::abs(body) && std::abs(all_ + voxels) <= std::abs(all_);
  }
  void change(std::uint32_t component, double voxels) {
    bodies_[component].surplus += voxels;
    all_ += voxels;
  }

 private:
  struct Body {
    bool counts = false;
    double volume = 0, surplus = 0;  // voxels
  };
  void sum() {
    all_ = volume_ = 0;
    for (const Body& body : bodies_) {
      if (!body.counts) continue;
      all_ += body.surplus;
      volume_ += body.volume;
    }
  }

  std::vector<Body> bodies_;
  double all_ = 0, volume_ = 0;  // of the bodies that count
};

// Takes voxels from bodies (`goes`), or adds some, until the surplus is settled.
class VolumeChange {
 public:
  VolumeChange(const ChangeRules& rules, const std::vector<std::uint64_t>& touched, Surplus& surplus,
               std::vector<std::uint8_t>& voxels)
      : rules_(rules), touched_(touched), surplus_(surplus), voxels_(voxels), goes_(surplus.all() > 0) {}

  void run() {
    const std::vector<std::size_t> order = candidates();
    for (std::size_t begin = 0, end = 0; begin < order.size() && !surplus_.isSettled(); begin = end) {
      // A flat side along the grid changes as a whole: in part it would get a step.
      const ChangeRules::Near& its = rules_.near(order[begin]);
      while (end < order.size() && rules_.near(order[end]).sameSide(its)) ++end;
      changeSide({order.begin() + static_cast<std::ptrdiff_t>(begin),
                  order.begin() + static_cast<std::ptrdiff_t>(end)});
    }
  }

 private:
  // Touched voxels that may go or come, those nearest to the surface first: of those that go the highest, of
  // those that come the lowest. Voxels of one side are adjacent.
  std::vector<std::size_t> candidates() const {
    std::vector<std::size_t> order;
    for (std::size_t i = 0; i < touched_.size(); ++i) {
      const ChangeRules::Near& near = rules_.near(i);
      if (near.component != kCap && surplus_.counts(near.component) && !near.sheet &&
          std::abs(near.height) <= kReach && rules_.isSolidAt(touched_[i]) == goes_)
        order.push_back(i);
    }
    std::sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
      const ChangeRules::Near &its = rules_.near(a), &other = rules_.near(b);
      if (its.height != other.height) return (its.height > other.height) == goes_;
      return std::tie(its.component, its.below, a) < std::tie(other.component, other.below, b);
    });
    return order;
  }

  // Changes the voxels of a side that may change: none if that leads away from the volume, and none of a flat
  // side that could only go in part.
  void changeSide(std::vector<std::size_t> side) {
    const ChangeRules::Near& its = rules_.near(side.front());
    const bool flat = goes_ && side.size() >= kFlat;
    if (flat) {
      // Some may have gone already, as the edge of another side.
      std::erase_if(side, [&](std::size_t i) { return !rules_.isSolidAt(touched_[i]); });
      if (side.empty()) return;
      rules_.addEdges(side);
    }
    const double sign = goes_ ? -1 : 1;
    if (!surplus_.wants(its.component, static_cast<double>(side.size()) * sign)) return;
    const std::vector<Changed> changed = changeEach(side, its.below);
    if (goes_ && side.size() >= kFlat && changed.size() < side.size()) {
      for (const Changed& voxel : changed) voxels_[voxel.index] = voxel.was;
      return;
    }
    surplus_.change(its.component, static_cast<double>(changed.size()) * sign);
  }

  struct Changed {
    std::uint64_t index;
    std::uint8_t was;
  };
  // One after the other, since each decides what its neighbors may do.
  std::vector<Changed> changeEach(const std::vector<std::size_t>& side, int below) {
    std::vector<std::uint8_t> rim(side.size(), 0);
    for (std::size_t at = 0; goes_ && at < side.size(); ++at) rim[at] = rules_.isRim(side[at], below) ? 1 : 0;
    std::vector<Changed> changed;
    for (std::size_t at = 0; at < side.size(); ++at) {
      const std::uint64_t index = touched_[side[at]];
      if (rules_.isSolidAt(index) != goes_ || rim[at] || !rules_.mayChange(side[at], below)) continue;
      changed.push_back({index, voxels_[index]});
      voxels_[index] = goes_ ? kEmpty : kKept;
    }
    return changed;
  }

  const ChangeRules& rules_;
  const std::vector<std::uint64_t>& touched_;
  Surplus& surplus_;
  std::vector<std::uint8_t>& voxels_;
  bool goes_;
};

}  // namespace

void matchVolumes(const Topology& mesh, const std::vector<Scanned>& scanned, const TriangleBvh& bvh,
                  const std::vector<std::uint64_t>& touched, const glm::ivec3& size, int threads,
                  std::vector<std::uint8_t>& voxels, const Step& step) {
  Surplus surplus(mesh, scanned);
  const auto kept = std::count_if(touched.begin(), touched.end(),
                                  [&](std::uint64_t index) { return voxels[index] == kKept; });
  if (surplus.volume() <= 0 || surplus.isSettled(static_cast<double>(kept))) return;
  ChangeRules rules(mesh, bvh, touched, size, voxels);
  rules.findNear(threads, step);
  surplus.addKept(rules, touched, voxels);
  if (!surplus.isSettled()) VolumeChange(rules, touched, surplus, voxels).run();
}

}  // namespace kelp::bake
