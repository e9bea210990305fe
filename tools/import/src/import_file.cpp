// SPDX-License-Identifier: MIT
#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <string_view>

#include "kelp/common/error.h"
#include "kelp/import/core/files_used.h"
#include "kelp/import/core/import_settings.h"
#include "kelp/import/core/input_files.h"
#include "kelp/import/core/source_model.h"
#include "kelp/import/gltf/import_gltf.h"
#include "kelp/import/import.h"
#include "kelp/import/mesh/import_mesh.h"
#include "kelp/import/volume/import_volume.h"
#include "kelp/import/voxels/import_voxels.h"

namespace kelp::bake {
namespace {

// Options that say which of a file's grids is meant.
const char* gridOption(const ImportSettings& settings) {
  if (settings.grid) return "--grid";
  if (settings.color_grid) return "--color-grid";
  if (settings.heat_grid) return "--heat-grid";
  return settings.ramp_file ? "--ramp" : nullptr;
}

// Options that say what a density means.
const char* densityOption(const ImportSettings& settings) {
  if (settings.volume != VolumeKind::kAuto) return "--volume";
  if (settings.isovalue) return "--isovalue";
  return settings.density != 1 ? "--density" : nullptr;
}

}  // namespace

SourceModel importFile(const std::filesystem::path& path, const ImportSettings& settings, FilesUsed* used) {
  std::error_code error;
  if (std::filesystem::is_directory(path, error))
    refuse(Exit::kIo, path, "", "is a folder; name the file in it that is to be baked");
  if (std::filesystem::exists(path, error) && !std::filesystem::is_regular_file(path, error))
    refuse(Exit::kIo, path, "",
           "is a pipe or a device; write it to a file first, as inputs are read more than once");
  const std::string extension = lowerExtension(path);
  const bool gltf = extension == ".gltf" || extension == ".glb" || extension == ".vrm";
  if (settings.scene && !gltf)
    refuse(Exit::kUsage, path, "--scene " + oneLine(*settings.scene, 60),
           "only glTF files have scenes; leave the option out");
  if (settings.keep_culled && !gltf)
    refuse(Exit::kUsage, path, "--keep-culled",
           "only glTF files say which surfaces have one side; leave the option out");
  if (settings.frame && extension != ".vox")
    refuse(Exit::kUsage, path, "--frame " + std::to_string(*settings.frame),
           "only MagicaVoxel files have frames; leave the option out");
  constexpr std::array<std::string_view, 5> kMeshes = {".obj", ".ply", ".stl", ".off", ".drc"};
  const bool mesh = std::find(kMeshes.begin(), kMeshes.end(), extension) != kMeshes.end();
  const bool has_grids = extension == ".vdb" || extension == ".nvdb",
             has_density = has_grids || extension == ".raw";
  if (const char* option = gridOption(settings); option && !has_grids)
    refuse(Exit::kUsage, path, option, "only .vdb and .nvdb files have several grids; leave the option out");
  if (const char* option = densityOption(settings); option && !has_density)
    refuse(Exit::kUsage, path, option,
           "only .vdb, .nvdb and .raw files hold densities; leave the option out");
  if (!(settings.density > 0) || !std::isfinite(settings.density))
    refuse(Exit::kUsage, path, "--density " + std::to_string(settings.density),
           "not a factor above 0; 1 leaves densities as they are");
  if (gltf) return importGltf(path, settings, used);
  if (has_grids) return importVdb(path, settings, used);
  if (extension == ".vox") return importVox(path, settings, used);
  if (extension == ".binvox") return importBinvox(path, settings, used);
  if (extension == ".raw") return importRaw(path, settings, used);
  if (mesh) return importMesh(path, settings, used);
  // A path that does not exist is that first: the name may be the mistake, not the type.
  if (!std::filesystem::exists(path, error)) refuse(Exit::kIo, path, "", "no such file; check the path");
  refuse(Exit::kUnsupported, path, "",
         (extension.empty() ? std::string("has no extension")
                            : "the extension '" + oneLine(extension, 20) + "' is not known") +
             "; kelp bakes .gltf, .glb, .vrm, .obj, .ply, .stl, .off, .drc, .vdb, .nvdb, .vox, .binvox and "
             ".raw");
}

}  // namespace kelp::bake
