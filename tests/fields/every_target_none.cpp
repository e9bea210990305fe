// SPDX-License-Identifier: MIT
#include "every_target.h"

namespace kelp::test {

void forEveryTarget(const std::function<void(const char*)>& check) { check("plain C++"); }

}  // namespace kelp::test
