// SPDX-License-Identifier: MIT
#include "partition.h"

#include <algorithm>
#include <map>
#include <numeric>
#include <utility>

#include "kelp/common/parallel.h"
#include "plan.h"

namespace kelp::bake {
namespace {

constexpr double kLeastWeight = 0.02;  // of a part's joint, for a sample to become the part's
constexpr double kLeastPiece = 30;     // square units; smaller pieces of parts go to their neighbors
constexpr double kLeastFall = 1e-3;    // of the energy, for another round
constexpr int kSweeps = 12, kPieceRounds = 4;

// Half of the samples, others each time.
bool mayMove(std::uint64_t turn, std::uint64_t sample) {  // splitmix64
  std::uint64_t z = (turn << 32) + sample + 0x9e3779b97f4a7c15u;
  z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
  z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
  return ((z ^ (z >> 31)) & 1) != 0;
}

}  // namespace

std::vector<std::vector<std::uint32_t>> SkinLabels::members() const {
  std::vector<std::vector<std::uint32_t>> lists(joints.size());
  for (std::uint32_t i = 0; i < parts.size(); ++i) lists[parts[i]].push_back(i);
  return lists;
}

Partition::Partition(const SkinSamples& samples, const SkinMoments& moments, SkinLabels labels, int threads,
                     const SkinPlan* plan)
    : samples_(samples),
      moments_(moments),
      threads_(threads),
      plan_(plan),
      labels_(std::move(labels)),
      constants_(constantCosts(samples, moments, threads)) {
  removeEmpty();
}

void Partition::removeEmpty() {
  std::vector<std::vector<std::uint32_t>> lists = labels_.members();
  std::vector<std::uint32_t> place(lists.size(), 0), joints;
  std::vector<PartState> kept;
  for (std::size_t p = 0; p < lists.size(); ++p) {
    if (lists[p].empty()) continue;
    place[p] = static_cast<std::uint32_t>(kept.size());
    kept.push_back(p < parts_.size() ? std::move(parts_[p]) : PartState());
    kept.back().members = std::move(lists[p]);
    joints.push_back(labels_.joints[p]);
  }
  parts_ = std::move(kept);
  labels_.joints = std::move(joints);
  for (std::uint32_t& part : labels_.parts) part = place[part];
}

void Partition::fit() {
  parallelRanges(parts_.size(), 1, threads_, [&](std::size_t begin, std::size_t end) {
    for (std::size_t p = begin; p < end; ++p) {
      PartState& part = parts_[p];
      if (part.motion && part.fitted == part.members) continue;
      part.motion.emplace(samples_, moments_, part.members, labels_.joints[p]);
      part.fitted = part.members;
    }
  });
}

// A sample may go to the parts of the joints that move it, and, unless a plan says whose it is, to neighbors
// of its own part.
void Partition::findCandidates() {
  const std::size_t count = parts_.size();
  std::vector<bool> adjacent(count * count, false);
  for (const SkinSamples::Edge& edge : samples_.edges) {
    const std::size_t a = labels_.parts[edge.a], b = labels_.parts[edge.b];
    adjacent[a * count + b] = adjacent[b * count + a] = true;
  }
  std::vector<std::vector<std::uint32_t>> near(count), of_joint(moments_.joints);
  for (std::uint32_t a = 0; a < count; ++a) {
    of_joint[labels_.joints[a]].push_back(a);
    for (std::uint32_t b = 0; b < count; ++b)
      if (a != b && adjacent[a * count + b]) near[a].push_back(b);
  }
  first_candidate_.assign(1, 0);
  candidates_.clear();
  std::vector<std::uint32_t> list;
  for (std::size_t i = 0; i < samples_.size(); ++i) {
    const std::uint32_t own = labels_.parts[i];
    // Samples of a joint that no entry of the plan names may go to any neighbor.
    if (!plan_ || !plan_->named[samples_.heaviestJoint(i)])
      list = near[own];
    else
      list.clear();
    for (std::size_t k = samples_.first_weighted[i]; k < samples_.first_weighted[i + 1]; ++k) {
      const SkinSamples::Weighted& w = samples_.weighted[k];
      if (w.x.w < kLeastWeight) continue;
      for (const std::uint32_t part : of_joint[plan_ ? plan_->lead[w.joint] : w.joint])
        if (part != own) list.push_back(part);
    }
    std::sort(list.begin(), list.end());
    list.erase(std::unique(list.begin(), list.end()), list.end());
    candidates_.push_back({own, 0});
    parts_[own].motion->prepareFor(i, samples_, moments_);
    for (const std::uint32_t part : list) {
      candidates_.push_back({part, 0});
      parts_[part].motion->prepareFor(i, samples_, moments_);
    }
    first_candidate_.push_back(candidates_.size());
  }
  parallelRanges(samples_.size(), 512, threads_, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i)
      for (std::size_t k = first_candidate_[i]; k < first_candidate_[i + 1]; ++k)
        candidates_[k].cost =
            samples_.areas[i] * (parts_[candidates_[k].part].motion->cost(i, samples_) + constants_[i]);
  });
}

