// SPDX-License-Identifier: MIT
#include "machine.h"

#include <unistd.h>

namespace kelp::dump {

std::uint64_t physicalMemory() {
  const long pages = sysconf(_SC_PHYS_PAGES), bytes = sysconf(_SC_PAGE_SIZE);
  return pages > 0 && bytes > 0 ? static_cast<std::uint64_t>(pages) * static_cast<std::uint64_t>(bytes) : ~std::uint64_t{0};
}

}  // namespace kelp::dump
