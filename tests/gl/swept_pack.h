// SPDX-License-Identifier: MIT
// Packs whose part is swept.
#pragma once

#include "reference/sweep_trials.h"
#include "support/test_pack.h"

namespace kelp::test {

// Bent as the rig has it, at rest.
inline RawPack sweptPackOf(const fields::Occupancy& volume, const reference::SweepRig& rig) {
  RawPack pack = packOf(volume, rig.knots);
  pack.parts[0].bend = Bend::kSweep;
  pack.parts[0].roll = rig.roll;
  return pack;
}
// The named sweep of that index.
inline RawPack sweptPackOf(const fields::Occupancy& volume, std::size_t named) {
  return sweptPackOf(volume, reference::namedSweeps(volume.size)[named]);
}

}  // namespace kelp::test
