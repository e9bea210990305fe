// SPDX-License-Identifier: MIT
// The baker without meshes, skins and volumes: what stands in place of those libraries and their dependencies
// in the page's second module. Only MagicaVoxel files come in, and those never get here.
#include "kelp/bake/bake.h"
#include "kelp/common/error.h"
#include "kelp/voxelize/voxelize.h"
#include "steps.h"

namespace kelp::bake {
namespace {

[[noreturn]] void refuseMesh() {
  throw ToolError(Exit::kUnsupported, "only MagicaVoxel .vox files are baked in a page; use kelp-bake");
}

}  // namespace

SourceModel importFile(const std::filesystem::path& path, const ImportSettings& settings, FilesUsed* used) {
  return importVox(path, settings, used);
}

MeshCounts countMesh(const TriangleSoup&, int) { return {}; }  // of voxels, too: there are no triangles
VoxelizeResult voxelize(const SourceModel&, const SourcePart&, const Frame&, Fill, int, const Progress&) {
  refuseMesh();
}
std::vector<glm::vec3> readPalette(const std::filesystem::path&, FilesUsed*) { refuseMesh(); }
void requirePlan(const SourcePart&, const std::filesystem::path&) { refuseMesh(); }
void countSkin(const SourceSkin&, PartSize&) { refuseMesh(); }
void limitSkin(SourceModel&, Report&) { refuseMesh(); }
SkinnedBody divideSkinnedPart(SourceModel&, const Frame&, const Settings&, int, const Progress&, Report&) {
  refuseMesh();
}
void reportFits(const std::vector<SkinFit>&, Report&) { refuseMesh(); }

}  // namespace kelp::bake
