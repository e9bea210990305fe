// SPDX-License-Identifier: MIT
// The pack's INFO for people: it is JSON by convention, but nothing in a pack is trusted.
#pragma once

#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace kelp::dump {

// One line for each member of the document's object: "source" and "name reed.glb, format glTF 2.0". Empty for text that is no JSON object or
// nested more than a few deep.
std::vector<std::pair<std::string, std::string>> infoLines(std::string_view document);

}  // namespace kelp::dump