double Partition::energy() const {
  double sum = 0;
  for (std::size_t i = 0; i < samples_.size(); ++i) sum += candidates_[first_candidate_[i]].cost;
  for (const SkinSamples::Edge& edge : samples_.edges)
    if (labels_.parts[edge.a] != labels_.parts[edge.b]) sum += kSeamPrice * edge.width;
  return sum;
}

// Iterated conditional modes: each sample takes the part that is cheapest for it and its neighbors. Half of
// them at a time, because neighbors that change places for ever would not settle.
void Partition::relabel(int round) {
  std::vector<std::uint32_t>& now = labels_.parts;
  std::vector<std::uint32_t> next = now;
  for (int sweep = 0; sweep < kSweeps; ++sweep) {
    const auto turn = static_cast<std::uint64_t>(round * kSweeps + sweep);
    parallelRanges(samples_.size(), 512, threads_, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) {
        if (!mayMove(turn, i)) continue;
        double best = 0, present = 0;
        std::uint32_t choice = now[i];
        for (std::size_t k = first_candidate_[i]; k < first_candidate_[i + 1]; ++k) {
          const std::uint32_t part = candidates_[k].part;
          double price = candidates_[k].cost;
          for (std::size_t n = samples_.first_neighbor[i]; n < samples_.first_neighbor[i + 1]; ++n)
            if (now[samples_.neighbors[n].sample] == part) price -= kSeamPrice * samples_.neighbors[n].width;
          if (part == now[i]) present = price;
          if (k == first_candidate_[i] || price < best) {
            best = price;
            choice = part;
          }
        }
        if (best < present - 1e-9) next[i] = choice;
      }
    });
    if (sweep > 3 && next == now) break;
    now = next;
  }
}

double Partition::costOf(std::size_t sample, std::size_t part) {
  parts_[part].motion->prepareFor(sample, samples_, moments_);
  return samples_.areas[sample] * (parts_[part].motion->cost(sample, samples_) + constants_[sample]);
}

// Every piece of a part but the largest goes to a neighbor, and so do parts that are small. True if some
// did.
bool Partition::joinPieces() {
  constexpr std::uint32_t kNoPiece = 0xffffffffu;
  struct Piece {
    std::uint32_t part = 0;
    double area = 0;
    bool stays = false;
    std::vector<std::uint32_t> members;
  };
  std::vector<Piece> pieces;
  std::vector<std::uint32_t> piece_of(samples_.size(), kNoPiece);
  for (std::uint32_t start = 0; start < samples_.size(); ++start) {
    if (piece_of[start] != kNoPiece) continue;
    const auto number = static_cast<std::uint32_t>(pieces.size());
    Piece& piece = pieces.emplace_back();
    piece.part = labels_.parts[start];
    piece.members.push_back(start);
    piece_of[start] = number;
    for (std::size_t k = 0; k < piece.members.size(); ++k) {
      const std::uint32_t i = piece.members[k];
      piece.area += samples_.areas[i];
      for (std::size_t n = samples_.first_neighbor[i]; n < samples_.first_neighbor[i + 1]; ++n) {
        const std::uint32_t other = samples_.neighbors[n].sample;
        if (piece_of[other] != kNoPiece || labels_.parts[other] != piece.part) continue;
        piece_of[other] = number;
        piece.members.push_back(other);
      }
    }
  }
  std::vector<std::uint32_t> largest(labels_.joints.size(), kNoPiece);
  for (std::uint32_t k = 0; k < pieces.size(); ++k) {
    std::uint32_t& best = largest[pieces[k].part];
    if (best == kNoPiece || pieces[k].area > pieces[best].area) best = k;
  }
  for (const std::uint32_t k : largest)
    if (k != kNoPiece) pieces[k].stays = pieces[k].area >= kLeastPiece;
  std::vector<std::uint32_t> order(pieces.size());
  std::iota(order.begin(), order.end(), 0u);
  std::stable_sort(order.begin(), order.end(),
                   [&](std::uint32_t a, std::uint32_t b) { return pieces[a].area < pieces[b].area; });
  bool changed = false;
  for (const std::uint32_t k : order) {
    if (pieces[k].stays) continue;
    std::vector<std::uint32_t> beside;  // parts
    for (const std::uint32_t i : pieces[k].members)
      for (std::size_t n = samples_.first_neighbor[i]; n < samples_.first_neighbor[i + 1]; ++n)
        if (const std::uint32_t other = piece_of[samples_.neighbors[n].sample]; other != k)
          beside.push_back(pieces[other].part);
    std::sort(beside.begin(), beside.end());
    beside.erase(std::unique(beside.begin(), beside.end()), beside.end());
    double least = 0;
    std::uint32_t best = kNoPiece;
    for (const std::uint32_t part : beside) {
      double cost = 0;
      for (const std::uint32_t i : pieces[k].members) cost += costOf(i, part);
      if (best == kNoPiece || cost < least) {
        least = cost;
        best = part;
      }
    }
    if (best == kNoPiece || best == pieces[k].part) continue;
    pieces[k].part = best;
    for (const std::uint32_t i : pieces[k].members) labels_.parts[i] = best;
    changed = true;
  }
  return changed;
}

