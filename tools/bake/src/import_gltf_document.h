// SPDX-License-Identifier: MIT
// A glTF file before its meaning is read: container opened, JSON bounded, buffers in memory, compressed data unpacked.
// After this stage the file is plain glTF 2.0: no extension that hides geometry, no reference to anything outside.
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "import_files.h"

namespace kelp::bake {

struct GltfDocument {
  struct ImageSource {
    std::string name;
    std::string uri;       // empty: in a buffer view
    int buffer_view = -1;
  };
  std::string json;                                  // without `buffers` and `images`: those are below
  std::vector<std::vector<std::uint8_t>> buffers;
  std::vector<ImageSource> images;
  std::map<std::string, std::string> rigs;           // the text of every extras.kelp, by its owner: "nodes[3]", "asset", "" (the root)
};

// Reads .gltf and .glb (told apart by content). BakeError on anything that is not sound; hostile-safe.
GltfDocument readGltfDocument(const InputFiles& files);

// The bytes of a data: URI; refuses other encodings than base64. `place` for the message.
std::vector<std::uint8_t> decodeDataUri(const InputFiles& files, const std::string& uri, const std::string& place);

}  // namespace kelp::bake
