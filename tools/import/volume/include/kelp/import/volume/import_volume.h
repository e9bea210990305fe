// SPDX-License-Identifier: MIT
// Reads volumes: OpenVDB, NanoVDB and raw ones.
#pragma once

#include <filesystem>

#include "kelp/import/core/files_used.h"
#include "kelp/import/core/import_settings.h"
#include "kelp/import/core/source_model.h"

namespace kelp::bake {

// .vdb and .nvdb.
SourceModel importVdb(const std::filesystem::path& path, const ImportSettings& settings,
                      FilesUsed* used = nullptr);
// .raw, with a JSON file beside it that says what it holds.
SourceModel importRaw(const std::filesystem::path& path, const ImportSettings& settings,
                      FilesUsed* used = nullptr);

}  // namespace kelp::bake
