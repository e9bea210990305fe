// SPDX-License-Identifier: MIT
// The pack's INFO chunk for people. It should be JSON, but need not be: safe for hostile input.
#pragma once

#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace kelp::dump {

// One line for each member of the document: "source" and "name reed.glb, format glTF 2.0". Empty if the text
// is no JSON object, or is nested too deeply.
std::vector<std::pair<std::string, std::string>> infoLines(std::string_view document);

}  // namespace kelp::dump
