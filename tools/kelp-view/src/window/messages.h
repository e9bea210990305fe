// SPDX-License-Identifier: MIT
#pragma once

#include <string>

namespace kelp::view {

// One line on stderr: "kelp-view: TEXT". Control characters of file names become spaces.
void say(const std::string& text);

}  // namespace kelp::view