void Partition::connect() {
  for (int round = 0; round < kPieceRounds && joinPieces();) ++round;
}

void Partition::improve(int rounds) {
  SkinLabels best;
  double least = 0;
  for (int round = 0; round < rounds; ++round) {
    fit();
    findCandidates();
    const double now = energy();
    if (round > 0 && least - now < kLeastFall * least) break;
    least = now;
    best = labels_;
    relabel(round);
    connect();
    std::vector<std::vector<std::uint32_t>> lists = labels_.members();
    for (std::size_t p = 0; p < parts_.size(); ++p) parts_[p].members = std::move(lists[p]);
  }
  labels_ = std::move(best);
  removeEmpty();
}

void Partition::split(std::size_t part, const std::vector<std::uint32_t>& samples) {
  const auto added = static_cast<std::uint32_t>(labels_.joints.size());
  labels_.joints.push_back(labels_.joints[part]);
  for (const std::uint32_t i : samples) labels_.parts[i] = added;
  removeEmpty();
}

void Partition::merge() {
  struct Pair {
    std::uint32_t a = 0, b = 0;
    double width = 0, gain = 0;  // of the seam; of the energy, if the two are joined
  };
  const auto costOfAll = [&](PartMotion motion, const std::vector<std::uint32_t>& members) {
    double sum = 0;
    for (const std::uint32_t i : members) {
      motion.prepareFor(i, samples_, moments_);
      sum += samples_.areas[i] * (motion.cost(i, samples_) + constants_[i]);
    }
    return sum;
  };
  constexpr int kPasses = 8;
  for (int pass = 0; pass < kPasses; ++pass) {
    fit();
    std::map<std::pair<std::uint32_t, std::uint32_t>, double> widths;
    for (const SkinSamples::Edge& edge : samples_.edges)
      if (const auto [a, b] = std::minmax(labels_.parts[edge.a], labels_.parts[edge.b]); a != b)
        widths[{a, b}] += edge.width;
    std::vector<Pair> pairs;
    for (const auto& [pair, width] : widths) pairs.push_back({pair.first, pair.second, width, 0});
    std::vector<double> costs(parts_.size());
    parallelRanges(parts_.size(), 1, threads_, [&](std::size_t begin, std::size_t end) {
      for (std::size_t p = begin; p < end; ++p) costs[p] = costOfAll(*parts_[p].motion, parts_[p].members);
    });
    parallelRanges(pairs.size(), 1, threads_, [&](std::size_t begin, std::size_t end) {
      for (std::size_t k = begin; k < end; ++k) {
        Pair& pair = pairs[k];
        std::vector<std::uint32_t> both = parts_[pair.a].members;
        both.insert(both.end(), parts_[pair.b].members.begin(), parts_[pair.b].members.end());
        const double joined = costOfAll(PartMotion(samples_, moments_, both, labels_.joints[pair.a]), both);
        pair.gain = costs[pair.a] + costs[pair.b] + kSeamPrice * pair.width - joined;
      }
    });
    std::stable_sort(pairs.begin(), pairs.end(),
                     [](const Pair& x, const Pair& y) { return x.gain > y.gain; });
    // Each part once a pass: then its neighbors have changed.
    std::vector<bool> changed(parts_.size(), false);
    bool any = false;
    for (const Pair& pair : pairs) {
      if (!(pair.gain > 0)) break;
      if (changed[pair.a] || changed[pair.b]) continue;
      changed[pair.a] = changed[pair.b] = any = true;
      for (const std::uint32_t i : parts_[pair.b].members) labels_.parts[i] = pair.a;
    }
    if (!any) break;
    removeEmpty();
  }
}

}  // namespace kelp::bake
