// SPDX-License-Identifier: MIT
// All importers behind one function.
#pragma once

#include "kelp/import/core/files_used.h"
#include "kelp/import/core/import_settings.h"
#include "kelp/import/core/source_model.h"
#include "kelp/import/gltf/import_gltf.h"
#include "kelp/import/mesh/import_mesh.h"
#include "kelp/import/volume/import_volume.h"
#include "kelp/import/voxels/import_voxels.h"

namespace kelp::bake {

// Chooses the importer by the file's extension and checks the content against it. `used` may be null; it gets
// every file that was opened or looked for. ToolError for what cannot be read. Safe for hostile files.
SourceModel importFile(const std::filesystem::path& path, const ImportSettings& settings,
                       FilesUsed* used = nullptr);

}  // namespace kelp::bake
