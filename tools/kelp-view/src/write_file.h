// SPDX-License-Identifier: MIT
#pragma once

#include <string>
#include <string_view>

namespace kelp::view {

// The file is the old or the new one, whole. Follows links. Answers an empty line, or what is wrong and what
// to do.
std::string writeFile(const std::string& path, std::string_view text);

}  // namespace kelp::view
