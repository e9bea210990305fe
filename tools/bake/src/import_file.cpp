// SPDX-License-Identifier: MIT
#include <array>
#include <string_view>

#include "import_files.h"

namespace kelp::bake {

SourceModel importFile(const std::filesystem::path& path, const Settings& settings, std::vector<std::filesystem::path>* files_read) {
  std::error_code error;
  if (std::filesystem::is_directory(path, error)) refuse(Exit::kIo, path, "", "is a folder; name the file in it that is to be baked");
  const std::string extension = lowerExtension(path);
  const bool gltf = extension == ".gltf" || extension == ".glb";
  if (settings.scene && !gltf) refuse(Exit::kUsage, path, "--scene " + oneLine(*settings.scene, 60), "only glTF files have scenes; leave the option out");
  if (settings.frame && extension != ".vox") refuse(Exit::kUsage, path, "--frame " + std::to_string(*settings.frame), "only MagicaVoxel files have frames; leave the option out");
  if (gltf) return importGltf(path, settings, files_read);
  if (extension == ".vdb") return importVdb(path, settings, files_read);
  if (extension == ".vox") return importVox(path, settings, files_read);
  if (extension == ".binvox") return importBinvox(path, settings, files_read);
  if (extension == ".raw") return importRaw(path, settings, files_read);
  constexpr std::array<std::string_view, 5> kMeshes = {".obj", ".ply", ".stl", ".off", ".drc"};
  for (std::string_view known : kMeshes)
    if (extension == known) return importMesh(path, settings, files_read);
  // A path that does not exist is that first: the name may be the mistake, not the type.
  if (!std::filesystem::exists(path, error)) refuse(Exit::kIo, path, "", "no such file; check the path");
  refuse(Exit::kUnsupported, path, "",
         (extension.empty() ? std::string("has no extension") : "the extension '" + oneLine(extension, 20) + "' is not known") +
             "; kelp bakes .gltf, .glb, .obj, .ply, .stl, .off, .drc, .vdb, .vox, .binvox and .raw");
}

}  // namespace kelp::bake
