// SPDX-License-Identifier: MIT
// The baker without meshes, skins and volumes: what stands in place of those libraries and their dependencies
// in the page's second module. Only MagicaVoxel files come in, and those never get here.
#include <algorithm>

#include "kelp/common/error.h"
#include "kelp/import/import.h"
#include "kelp/skin/skin.h"
#include "kelp/voxelize/voxelize.h"

namespace kelp::bake {
namespace {

[[noreturn]] void refuseMesh() {
  throw ToolError(Exit::kUnsupported, "only MagicaVoxel .vox files are baked in a page; use kelp-bake");
}

}  // namespace

SourceModel importFile(const std::filesystem::path& path, const ImportSettings& settings, FilesUsed* used) {
  return importVox(path, settings, used);
}
VoxelizeResult voxelize(const SourceModel&, const SourcePart&, const Frame&, Fill, int, const Progress&) {
  refuseMesh();
}

}  // namespace kelp::bake
