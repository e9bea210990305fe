// SPDX-License-Identifier: MIT
#pragma once

#include <cstdio>
#include <string>

#include "kelp/common/console.h"

namespace kelp::view {

// One line on stderr: "kelp-view: TEXT". Control characters of file names become spaces.
inline void say(const std::string& text) {
  std::fprintf(stderr, "kelp-view: %s\n", console::oneLine(text).c_str());
}

}  // namespace kelp::view
