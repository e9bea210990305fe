// SPDX-License-Identifier: MIT
// The draw list's parts with cages: which cages they are drawn through, and where these are.
#include "draw_list.h"
#include "record_spline.h"

namespace kelp::draw {

// Poses and bounds the parts of eight that have cages. From where the finest is follows which is drawn.
const Error* DrawList::boundCaged(const Frame& frame, std::size_t eight, std::size_t count) {
  unsigned caged = 0;
  for (std::size_t k = 0; k < count; ++k) {
    Candidate& candidate = block_[8 * eight + k];
    if (candidate.asset->packed[candidate.part].cages.empty()) continue;
    if (const Error* const error = poseCage(eight, k, 0, runtime::CageUse::kBounds)) return error;
    caged |= static_cast<unsigned>(candidate.caged) << k;
  }
  if (caged == 0) return nullptr;
  JudgedParts judged;
  judgeAbout(frame, eight, judged);
  for (std::size_t k = 0; k < count; ++k) {
    if (!(caged >> k & 1)) continue;
    Candidate& candidate = block_[8 * eight + k];
    candidate.level = judged.level.of[k];
    const int level = std::max(Detail::of(candidate.level).level, candidate.resident->finest);
    const int last = candidate.resident->levels - 1;
    if (const Error* const error = poseCage(eight, k, std::min(level, last), runtime::CageUse::kCells))
      return error;
    const runtime::PosedCage& posed = candidate.posed;
    cage_texels_ += kHeadTexels + kMotionTexels + 1 + posed.nodes.size() + cageTexels(posed, true);
  }
  return nullptr;
}

// Poses the cage of a part's level, and bounds the part by it.
const Error* DrawList::poseCage(std::size_t eight, std::size_t k, int level, runtime::CageUse use) {
  Candidate& candidate = block_[8 * eight + k];
  const auto posed = runtime::posedCage(*candidate.instance, static_cast<int>(candidate.part), level, use);
  candidate.caged = bool(posed);
  candidate.sound = candidate.sound && candidate.caged;
  if (posed) candidate.posed = *posed;
  setBounds(
      posed ? posed->bounds : Box{glm::vec3(0), glm::vec3(candidate.asset->packed[candidate.part].size)},
      posed_[eight], k, placed_[eight]);
  return candidate.caged ? nullptr : leaveOut(*candidate.asset, candidate.index, posed.error().detail);
}

}  // namespace kelp::draw
