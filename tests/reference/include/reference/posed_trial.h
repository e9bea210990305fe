// SPDX-License-Identifier: MIT
// A caged volume in a pose, as the tracing core reads it. Include from .cpp files only.
#pragma once

#include <span>
#include <vector>

#include "reference/cage_trials.h"
#include "reference/cage_truth.h"
#include "trace_cpp.h"

namespace kelp::reference {

class PosedTrial {
 public:
  // The volume must outlive it.
  PosedTrial(const CagedVolume& volume, const CagePose& pose, unsigned seed);

  const trace::Context& context() const { return context_; }
  const CageTruth& truth() const { return *truth_; }
  const Cage& cage() const { return volume_.cage(); }
  const Box& bounds() const { return bounds_; }
  glm::dvec3 node(std::uint32_t i) const { return glm::dvec3(nodes_[i]); }
  // Where a corner of the lattice is that is no node.
  glm::vec3 corner(const glm::ivec3& place) const;

 private:
  glm::vec3 shaken(const glm::dvec3& rest, std::uint32_t number) const;
  void makeTree();
  void makeLevels();
  void makeTruth();

  const CagedVolume& volume_;
  CagePose pose_;
  unsigned seed_;
  std::vector<glm::vec3> nodes_;
  Box bounds_;
  std::vector<glm::vec3> boxes_;
  std::vector<trace::Level> levels_;
  std::vector<std::uint8_t> solid_, coarser_;  // as drawn, where bricks are missing
  std::unique_ptr<CageTruth> truth_;
  trace::Context context_;
};

// The nearest hit of the walks from the faces by which a ray enters, ascending, as a rasterizer finds them
// that draws the nearer ones first. s: how far it is, 1e30: nowhere.
trace::KelpHit walkCaged(const trace::Context& context, std::span<const CageTruth::Start> starts,
                         const glm::vec3& o, const glm::vec3& r, float s_max, double& s);

// True if the brick of a stored cell is resident in trials where some are missing.
bool isResident(std::uint32_t cell, int level);

}  // namespace kelp::reference
