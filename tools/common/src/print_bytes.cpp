// SPDX-License-Identifier: MIT
#include <fmt/format.h>

#include "kelp/common/memory.h"

namespace kelp {

std::string printBytes(std::uint64_t bytes) {
  const double kib = static_cast<double>(bytes) / 1024.0;
  if (kib < 1024) return fmt::format("{:.1f} KiB", kib);
  if (kib < 1024 * 1024) return fmt::format("{:.1f} MiB", kib / 1024);
  return fmt::format("{:.1f} GiB", kib / (1024 * 1024));
}

}  // namespace kelp
