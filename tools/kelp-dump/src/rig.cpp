// SPDX-License-Identifier: MIT
#include <cstdio>
#include <optional>

#include <fmt/format.h>

#include "commands.h"
#include "kelp/rig_json/rig_json.h"
#include "pack_file.h"
#include "part_axis.h"
#include "raw_clips.h"
#include "text.h"

namespace kelp::dump {
int rig(const std::string& path, const std::string& wanted, const std::string& axis_name) {
  const std::optional<Axis> axis = parseAxis(axis_name);
  if (!axis_name.empty() && !axis) throw DumpError(kUsage, fmt::format("--axis {}: expected +x, -x, +y, -y, +z or -z", nameText(axis_name, 40)));
  PackFile file(path);
  const Pack& pack = file.pack();
  const std::uint32_t index = wanted.empty() ? 0 : file.findPart(wanted);
  const Part& part = pack.parts()[index];
  if (wanted.empty() && pack.parts().size() > 1)
    say("{}: has {} parts, this is part 0 '{}'; choose another with --part", file.path(), pack.parts().size(), nameText(part.name));
  try {
    print(printRig(describeRig(part.knots, rawClips(pack), index, part.size, axis ? *axis : bakedAxis(part).value_or(Axis::kPlusY))));
  } catch (const RigError& error) {
    throw DumpError(kInvalid, fmt::format("{}: part {} '{}': {}", file.path(), index, nameText(part.name), error.what()));
  }
  return kOk;
}

}  // namespace kelp::dump
