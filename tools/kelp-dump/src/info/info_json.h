// SPDX-License-Identifier: MIT
#pragma once

#include <string>

#include "info/summary.h"

namespace kelp::dump {

// What `info --format json` prints.
std::string infoJson(const Summary& summary);

}  // namespace kelp::dump
