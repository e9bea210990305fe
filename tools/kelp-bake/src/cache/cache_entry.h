// SPDX-License-Identifier: MIT
// One cached pack: a line "kelp-cache 1 REPORT PACK CHECKSUM" (two sizes in bytes and the XXH3-128 of both),
// then the report and the pack.
#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "kelp/common/output_file.h"

namespace kelp::bake_cli {

// Writes an entry for a pack file. Throws ToolError kIo, also if the file's hash has changed.
void writeEntry(const std::filesystem::path& entry, const std::string& report,
                const std::filesystem::path& pack, const std::string& pack_hash);

struct Entry {
  std::string report;
  std::uint64_t pack_bytes = 0;
};
// Copies the entry's pack into `pack` and returns its report. nullopt for a missing or damaged entry: do not
// commit `pack` then. Throws ToolError if `pack` cannot be written.
std::optional<Entry> readEntry(const std::filesystem::path& entry, OutputFile& pack);

}  // namespace kelp::bake_cli
