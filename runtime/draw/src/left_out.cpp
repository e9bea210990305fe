// SPDX-License-Identifier: MIT
// The draw list's instances that cannot be drawn: the others are.
#include <algorithm>
#include <cstdio>
#include <utility>

#include "draw_list.h"
#include "record_spline.h"

namespace kelp::draw {

void DrawList::count(Stats& stats) const {
  stats.instances = parts();
  stats.culled = culled_;
  stats.too_small = too_small_;
  stats.waiting = parts_waiting_;
  stats.other_kind = other_kind_;
  stats.left_out = static_cast<std::uint32_t>(left_out_count_);
  stats.first_left_out = first_left_out_;
  stats.clamped = clamped_count_;
}

const Error* DrawList::leaveOut(ResidentAsset& asset, std::uint32_t instance, const char* why) {
  const auto end = left_out_.begin() + left_out_count_;
  const auto place = std::lower_bound(left_out_.begin(), end, instance);
  if (place != end && *place == instance) return nullptr;
  const auto at = static_cast<std::size_t>(place - left_out_.begin());
  if (!left_out_.grow(left_out_count_ + 1)) return &kNoMemoryForFrame;
  std::copy_backward(left_out_.begin() + at, left_out_.begin() + left_out_count_,
                     left_out_.begin() + left_out_count_ + 1);
  left_out_[at] = instance;
  ++left_out_count_;
  if (at == 0) first_left_out_ = {ErrorCode::kMisuse, why, instance, Error::Unit::kInstance};
  if (log_.write && !asset.told_left_out) {
    char text[256];
    std::snprintf(
        text, sizeof text,
        "kelp: instance %u is left out: %s. Stats::left_out counts such instances; this is told once "
        "for each asset.\n",
        static_cast<unsigned>(instance), why);
    log_.write(log_.user, text);
  }
  asset.told_left_out = true;
  return nullptr;
}

// The instance, or one with its pose clamped: it is used until the next call. Null: `error` is set.
const runtime::Instance* DrawList::clampIfUnsound(const Frame& frame, const runtime::Instance& instance,
                                                  const Error*& error) {
  if (instance.unsound != runtime::Unsound::kClamp || !instance.pose ||
      !instance.pose->fits(*instance.asset) || instance.pose->check())
    return &instance;
  error = addBlock(frame);  // it may use the one before
  if (error) return nullptr;
  if (clamped_.asset != instance.asset || !clamped_watch_.alive()) {
    auto made = runtime::Pose::create(*instance.asset, allocator_);
    if (!made) {
      error = &kNoMemoryForFrame;
      return nullptr;
    }
    clamped_pose_ = *std::move(made);
    clamped_watch_ = runtime::AssetWatch(*instance.asset);
  }
  clamped_ = instance;
  clamped_.pose = &clamped_pose_;
  clamped_pose_.assign(*instance.pose).value();
  clamped_pose_.clamp();
  if (!clamped_pose_.check()) return &instance;
  ++clamped_count_;
  return &clamped_;
}

// A part is seen of which nothing is on the GPU: says so where the host has forgotten something.
void DrawList::tellWaiting(ResidentAsset& asset, bool uploaded) const {
  const bool pumped = runtime::PageAccess::wasPumped(*asset.asset);
  bool& told = pumped ? asset.told_unsent : asset.told_unpumped;
  if (!log_.write || told || (pumped && uploaded)) return;
  char text[256];
  std::snprintf(text, sizeof text, "%.128s: nothing %s\n", runtime::PageAccess::name(*asset.asset),
                pumped ? "on the GPU yet; call upload()" : "in memory yet; call Asset::pump()");
  log_.write(log_.user, text);
  told = true;
}

// Bounds eight parts. Parts whose pose cannot be drawn are bounded at rest, and left out.
const Error* DrawList::boundEight(std::size_t eight, std::size_t count) {
  PosedParts& posed = posed_[eight];
  unsigned good = boundParts(posed, placed_[eight]);
  bool again = false;
  for (std::size_t k = 0; k < 8; ++k) {
    Candidate& candidate = block_[8 * eight + std::min(k, count - 1)];
    const Part& part = candidate.asset->packed[candidate.part];
    if (part.bend == Bend::kSweep || !part.cages.empty() || (good >> k & 1)) continue;
    again = true;
    if (k >= count) {  // copies of the one before
      posed.knots[k] = posed.knots[k - 1];
      continue;
    }
    candidate.sound = false;
    if (const Error* const error =
            leaveOut(*candidate.asset, candidate.index, checkKnots(posed.knots[k]).error().detail))
      return error;
    posed.knots[k] = part.knots;
  }
  if (again) (void)boundParts(posed, placed_[eight]);
  return nullptr;
}

// Judges eight parts by bounds that are about theirs.
void DrawList::judgeAbout(const Frame& frame, std::size_t eight, JudgedParts& judged) const {
  PlacedParts about = placed_[eight];  // a copy, because placeParts() adds to the bounds of all eight
  placeParts(frame.projection, posed_[eight], about);
  judgeParts(frame.projection, frame.view, frame.rays, about, judged);
}

// Bounds the swept parts of eight: from about where they are follows how coarse their arcs may be.
const Error* DrawList::boundSwept(const Frame& frame, std::size_t eight, std::size_t count) {
  const auto partOf = [&](std::size_t k) -> const Part& {
    const Candidate& candidate = block_[8 * eight + k];
    return candidate.asset->packed[candidate.part];
  };
  unsigned swept = 0;
  for (std::size_t k = 0; k < count; ++k) {
    if (partOf(k).bend != Bend::kSweep || !partOf(k).cages.empty()) continue;
    swept |= 1u << k;
    setBounds(boxOfKnots(posed_[eight].knots[k], partOf(k).size), posed_[eight], k, placed_[eight]);
  }
  if (swept == 0) return nullptr;
  JudgedParts judged;
  judgeAbout(frame, eight, judged);
  for (std::size_t k = 0; k < count; ++k) {
    if (!(swept >> k & 1)) continue;
    if (const Error* const error = listArcs(eight, k, judged.level.of[k])) return error;
  }
  return nullptr;
}

// Makes the arcs of a swept part that is drawn at about that level, bounds it, and keeps them for its record.
const Error* DrawList::listArcs(std::size_t eight, std::size_t k, float level) {
  PosedParts& posed = posed_[eight];
  Candidate& candidate = block_[8 * eight + k];
  const Part& part = candidate.asset->packed[candidate.part];
  Result<void> made =
      makeDrawnArcs(posed.knots[k], part.kind, part.size, candidate.roll, level, chain_, candidate.tolerance);
  if (!made) {
    candidate.sound = false;
    if (const Error* const error = leaveOut(*candidate.asset, candidate.index, made.error().detail))
      return error;
    made = makeArcs(part.knots, part.size, part.roll, kArcTolerance, chain_);
    if (!made) return nullptr;  // no pack has such a part
  }
  setBounds(chain_.bounds, posed, k, placed_[eight]);
  candidate.arcs = static_cast<std::uint32_t>(chain_.count);
  candidate.arcs_at = arc_texels_;
  arc_texels_ += arcTexels(candidate.arcs);
  if (!arcs_.grow(arc_texels_)) return &kNoMemoryForFrame;
  writeArcs(&arcs_[candidate.arcs_at], chain_);
  return nullptr;
}

// Takes what is listed of left out instances from the list: parts that were sound themselves.
void DrawList::dropLeftOut() {
  if (left_out_count_ == 0) return;
  const auto gone = [this](const Ordered& ordered) {
    const auto* const head = reinterpret_cast<const RecordHead*>(&records_[ordered.texel]);
    return std::binary_search(left_out_.begin(), left_out_.begin() + left_out_count_, head->instance);
  };
  const auto end = std::remove_if(order_.begin(), order_.begin() + count_, gone);
  count_ = static_cast<std::size_t>(end - order_.begin());
}

}  // namespace kelp::draw
