// SPDX-License-Identifier: MIT
// Runs a check once for each instruction set that Highway finds on this machine; once where the library is
// built without it.
#pragma once

#include <functional>

namespace kelp::test {

void forEveryTarget(const std::function<void(const char* name)>& check);

}  // namespace kelp::test
