// SPDX-License-Identifier: MIT
// Any bytes as a file of voxels: binvox if they begin as such a file; a raw volume if they begin with its
// sidecar, which ends at the first zero byte; else MagicaVoxel.
#include <algorithm>
#include <string_view>

#include "exercise_import.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const InputFolder folder;
  const std::span<const std::uint8_t> bytes(data, size);
  const std::string_view text(reinterpret_cast<const char*>(data), size);
  const std::uint64_t choice = choiceOf(bytes);
  kelp::bake::Settings settings = smallSettings(kVolumeBytes);
  std::filesystem::path path;
  if (text.starts_with("#binvox")) {
    path = folder.write("input.binvox", std::as_bytes(bytes));
  } else if (text.starts_with("{")) {
    const std::size_t sidecar = std::min(text.find('\0'), size);
    folder.write("input.raw.json", std::as_bytes(bytes.first(sidecar)));
    path = folder.write("input.raw", std::as_bytes(bytes.subspan(std::min(size, sidecar + 1))));
    settings.volume = static_cast<kelp::bake::VolumeKind>(choice / 8 % 3);
    settings.resolution_given = choice / 32 % 2 == 0;
  } else {
    path = folder.write("input.vox", std::as_bytes(bytes));
    if (choice / 8 % 2 == 0) settings.parts = kelp::bake::Parts::kNodes;
  }
  exerciseImport(path, settings, choice);
  return 0;
}
