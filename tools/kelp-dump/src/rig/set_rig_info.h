// SPDX-License-Identifier: MIT
// What kelp-bake's INFO document says about the rig, and the document for another rig. Safe for hostile
// input: the document need not be JSON.
#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "kelp/rig/rig.h"

namespace kelp::dump {

// The options of kelp-bake that a rig depends on.
struct BakeOptions {
  std::optional<Axis> axis, up;
  std::optional<Bend> bend;
  // Empty layers around the part. At the ends of the spline too, if the rig does not bend.
  std::int64_t pad = 0;
};
// Nothing if the document cannot be read.
std::optional<BakeOptions> bakeOptions(std::string_view info);

// The document that kelp-bake would have written with another --rig, and with --axis if given. Unchanged if
// it holds no options. kelp-bake takes no --rig for one of several parts: then `part` is the name, and the
// member "rigs", which kelp-bake never writes, says what was set. `preset`: a name, or empty for a rig file
// of that name and content.
std::string infoWithRig(std::string_view info, const std::string& part, const std::string& preset,
                        const std::string& file_name, std::string_view file_content,
                        std::optional<Axis> axis);

}  // namespace kelp::dump
