// SPDX-License-Identifier: MIT
#include <windows.h>

#include "kelp/common/memory.h"

namespace kelp {

std::uint64_t physicalMemory() {
  MEMORYSTATUSEX status{};
  status.dwLength = sizeof status;
  return ::GlobalMemoryStatusEx(&status) ? status.ullTotalPhys : ~std::uint64_t{0};
}

// Only the baker uses these, and it is not built for Windows.
std::uint64_t peakMemory() { return 0; }
void returnFreedMemory() {}

}  // namespace kelp
