// SPDX-License-Identifier: MIT
// The rigs of a pack while they are edited. Every state is one that kelp-bake accepts, and can be undone.
#pragma once

#include "handles.h"
#include "pack_rig.h"

namespace kelp::view {

class RigEditor {
 public:
  explicit RigEditor(const Pack& pack);  // need not outlive the editor

  int parts() const { return static_cast<int>(axes_.size()); }
  const std::string& name(int part) const { return names_[static_cast<std::size_t>(part)]; }
  const RigDescription& rig(int part) const { return now_.rigs[static_cast<std::size_t>(part)]; }
  const RigAxes& axes(int part) const { return axes_[static_cast<std::size_t>(part)]; }
  // The parts as rig files see them.
  const RiggedPack& rigged() const { return rigged_; }
  // Rig files have sides in the rig of their part: that part, and its rig with all of them.
  int partInFile(int part) const;
  RigDescription rigInFile(int part) const;
  const PackRig& realized() const { return now_.realized; }
  int revision() const { return revision_; }  // changes with every edit

  // Replaces the part's rig and answers an empty text. If a sheared part would turn back or a swept one fold,
  // changes nothing and answers what is wrong, and where. All changes until endGesture() are undone as one.
  std::string change(int part, const RigDescription& rig);
  void endGesture() { in_gesture_ = false; }
  // Moves a knot, or bends its tangent, by this much (heights of the part). A move that would turn a sheared
  // part back is reduced to its sideways share. One that would fold a swept part goes a part of the way, so
  // that further ones come as near as it gets.
  std::string pull(const Handle& handle, const glm::vec3& by);

  bool canUndo() const { return !undo_.empty(); }
  bool canRedo() const { return !redo_.empty(); }
  void undo() { step(undo_, redo_); }
  void redo() { step(redo_, undo_); }
  void reset(int part);  // to the rig of the pack; can be undone

  bool unsaved() const;  // any part
  bool unsaved(int part) const { return rig(part) != saved_[static_cast<std::size_t>(part)]; }
  void markSaved(int part);  // and what is in the same rig of the file

  // Call it when the pack was baked again: unsaved changes are kept. False: the pack has other parts now, and
  // the changes are lost.
  bool follow(const Pack& pack);
  // True if the pack holds these rigs already.
  bool isIn(const Pack& pack) const { return alike(now_.realized, rigOf(pack)); }

 private:
  struct State {
    std::vector<RigDescription> rigs;
    PackRig realized;
  };

  void load(const Pack& pack);
  void remember();  // puts now_ onto the undo stack
  void step(std::vector<State>& from, std::vector<State>& to);

  RiggedPack rigged_;
  std::vector<std::string> names_;  // of the parts
  Sizes sizes_;
  std::vector<RigAxes> axes_;
  std::vector<RigDescription> loaded_, saved_;
  State now_;
  std::vector<State> undo_, redo_;
  bool in_gesture_ = false;
  int revision_ = 0;
};

}  // namespace kelp::view
