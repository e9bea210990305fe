// SPDX-License-Identifier: MIT
// What kelp-bake's INFO document says about the rig, and what it says once the rig is another one. The document is not trusted to be JSON.
#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "kelp/rig_json/rig_json.h"

namespace kelp::dump {

// Options of kelp-bake that decide what a rig means.
struct BakeOptions {
  std::optional<Axis> axis, up;
  std::int64_t pad = 0;  // empty layers around the part; at the ends of the spline, too, if the rig did not bend
};
// Nothing of a document that can not be read.
std::optional<BakeOptions> bakeOptions(std::string_view info);

// The document that kelp-bake would have written with another --rig, and --axis if it is given; as it is if it holds no options. Of one of several parts, whose name is
// `part` then, kelp-bake takes no --rig: a member "rigs" says by part what was set, and no bake has it.
// `preset`: its name, or empty for a rig file of that name and content.
std::string infoWithRig(std::string_view info, const std::string& part, const std::string& preset, const std::string& file_name, std::string_view file_content, std::optional<Axis> axis);

}  // namespace kelp::dump
