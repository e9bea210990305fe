// SPDX-License-Identifier: MIT
// One pack in a cache: a line "kelp-cache 1 REPORT PACK CHECKSUM" with the sizes of what follows it, the
// report and the pack, and their XXH3-128.
#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "kelp/common/output_file.h"

namespace kelp::bake_cli {

// Writes an entry of a pack that is in its place. ToolError kIo, also if its hash is another by now.
void writeEntry(const std::filesystem::path& entry, const std::string& report,
                const std::filesystem::path& pack, const std::string& pack_hash);

struct Entry {
  std::string report;
  std::uint64_t pack_bytes = 0;
};
// Copies an entry's pack; commit `pack` only if there is an answer: nullopt for an entry that is not there,
// or damaged in any byte. ToolError if `pack` cannot be written.
std::optional<Entry> readEntry(const std::filesystem::path& entry, OutputFile& pack);

}  // namespace kelp::bake_cli
