// SPDX-License-Identifier: MIT
// The rigs of a pack while they are edited: every state is one that kelp-bake takes, and can be undone.
#pragma once

#include "handles.h"
#include "pack_rig.h"

namespace viewer {

class RigEditor {
 public:
  explicit RigEditor(const kelp::Pack& pack);  // need not outlive the editor

  int parts() const { return static_cast<int>(axes_.size()); }
  const std::string& name(int part) const { return names_[static_cast<std::size_t>(part)]; }
  const kelp::RigDescription& rig(int part) const { return now_.rigs[static_cast<std::size_t>(part)]; }
  const RigAxes& axes(int part) const { return axes_[static_cast<std::size_t>(part)]; }
  const PackRig& realized() const { return now_.realized; }
  int revision() const { return revision_; }  // another number after every change

  // Makes it the part's rig and answers an empty line; or leaves everything as it was and says what is wrong: a spline would turn back. All changes
  // until endGesture() are undone as one.
  std::string change(int part, const kelp::RigDescription& rig);
  void endGesture() { in_gesture_ = false; }
  // Moves a knot, or bends its tangent, by so much (voxels of the part). What would turn the spline back goes sideways only.
  std::string pull(const Handle& handle, const glm::vec3& by);

  bool canUndo() const { return !undo_.empty(); }
  bool canRedo() const { return !redo_.empty(); }
  void undo() { step(undo_, redo_); }
  void redo() { step(redo_, undo_); }
  void reset(int part);  // to what the pack holds; can be undone

  bool unsaved() const;        // any part
  bool unsaved(int part) const { return rig(part) != saved_[static_cast<std::size_t>(part)]; }
  void markSaved(int part) { saved_[static_cast<std::size_t>(part)] = rig(part); }
  std::string text(int part) const { return kelp::printRig(rig(part)); }

  // The pack was baked again: what is not saved stays on top of it. False: it has other parts, and nothing could be kept.
  bool follow(const kelp::Pack& pack);
  // Whether the pack holds these rigs already.
  bool isIn(const kelp::Pack& pack) const { return alike(now_.realized, rigOf(pack), sizes_); }

 private:
  struct State {
    std::vector<kelp::RigDescription> rigs;
    PackRig realized;
  };

  void load(const kelp::Pack& pack);
  void remember();  // now_ can be come back to
  void step(std::vector<State>& from, std::vector<State>& to);

  std::vector<std::string> names_;  // of the parts
  Sizes sizes_;
  std::vector<RigAxes> axes_;
  std::vector<kelp::RigDescription> loaded_, saved_;
  State now_;
  std::vector<State> undo_, redo_;
  bool in_gesture_ = false;
  int revision_ = 0;
};

}  // namespace viewer
