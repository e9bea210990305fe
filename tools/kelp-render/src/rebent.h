// SPDX-License-Identifier: MIT
// --bend: a pack in memory whose parts all bend in one way, whatever their rigs say.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "kelp/formats/source.h"
#include "kelp/formats/spline.h"

namespace kelp::render {

class Rebent {
 public:
  // Reads the pack `path` whole. ToolError kInvalid, with part, knot and place, if a rest rig cannot bend so.
  // A part that becomes sheared loses its roll.
  Rebent(const std::string& path, const Source& source, Bend bend);

  // Valid as long as this object.
  Source source() const { return MemorySource(bytes_).source(); }

 private:
  std::vector<std::byte> bytes_;
};

}  // namespace kelp::render
