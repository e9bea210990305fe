// SPDX-License-Identifier: MIT
#include <hwy/targets.h>

#include "every_target.h"

namespace kelp::test {

void forEveryTarget(const std::function<void(const char*)>& check) {
  for (const std::int64_t target : hwy::SupportedAndGeneratedTargets()) {
    hwy::SetSupportedTargetsForTest(target);
    check(hwy::TargetName(target));
  }
  hwy::SetSupportedTargetsForTest(0);
}

}  // namespace kelp::test
