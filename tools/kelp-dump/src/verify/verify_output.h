// SPDX-License-Identifier: MIT
// What `verify` prints.
#pragma once

#include <string>

#include "verify/finding.h"

namespace kelp::dump {

// A line for each finding, and one for the pack.
std::string verifyText(const VerifyReport& report);
std::string verifyJson(const VerifyReport& report);

}  // namespace kelp::dump
