// SPDX-License-Identifier: MIT
// A pack's description for the page, as JSON.
#pragma once

#include <string>

#include "kelp/formats/pack.h"

namespace kelp::web {

// {"bytes", "min", "max", "distances", "parts": [{"name", "kind", "bend", "levels",
// "size", "knots": [{"at", "position", "tangent"}]}], "clips": [{"name", "duration"}]}. Names are
// escaped; of hostile packs too, so the text is always JSON. `box`: of the model at rest.
std::string describe(const Pack& pack, const Box& box);

}  // namespace kelp::web
