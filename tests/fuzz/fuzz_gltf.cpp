// SPDX-License-Identifier: MIT
// Any bytes as a .glb, or as a .gltf that holds all of its data.
#include <algorithm>

#include "exercise_import.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const InputFolder folder;
  constexpr std::uint8_t kMagic[] = {'g', 'l', 'T', 'F'};
  const std::span<const std::uint8_t> bytes(data, size);
  const bool binary = size >= sizeof kMagic && std::equal(std::begin(kMagic), std::end(kMagic), data);
  const std::uint64_t choice = choiceOf(bytes);
  kelp::bake::Settings settings = smallSettings(kMeshBytes);
  if (choice / 8 % 4 == 0) settings.parts = kelp::bake::Parts::kNodes;
  exerciseImport(folder.write(binary ? "input.glb" : "input.gltf", std::as_bytes(bytes)), settings, choice);
  return 0;
}
