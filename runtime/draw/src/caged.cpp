// SPDX-License-Identifier: MIT
// The draw list's parts with cages: which cages they are drawn through, and where these are.
#include "draw_list.h"
#include "record_spline.h"

namespace kelp::draw {

// Poses and bounds the parts of eight that have cages. From where the finest is follows which are drawn.
const Error* DrawList::boundCaged(const Frame& frame, std::size_t eight, std::size_t count) {
  unsigned caged = 0;
  for (std::size_t k = 0; k < count; ++k) {
    Candidate& candidate = block_[8 * eight + k];
    const Part& part = candidate.asset->packed[candidate.part];
    if (part.cages.empty()) continue;
    if (const Error* const error = poseCages(eight, k, {0, 1}, runtime::CageUse::kBounds)) return error;
    caged |= static_cast<unsigned>(candidate.sound) << k;
  }
  if (caged == 0) return nullptr;
  JudgedParts judged;
  judgeAbout(frame, eight, judged);
  for (std::size_t k = 0; k < count; ++k) {
    if (!(caged >> k & 1)) continue;
    Candidate& candidate = block_[8 * eight + k];
    candidate.level = judged.level.of[k];
    const bool one = frame.rays == Rays::kAny || frame.rings;
    const CageChoice choice = CageChoice::of(candidate.asset->packed[candidate.part], candidate.level,
                                             candidate.resident->finest, one);
    if (const Error* const error = poseCages(eight, k, choice, runtime::CageUse::kCells)) return error;
    for (int i = 0; i < candidate.cages; ++i) {
      const runtime::PosedCage& posed = candidate.posed[i];
      cage_texels_ += kHeadTexels + kMotionTexels + 1 + posed.nodes.size() + cageTexels(posed, true);
    }
  }
  return nullptr;
}

// Poses the cages of a part, and bounds it by them.
const Error* DrawList::poseCages(std::size_t eight, std::size_t k, const CageChoice& choice,
                                 runtime::CageUse use) {
  Candidate& candidate = block_[8 * eight + k];
  const Part& part = candidate.asset->packed[candidate.part];
  Box box;
  candidate.cage = choice.first;
  candidate.cages = choice.count;
  for (int i = 0; i < choice.count; ++i) {
    const auto posed =
        runtime::posedCage(*candidate.instance, static_cast<int>(candidate.part), choice.first + i, use);
    if (!posed) {
      candidate.sound = false;
      candidate.cages = 0;
      box = {glm::vec3(0), glm::vec3(part.size)};
      if (const Error* const error = leaveOut(*candidate.asset, candidate.index, posed.error().detail))
        return error;
      break;
    }
    candidate.posed[i] = *posed;
    box.add(posed->bounds.min);
    box.add(posed->bounds.max);
  }
  setBounds(box, posed_[eight], k, placed_[eight]);
  return nullptr;
}

// Of the cages that are posed, those that draw a pixel at the level that is chosen.
void DrawList::chooseCages(Candidate& candidate) {
  runtime::PosedCage(&posed)[2] = candidate.posed;
  candidate.detail =
      servedDetail(candidate.detail, posed[0].cage->first_level, posed[candidate.cages - 1].cage->last_level);
  if (candidate.cages < 2) return;
  const int last = posed[0].cage->last_level;
  if (candidate.detail.level > last) {
    posed[0] = posed[1];
    ++candidate.cage;
    candidate.cages = 1;
  } else if (candidate.detail.level < last || candidate.detail.coarser == 0) {
    candidate.cages = 1;
  }
}

}  // namespace kelp::draw
