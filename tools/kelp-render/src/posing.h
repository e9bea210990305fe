// SPDX-License-Identifier: MIT
// The pose of a pack at a time: rest, then what --tangent and --offset change, then the clip.
#pragma once

#include "kelp/runtime/pose.h"
#include "options.h"

namespace kelp::render {

class Posing {
 public:
  // ToolError: kUsage for a clip, part or knot that is not there.
  Posing(const runtime::Asset& asset, const Item& item);

  // The clip's duration in seconds; 0: there is no clip.
  double duration() const;
  // Sets `pose`, `seconds` after --time. ToolError kInvalid, with part, knots and place,
  // if it turns back or folds.
  void apply(double seconds, runtime::Pose& pose) const;

 private:
  struct Resolved {
    int part = 0;
    const KnotChange* change = nullptr;
  };
  const runtime::Asset& asset_;
  const Item& item_;
  std::vector<Resolved> changes_;
  int clip_ = -1;
};

}  // namespace kelp::render
