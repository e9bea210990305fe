// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>

namespace kelp::dump {

// Of this machine, bytes; endless where it can not be known.
std::uint64_t physicalMemory();

}  // namespace kelp::dump
