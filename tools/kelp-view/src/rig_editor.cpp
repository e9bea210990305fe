// SPDX-License-Identifier: MIT
#include "rig_editor.h"

#include <utility>

namespace kelp::view {
namespace {

constexpr std::size_t kMostSteps = 500;
constexpr float kLeastShare = 1.0f / 64;  // of a move that would fold a swept part

// Rounded to what a hand can do, so that files stay readable.
glm::vec3 rounded(const glm::vec3& v) { return glm::round(v * 1e5f) / 1e5f + 0.0f; }

std::vector<std::string> namesOf(const Pack& pack) {
  std::vector<std::string> names;
  for (const Part& part : pack.parts()) names.emplace_back(part.name);
  return names;
}

}  // namespace

RigEditor::RigEditor(const Pack& pack) {
  load(pack);
  now_ = {loaded_, realize(loaded_, axes_)};
  saved_ = loaded_;
}

void RigEditor::load(const Pack& pack) {
  rigged_ = RiggedPack(pack);
  names_ = namesOf(pack);
  sizes_ = sizesOf(pack);
  axes_.clear();
  loaded_.clear();
  const PackRig rig = rigOf(pack);
  for (int part = 0; part < static_cast<int>(pack.parts().size()); ++part) {
    axes_.push_back(axesOf(pack, rigged_, part));
    loaded_.push_back(describe(rig, part, axes_.back()));
  }
}

int RigEditor::partInFile(int part) const {
  const auto& side = rigged_.sides[static_cast<std::size_t>(part)];
  return side ? static_cast<int>(side->of) : part;
}

RigDescription RigEditor::rigInFile(int part) const {
  const auto of = static_cast<std::uint32_t>(partInFile(part));
  RigDescription all = now_.rigs[of];
  for (std::size_t other = 0; other < now_.rigs.size(); ++other)
    if (const auto& side = rigged_.sides[other];
        side && side->of == of && side->corner == RiggedPack::kSections)
      addSections(now_.rigs[other], all);
    else if (side && side->of == of && side->corner >= 0)
      all.sides.push_back(
          {cornerName(side->corner, rigged_.axes[of]), now_.rigs[other].knots, now_.rigs[other].clips});
  return all;
}

void RigEditor::markSaved(int part) {
  for (int other = 0; other < parts(); ++other)
    if (partInFile(other) == partInFile(part)) saved_[static_cast<std::size_t>(other)] = rig(other);
}

void RigEditor::remember() {
  if (!in_gesture_) {
    undo_.push_back(now_);
    if (undo_.size() > kMostSteps) undo_.erase(undo_.begin());
  }
  in_gesture_ = true;
  redo_.clear();
}

std::string RigEditor::change(int part, const RigDescription& wanted) {
  if (wanted == rig(part)) return {};
  const auto changed = static_cast<std::size_t>(part);
  if (rigged_.sides[changed] && rigged_.sides[changed]->corner == -1)
    return "it moves as '" + name(partInFile(part)) + "' does: change that";
  State next{now_.rigs, {}};
  next.rigs[changed] = wanted;
  for (std::size_t other = 0; other < next.rigs.size(); ++other)
    if (rigged_.sides[other] == RiggedPack::Side{static_cast<std::uint32_t>(part), -1})
      next.rigs[other] = ownSide(wanted);
  try {
    // A rig that the file could not hold is refused now, with the baker's words.
    (void)parseRig(printRig(wanted));
    next.realized = realize(next.rigs, axes_);
    prove(next.realized, sizes_);
  } catch (const RigError& error) {
    return error.what();
  }
  remember();
  now_ = std::move(next);
  ++revision_;
  return {};
}

std::string RigEditor::pull(const Handle& handle, const glm::vec3& by) {
  const auto part = static_cast<std::size_t>(handle.part), knot = static_cast<std::size_t>(handle.knot);
  const RigAxes& stands = axes_[part];
  const glm::mat3 to_artist = glm::inverse(stands.turn * axisRotation(stands.axis));
  const auto pulled = [&](const glm::vec3& by_heights) {
    RigDescription next = rig(handle.part);
    RigDescription::Knot& moved = next.knots[knot];
    if (handle.kind == Handle::Kind::kKnot) {
      moved.offset = rounded(moved.offset + to_artist * by_heights);
    } else {
      moved.tangent = rounded(to_artist * (now_.realized.parts[part].knots[knot].tangent + by_heights));
    }
    return change(handle.part, next);
  };
  const std::string wrong = pulled(by);
  if (wrong.empty()) return {};
  if (rig(handle.part).bend != Bend::kSweep) return pulled({by.x, 0, by.z}).empty() ? std::string() : wrong;
  for (float share = 0.5f; share >= kLeastShare; share *= 0.5f) {
    if (pulled(share * by).empty()) return {};
  }
  return wrong;
}

void RigEditor::step(std::vector<State>& from, std::vector<State>& to) {
  if (from.empty()) return;
  to.push_back(std::exchange(now_, std::move(from.back())));
  from.pop_back();
  in_gesture_ = false;
  ++revision_;
}

void RigEditor::reset(int part) {
  endGesture();
  (void)change(part, loaded_[static_cast<std::size_t>(part)]);
  endGesture();
}

bool RigEditor::unsaved() const {
  for (int part = 0; part < parts(); ++part) {
    if (unsaved(part)) return true;
  }
  return false;
}

bool RigEditor::follow(const Pack& pack) {
  const bool same_parts = namesOf(pack) == names_;
  const bool had_unsaved = unsaved();
  const int revision = revision_ + 1;
  const auto anew = [&] {
    *this = RigEditor(pack);
    revision_ = revision;
    return !had_unsaved;
  };
  if (!same_parts) return anew();
  load(pack);
  // All states in voxels of the new pack: it may be baked finer.
  const auto again = [&](State& state) {
    try {
      state.realized = realize(state.rigs, axes_);
      prove(state.realized, sizes_);
      return true;
    } catch (const RigError&) {
      return false;  // a hair within what the proof takes, and baked a little shorter
    }
  };
  std::erase_if(undo_, [&](State& state) { return !again(state); });
  std::erase_if(redo_, [&](State& state) { return !again(state); });
  State kept = now_;
  if (!again(kept) || (!had_unsaved && !alike(kept.realized, rigOf(pack)))) return anew();
  now_ = std::move(kept);
  revision_ = revision;
  if (alike(now_.realized, rigOf(pack))) saved_ = now_.rigs;  // baked as it was saved
  return true;
}

}  // namespace kelp::view
