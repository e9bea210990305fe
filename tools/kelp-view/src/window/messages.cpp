// SPDX-License-Identifier: MIT
#include "window/messages.h"

#include <cstdio>

#include "kelp/common/console.h"

namespace kelp::view {

void say(const std::string& text) { std::fprintf(stderr, "kelp-view: %s\n", console::oneLine(text).c_str()); }

}  // namespace kelp::view
