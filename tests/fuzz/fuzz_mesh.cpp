// SPDX-License-Identifier: MIT
// Any bytes as a mesh. The first says of which format: '0' OBJ, '1' PLY, '2' STL, '3' OFF, '4' Draco. A byte
// 0x01 ends an OBJ file; after it come its MTL library (m.mtl), another 0x01 and a picture (t.png).
#include <algorithm>
#include <array>

#include "exercise_import.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const InputFolder folder;
  if (size == 0) return 0;
  constexpr std::array<const char*, 5> kNames = {"input.obj", "input.ply", "input.stl", "input.off",
                                                 "input.drc"};
  const std::size_t format = (data[0] + kNames.size() - '0' % kNames.size()) % kNames.size();
  std::span<const std::uint8_t> rest(data + 1, size - 1);
  const std::uint64_t choice = choiceOf(rest);
  const auto next = [&] {
    const auto end = std::find(rest.begin(), rest.end(), 1);
    const auto piece = rest.first(static_cast<std::size_t>(end - rest.begin()));
    rest = rest.subspan(std::min(rest.size(), piece.size() + 1));
    return piece;
  };
  std::filesystem::path path;
  if (format == 0) {
    path = folder.write(kNames[0], std::as_bytes(next()));
    folder.write("m.mtl", std::as_bytes(next()));
    folder.write("t.png", std::as_bytes(rest));
  } else {
    path = folder.write(kNames[format], std::as_bytes(rest));
  }
  exerciseImport(path, smallSettings(kMeshBytes), choice);
  return 0;
}
