// SPDX-License-Identifier: MIT
#pragma once

#include "kelp/fields/fields.h"
#include "verify/deep_level.h"

namespace kelp::dump {

// Computes the distances of a level again and compares. ToolError if they cannot be read.
void checkDistances(PackFile& file, const Place& place, const fields::Occupancy& occupancy, int threads,
                    VerifyReport& report);

}  // namespace kelp::dump
