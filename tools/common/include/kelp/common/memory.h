// SPDX-License-Identifier: MIT
// The memory of this machine and of this program.
#pragma once

#include <cstdint>
#include <string>

namespace kelp {

// This machine's physical memory in bytes. If the system does not tell, the largest number.
std::uint64_t physicalMemory();

// The most physical memory that this program has held so far, in bytes. It never decreases. 0 if unknown.
std::uint64_t peakMemory();

// Returns freed memory to the system. OpenVDB's trees free many small pieces. The allocator would keep them,
// and the next stage would allocate more on top.
void returnFreedMemory();

// "1.5 GiB".
std::string printBytes(std::uint64_t bytes);

}  // namespace kelp
