// SPDX-License-Identifier: MIT
// Lloyd's iteration over the samples of a skin: parts get the motions that fit their samples best, samples
// go to the parts that fit them best.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "collapse.h"
#include "decompose.h"

namespace kelp::bake {

// The cost of a unit of a seam's length: as much as a unit of area at a distance of 1.
inline constexpr double kSeamPrice = 1;

struct SkinPlan;

class Partition {
 public:
  // With a plan, samples only go to parts whose group moves them.
  Partition(const SkinSamples& samples, const SkinMoments& moments, SkinLabels labels, int threads,
            const SkinPlan* plan = nullptr);

  // Rounds of fitting and labeling, as long as the energy falls: the sum of areas times costs, and the
  // length of the seams. Parts that lose all samples are removed.
  void improve(int rounds);

  // Joins neighbors as long as that lowers the energy: parts that move alike.
  void merge();

  // Gives some samples of a part to a new part of the same joint.
  void split(std::size_t part, const std::vector<std::uint32_t>& samples);

  // The best way to cut a part in two: the half that leaves, and the squared distance times area that it
  // saves, in the mean over the moments. 0: none.
  struct Cut {
    double gain = 0;
    std::vector<std::uint32_t> half;
  };
  // That of every part. Parts that have not changed since are not looked at again.
  const Cut& cutOf(std::size_t part) const { return parts_[part].cut; }
  void findCuts();

  // The worst clip's mean distance, and the distance that 95 % of the surface keeps.
  struct Distances {
    double mean = 0, p95 = 0;
  };
  Distances worstClip();

  std::size_t parts() const { return parts_.size(); }
  const SkinLabels& labels() const { return labels_; }

 private:
  struct PartState {
    std::vector<std::uint32_t> members, fitted, cut_for;  // now; when it was fitted; when its cut was found
    std::optional<PartMotion> motion;
    Cut cut;
  };
  struct Candidate {
    std::uint32_t part = 0;
    double cost = 0;  // area times the mean squared distance
  };

  void fit();
  void findCandidates();
  double energy() const;
  void relabel(int round);
  void connect();
  bool joinPieces();
  void removeEmpty();
  double costOf(std::size_t sample, std::size_t part);
  Cut findCut(std::size_t part) const;

  const SkinSamples& samples_;
  const SkinMoments& moments_;
  int threads_;
  const SkinPlan* plan_;
  SkinLabels labels_;
  std::vector<PartState> parts_;
  std::vector<double> constants_;
  // of each sample, and the end; each sample's own part is the first
  std::vector<std::size_t> first_candidate_;
  std::vector<Candidate> candidates_;
};

}  // namespace kelp::bake
