// SPDX-License-Identifier: MIT
// A glTF file before its meaning is read: container opened, JSON bounded, buffers in memory, compressed data
// unpacked. After this stage the file is plain glTF 2.0: no extension hides geometry, and nothing refers to
// other files.
#pragma once

#include <cstdint>
#include <map>
#include <set>
#include <span>
#include <string>
#include <vector>

#include "kelp/common/error.h"
#include "kelp/import/core/input_files.h"

namespace kelp::bake {

struct GltfDocument {
  struct ImageSource {
    std::string name;
    std::string uri;  // empty: in a buffer view
    int buffer_view = -1;
  };
  GltfDocument() = default;
  GltfDocument(GltfDocument&&) = default;  // no copy: buffers are views of `contents`
  GltfDocument& operator=(GltfDocument&&) = default;

  std::string json;                                    // without `buffers` and `images`: those are below
  std::vector<std::vector<std::uint8_t>> contents;     // files, each once, and decoded data
  std::vector<std::span<const std::uint8_t>> buffers;  // in `contents`
  // buffers that cannot be read, and why: the error for readers of such a buffer
  std::map<std::size_t, ToolError> missing;
  // for accessors that Draco rounded: the distance between two neighbouring values
  std::map<int, float> steps;
  std::set<int> unknown_accessors;  // of types that glTF 2.0 does not have
  std::vector<ImageSource> images;
  // the text of every extras.kelp, by its owner: "nodes[3]", "asset", "" (the root)
  std::map<std::string, std::string> rigs;
  // faults against the specification that do no harm; one line for each kind
  std::vector<std::string> flaws;
  std::vector<std::string> notices;  // other notices for the user
};

// Reads .gltf and .glb; the content tells which. ToolError for damaged files and for data beyond the budget.
// Safe for hostile input.
GltfDocument readGltfDocument(const InputFiles& files, DataBudget& budget);

// The bytes of a data: URI, base64 or percent-encoded. `place` for the message.
std::vector<std::uint8_t> decodeDataUri(const InputFiles& files, const std::string& uri,
                                        const std::string& place);

}  // namespace kelp::bake
