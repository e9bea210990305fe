// SPDX-License-Identifier: MIT
// The buffers of a glTF file: beside it, in its binary chunk or in data URIs.
#include <algorithm>
#include <cctype>
#include <map>
#include <optional>
#include <span>
#include <string_view>

#include "gltf_json.h"
#include "kelp/common/error.h"

namespace kelp::bake {
namespace {

int base64Digit(char c) {
  if (c >= 'A' && c <= 'Z') return c - 'A';
  if (c >= 'a' && c <= 'z') return c - 'a' + 26;
  if (c >= '0' && c <= '9') return c - '0' + 52;
  if (c == '+' || c == '-') return 62;
  if (c == '/' || c == '_') return 63;
  return -1;
}

using BufferBytes = std::span<const std::uint8_t>;

class BufferLoader {
 public:
  BufferLoader(const InputFiles& files, std::optional<BufferBytes> binary, DataBudget& budget,
               GltfDocument& document)
      : files_(files), binary_(binary), budget_(budget), document_(document) {}

  // The bytes of a buffer, or more than them; nullopt if the file names none.
  std::optional<BufferBytes> load(const Json& buffer, std::size_t index, const std::string& place) {
    const auto uri = buffer.find("uri");
    if (uri == buffer.end()) return index > 0 ? std::nullopt : binary_;
    if (!uri->is_string()) refuse(Exit::kInvalid, files_.input(), place, "has a uri that is not a string");
    const std::string& text = uri->get_ref<const std::string&>();
    if (isDataUri(text)) return keep(decodeDataUri(files_, text, place), place);
    const std::filesystem::path path = files_.resolve(text, InputFiles::Reference::kUri);
    const auto found = read_.find(path);
    return found != read_.end() ? found->second
                                : read_.emplace(path, keep(files_.readFile(path), place)).first->second;
  }

 private:
  BufferBytes keep(std::vector<std::uint8_t> bytes, const std::string& place) {
    budget_.take(bytes.size(), place);
    return document_.contents.emplace_back(std::move(bytes));
  }

  const InputFiles& files_;
  std::optional<BufferBytes> binary_;
  DataBudget& budget_;
  GltfDocument& document_;
  std::map<std::filesystem::path, BufferBytes> read_;
};

// Section 3.6.1.1 of the specification. Malformed data URIs are read, with a notice.
void checkDataUri(const std::string& uri, const std::string& place, std::vector<std::string>& flaws) {
  std::string type = uri.substr(5, std::min(uri.find(','), std::size_t{256}) - 5);
  std::transform(type.begin(), type.end(), type.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  if (type.find(";;") != std::string::npos)
    flaws.push_back(place + ": has a data URI that is malformed; its data are read");
  type.resize(std::min(type.find(';'), type.size()));
  if (type != "application/octet-stream" && type != "application/gltf-buffer")
    flaws.push_back(place + ": has a data URI of the type '" + oneLine(type, 40) +
                    "', which is not that of a buffer; its data are read");
}

}  // namespace

std::vector<std::uint8_t> decodeDataUri(const InputFiles& files, const std::string& uri,
                                        const std::string& place) {
  const std::size_t comma = uri.find(',');
  if (comma == std::string::npos || comma > 256)
    refuse(Exit::kInvalid, files.input(), place, "has a data URI without data");
  std::vector<std::uint8_t> bytes;
  if (uri.find(";base64") > comma) {
    const std::optional<std::string> text = percentDecode(std::string_view(uri).substr(comma + 1));
    if (!text) refuse(Exit::kInvalid, files.input(), place, "has a data URI with a broken percent encoding");
    bytes.assign(text->begin(), text->end());
    return bytes;
  }
  bytes.reserve((uri.size() - comma) / 4 * 3);
  std::uint32_t bits = 0;
  int count = 0;
  for (std::size_t i = comma + 1; i < uri.size(); ++i) {
    if (uri[i] == '=') break;
    const int digit = base64Digit(uri[i]);
    if (digit < 0)
      refuse(Exit::kInvalid, files.input(), place, "has a data URI with a character that is not base64");
    bits = bits << 6 | static_cast<std::uint32_t>(digit);
    count += 6;
    if (count >= 8) {
      count -= 8;
      bytes.push_back(static_cast<std::uint8_t>(bits >> count & 0xff));
    }
  }
  return bytes;
}

void loadBuffers(const InputFiles& files, Json& root, const GltfBinary& container, DataBudget& budget,
                 GltfDocument& document) {
  std::vector<BufferBytes>& buffers = document.buffers;
  BufferLoader loader(files, container.chunk, budget, document);
  for (Json& buffer : objects(files, root, "buffers")) {
    const std::size_t index = buffers.size();
    const std::string place = placeOf("buffers", index);
    const std::uint64_t length = wholeNumber(files, buffer, "byteLength", 0, place);
    std::optional<BufferBytes> bytes;
    try {
      bytes = loader.load(buffer, index, place);
    } catch (const ToolError& error) {
      if (isOfTheMachine(error)) throw;
      // A buffer that cannot be read is an error only for its readers. A forbidden URI is refused at once.
      const std::string* uri = buffer["uri"].get_ptr<const std::string*>();
      if (!uri || isDataUri(*uri)) throw;
      const ToolError placed = inPlace(files, place, error);
      if (error.exit != Exit::kIo && !hasScheme(*uri)) throw placed;
      document.missing.emplace(index, placed);
      (error.exit == Exit::kIo ? document.flaws : document.notices)
          .push_back(place + ": cannot be read, and nothing that is baked uses it (" + error.what() + ")");
      buffers.emplace_back();
      continue;
    }
    if (!bytes) {
      // Legal for a placeholder, such as the fallback of EXT_meshopt_compression. The range checks refuse
      // every read from it.
      if (container.is_glb && index == 0 && !extension(buffer, "EXT_meshopt_compression"))
        document.flaws.push_back(place + ": has no uri, and the file no BIN chunk: it has no data");
      buffers.emplace_back();
      continue;
    }
    if (bytes->size() < length)
      refuse(Exit::kInvalid, files.input(), place,
             "declares " + std::to_string(length) + " bytes but has " + std::to_string(bytes->size()) +
                 "; the file is truncated");
    if (const auto uri = buffer.find("uri");
        uri != buffer.end() && isDataUri(uri->get_ref<const std::string&>()))
      checkDataUri(*uri, place, document.flaws);
    buffers.push_back(bytes->first(static_cast<std::size_t>(length)));
  }
}

}  // namespace kelp::bake
