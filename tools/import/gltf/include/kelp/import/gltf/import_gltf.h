// SPDX-License-Identifier: MIT
// Reads glTF 2.0: .gltf, .glb and .vrm.
#pragma once

#include <filesystem>

#include "kelp/import/core/files_used.h"
#include "kelp/import/core/import_settings.h"
#include "kelp/import/core/source_model.h"

namespace kelp::bake {

SourceModel importGltf(const std::filesystem::path& path, const ImportSettings& settings,
                       FilesUsed* used = nullptr);

}  // namespace kelp::bake
