// SPDX-License-Identifier: MIT
// A glTF file before its meaning is read: container opened, JSON bounded, buffers in memory, compressed data unpacked.
// After this stage the file is plain glTF 2.0: no extension that hides geometry, no reference to anything outside.
#pragma once

#include <cstdint>
#include <map>
#include <set>
#include <span>
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
  GltfDocument() = default;
  GltfDocument(GltfDocument&&) = default;  // and no copy: buffers lie in `contents`
  GltfDocument& operator=(GltfDocument&&) = default;

  std::string json;                                  // without `buffers` and `images`: those are below
  std::vector<std::vector<std::uint8_t>> contents;   // files, each once, and what was decoded
  std::vector<std::span<const std::uint8_t>> buffers;  // in `contents`
  std::map<std::size_t, BakeError> missing;          // buffers that can not be had, and why: an error for whoever reads from them
  std::map<int, float> steps;                        // of accessors that Draco rounded: how far apart two neighbouring values are
  std::set<int> unknown_accessors;                   // of types that glTF 2.0 does not have
  std::vector<ImageSource> images;
  std::map<std::string, std::string> rigs;           // the text of every extras.kelp, by its owner: "nodes[3]", "asset", "" (the root)
  std::vector<std::string> flaws;                    // what is against the specification and can be lived with; one line a kind
  std::vector<std::string> notices;                  // what else the user should know
};

// Reads .gltf and .glb (told apart by content). BakeError on anything that is not sound, or beyond the budget; hostile-safe.
GltfDocument readGltfDocument(const InputFiles& files, DataBudget& budget);

// The bytes of a data: URI, base64 or percent-encoded. `place` for the message.
std::vector<std::uint8_t> decodeDataUri(const InputFiles& files, const std::string& uri, const std::string& place);

}  // namespace kelp::bake
