// SPDX-License-Identifier: MIT
// A glTF file on its way to tinygltf: container opened, JSON bounded and made readable for tinygltf 2.7. The
// buffers, which tinygltf must not open itself.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "kelp/import/core/input_files.h"

namespace kelp::bake {

struct GltfDocument {
  // A buffer or an image.
  struct Source {
    std::string name;
    std::optional<std::string> uri;
    int buffer_view = -1;      // of an image without a uri
    std::uint64_t length = 0;  // of a buffer
  };
  std::string json;  // without `buffers` and `images`
  std::vector<Source> buffers, images;
  std::vector<std::uint8_t> file;                    // of .glb
  std::optional<std::span<const std::uint8_t>> bin;  // its BIN chunk
};

// Reads .gltf and .glb; the content tells which. ToolError for damaged files. Safe for hostile input.
GltfDocument readGltfDocument(const InputFiles& files);

// The bytes of a data: URI, base64 or percent-encoded. `place` for the message.
std::vector<std::uint8_t> decodeDataUri(const InputFiles& files, const std::string& uri,
                                        const std::string& place);

// The buffers of a file, and those that are unpacked from them. A buffer is read when it is first asked for,
// and a file once, however many buffers name it.
class GltfBuffers {
 public:
  // Takes the document's buffers.
  GltfBuffers(const InputFiles& files, GltfDocument& document, DataBudget& budget);

  std::size_t size() const { return buffers_.size(); }
  // ToolError if it cannot be read, leaves the input's folder, or is shorter than it says. Empty if the file
  // names no bytes for it, as that of a fallback.
  std::span<const std::uint8_t> read(std::size_t index);
  // Appends a buffer; returns its index.
  std::size_t add(std::vector<std::uint8_t> bytes, const std::string& place);

 private:
  using Bytes = std::span<const std::uint8_t>;
  struct Buffer {
    GltfDocument::Source source;
    std::optional<Bytes> bytes;
  };
  Bytes load(const GltfDocument::Source& source, std::size_t index, const std::string& place);
  Bytes keep(std::vector<std::uint8_t> bytes, const std::string& place);

  const InputFiles& files_;
  DataBudget& budget_;
  std::vector<std::uint8_t> glb_;
  std::optional<Bytes> bin_;  // in glb_
  std::vector<Buffer> buffers_;
  std::vector<std::vector<std::uint8_t>> contents_;
  std::map<std::filesystem::path, Bytes> files_read_;
};

}  // namespace kelp::bake
