// SPDX-License-Identifier: MIT
#include "rebent.h"

#include <fmt/format.h>

#include "kelp/common/pack_error.h"
#include "kelp/rig/raw_clips.h"
#include "kelp/rig/rig.h"

namespace kelp::render {

Rebent::Rebent(const std::string& path, const Source& source, Bend bend) {
  const Pack pack = checkPack(path, Pack::open(source));
  RawRigs rigs{std::string(pack.infoJson()), {}, rawClips(pack), rawSockets(pack)};
  for (const Part& part : pack.parts()) {
    RawRig& rest = rigs.parts.emplace_back(rawRig(part));
    rest.bend = bend;
    if (bend == Bend::kShear) rest.roll = 0;
    try {
      checkRest(rest, part.size);
    } catch (const RigError& error) {
      throw ToolError(Exit::kInvalid, fmt::format("{}: --bend {}: part {}: {}", path, toString(bend),
                                                  part.name, error.what()));
    }
  }
  bytes_.reserve(source.size);
  const Sink sink = Sink::into(bytes_);
  checkPack(path, writeRigs(source, rigs, sink));
}

}  // namespace kelp::render
