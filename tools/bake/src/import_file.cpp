// SPDX-License-Identifier: MIT
#include <algorithm>
#include <array>
#include <string_view>

#include "import_files.h"

namespace kelp::bake {
namespace {

// Options that say something of volumes alone.
const char* volumeOption(const Settings& settings) {
  if (settings.grid) return "--grid";
  if (settings.volume != VolumeKind::kAuto) return "--volume";
  if (settings.isovalue) return "--isovalue";
  if (settings.color_grid) return "--color-grid";
  if (settings.heat_grid) return "--heat-grid";
  if (settings.density != 1) return "--density";
  return settings.ramp_file ? "--ramp" : nullptr;
}

}  // namespace

SourceModel importFile(const std::filesystem::path& path, const Settings& settings, std::vector<std::filesystem::path>* files_read) {
  std::error_code error;
  if (std::filesystem::is_directory(path, error)) refuse(Exit::kIo, path, "", "is a folder; name the file in it that is to be baked");
  const std::string extension = lowerExtension(path);
  const bool gltf = extension == ".gltf" || extension == ".glb";
  if (settings.scene && !gltf) refuse(Exit::kUsage, path, "--scene " + oneLine(*settings.scene, 60), "only glTF files have scenes; leave the option out");
  constexpr std::array<std::string_view, 5> kMeshes = {".obj", ".ply", ".stl", ".off", ".drc"};
  const bool mesh = std::find(kMeshes.begin(), kMeshes.end(), extension) != kMeshes.end();
  if (const char* option = volumeOption(settings); option != nullptr && (gltf || mesh)) refuse(Exit::kUsage, path, option, "only volumes have grids and densities; leave the option out");
  if (gltf) return importGltf(path, settings, files_read);
  if (extension == ".vdb" || extension == ".nvdb") return importVdb(path, settings, files_read);
  if (mesh) return importMesh(path, settings, files_read);
  // A path that does not exist is that first: the name may be the mistake, not the type.
  if (!std::filesystem::exists(path, error)) refuse(Exit::kIo, path, "", "no such file; check the path");
  refuse(Exit::kUnsupported, path, "",
         (extension.empty() ? std::string("has no extension") : "the extension '" + oneLine(extension, 20) + "' is not known") +
             "; kelp bakes .gltf, .glb, .obj, .ply, .stl, .off, .drc, .vdb and .nvdb");
}

}  // namespace kelp::bake
