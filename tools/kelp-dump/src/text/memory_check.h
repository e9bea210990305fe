// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <string>

namespace kelp::dump {

// ToolError kRuntime if this machine has less than `needed` bytes of memory: "WHAT needs 3 GiB of memory,
// this machine has 2 GiB; REMEDY".
void requireMemory(std::uint64_t needed, const std::string& what, const std::string& remedy);

}  // namespace kelp::dump
