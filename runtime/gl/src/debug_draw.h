// SPDX-License-Identifier: MIT
// View::debug on the GPU: programs that draw in place of the usual ones, and lines. Nothing here is made
// before it is used.
#pragma once

#include "debug_lines.h"
#include "program.h"
#include "record_textures.h"

namespace kelp::gl {

// True for views that replace the colors of parts; the others but kNone draw lines.
inline bool replacesColors(DebugView debug) {
  return debug == DebugView::kParts || debug == DebugView::kSteps || debug == DebugView::kLevels;
}

class DebugDraw {
 public:
  explicit DebugDraw(const Allocator& allocator) : lines_(allocator) {}
  void destroy(const Api& api);

  // Within an UploadGuard: makes the lines of such a view.
  Result<void> uploadLines(const Api& api, const View& view, const DrawList& list,
                           std::span<const runtime::Instance> instances);
  // Within a DrawGuard: compiles what the view needs.
  Result<void> compile(const Api& api, DebugView debug, const DrawList& list, bool fog, const LogSink& log);

  const Program& solids() const { return solids_; }
  const Program& fog(Bend bend) const { return fog_[bend == Bend::kSweep]; }
  const Program& lines() const { return line_program_; }
  // Draws the lines over the picture, with their program in use and the state set.
  void drawLines(const Api& api) const;

 private:
  Program solids_, fog_[2], line_program_;  // fog by bend
  RecordTextures textures_;
  DebugLines lines_;
};

}  // namespace kelp::gl
