// SPDX-License-Identifier: MIT
// Reads files that are voxels: MagicaVoxel .vox and .binvox.
#pragma once

#include <filesystem>

#include "kelp/import/core/files_used.h"
#include "kelp/import/core/import_settings.h"
#include "kelp/import/core/source_model.h"

namespace kelp::bake {

SourceModel importVox(const std::filesystem::path& path, const ImportSettings& settings,
                      FilesUsed* used = nullptr);
SourceModel importBinvox(const std::filesystem::path& path, const ImportSettings& settings,
                         FilesUsed* used = nullptr);

}  // namespace kelp::bake
