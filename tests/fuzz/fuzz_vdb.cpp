// SPDX-License-Identifier: MIT
// Any bytes as a volume: NanoVDB if they begin as such a file, else OpenVDB.
#include <algorithm>
#include <array>

#include "exercise_import.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const InputFolder folder;
  constexpr std::array<std::uint8_t, 7> kNano = {'N', 'a', 'n', 'o', 'V', 'D', 'B'};
  const std::span<const std::uint8_t> bytes(data, size);
  const bool nano = size >= kNano.size() && std::equal(kNano.begin(), kNano.end(), data);
  const std::uint64_t choice = choiceOf(bytes);
  kelp::bake::Settings settings = smallSettings(kVolumeBytes);
  // In its own voxels, or in few.
  settings.resolution_given = choice / 8 % 2 == 0;
  // As the file says, or otherwise.
  settings.volume = static_cast<kelp::bake::VolumeKind>(choice / 16 % 3);
  if (choice / 64 % 4 == 0) settings.grid.emplace("0");
  exerciseImport(folder.write(nano ? "input.nvdb" : "input.vdb", std::as_bytes(bytes)), settings, choice);
  return 0;
}
