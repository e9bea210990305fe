// SPDX-License-Identifier: MIT
// The JSON forms of `info` and `verify`: kelp-dump.schema.json describes them.
#pragma once

#include <string>

#include "finding.h"
#include "summary.h"

namespace kelp::dump {

std::string infoJson(const Summary& summary);
std::string verifyJson(const VerifyReport& report);

}  // namespace kelp::dump
