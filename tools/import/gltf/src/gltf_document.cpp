// SPDX-License-Identifier: MIT
#include "gltf_document.h"

#include <algorithm>
#include <climits>
#include <cmath>
#include <string_view>

#include <nlohmann/json.hpp>

#include "kelp/common/error.h"
#include "kelp/common/json_depth.h"

namespace kelp::bake {
namespace {

using Json = nlohmann::json;

constexpr std::size_t kMaxJsonBytes = std::size_t{256} << 20;
constexpr int kMaxDepth = 64;  // real files stay below 20
constexpr std::uint32_t kJsonChunk = 0x4e4f534a, kBinChunk = 0x004e4942;

std::uint32_t readU32(std::span<const std::uint8_t> bytes, std::size_t at) {
  return static_cast<std::uint32_t>(bytes[at]) | static_cast<std::uint32_t>(bytes[at + 1]) << 8 |
         static_cast<std::uint32_t>(bytes[at + 2]) << 16 | static_cast<std::uint32_t>(bytes[at + 3]) << 24;
}

// glTF 2.0 specification, section 4.4: 12-byte header, then chunks {length, type, data}; the first is JSON,
// the second may be BIN. Returns the JSON.
std::string_view openBinary(const InputFiles& files, std::span<const std::uint8_t> bytes,
                            std::optional<std::span<const std::uint8_t>>& bin) {
  const auto fail = [&](Exit code, const char* place, const std::string& what) {
    refuse(code, files.input(), place, what);
  };
  if (bytes.size() < 12)
    fail(Exit::kInvalid, "header", "the file ends inside the 12-byte GLB header; it is truncated");
  const std::uint32_t version = readU32(bytes, 4);
  if (version != 2)
    fail(version == 0 ? Exit::kInvalid : Exit::kUnsupported, "header",
         "is GLB version " + std::to_string(version) + "; export it as glTF 2.0");
  const std::uint64_t length = readU32(bytes, 8);
  if (length > bytes.size())
    fail(Exit::kInvalid, "header",
         "declares " + std::to_string(length) + " bytes but has " + std::to_string(bytes.size()) +
             "; it is truncated");
  std::string_view json;
  std::size_t at = 12;
  for (int index = 0; index < 2 && at + 8 <= length; ++index) {
    const std::uint64_t size = readU32(bytes, at);
    const std::uint32_t type = readU32(bytes, at + 4);
    const char* const place = index == 0 ? "chunk 0" : "chunk 1";
    if (size > length - at - 8) fail(Exit::kInvalid, place, "is longer than the file; it is truncated");
    const auto data = bytes.subspan(at + 8, static_cast<std::size_t>(size));
    if (index == 0 && type != kJsonChunk)
      fail(Exit::kInvalid, place, "is not the JSON chunk that must come first");
    if (index == 0) json = {reinterpret_cast<const char*>(data.data()), data.size()};
    if (index == 1 && type == kBinChunk) bin = data;
    at += 8 + static_cast<std::size_t>(size);
  }
  if (json.empty()) fail(Exit::kInvalid, "chunk 0", "there is no JSON; the file is truncated or not a GLB");
  return json;
}

Json parseJson(const InputFiles& files, std::string_view text) {
  if (text.size() > kMaxJsonBytes)
    refuse(Exit::kUnsupported, files.input(), "JSON", "is larger than 256 MiB; use buffers for data");
  if (nestedDeeper(text, kMaxDepth))
    refuse(Exit::kInvalid, files.input(), "JSON", "is nested deeper than 64 levels; no glTF needs that");
  try {
    Json root = Json::parse(text);
    if (!root.is_object())
      refuse(Exit::kInvalid, files.input(), "JSON", "is not an object; this is not a glTF file");
    return root;
  } catch (const Json::parse_error& error) {
    const std::string_view before = text.substr(0, error.byte > 0 ? error.byte - 1 : 0);
    if (before.size() >= text.size())
      refuse(Exit::kInvalid, files.input(), "JSON",
             "ends in the middle; it is truncated: export the model again");
    const auto line = std::count(before.begin(), before.end(), '\n') + 1;
    const std::size_t column = before.size() - (before.rfind('\n') + 1) + 1;  // npos + 1 is 0
    refuse(Exit::kInvalid, files.input(),
           "JSON, line " + std::to_string(line) + ", column " + std::to_string(column),
           "is not valid JSON; repair it there or export the model again");
  } catch (const Json::exception&) {
    refuse(Exit::kInvalid, files.input(), "JSON",
           "holds a number beyond all bounds; repair it or export the model again");
  }
}

// JSON has one kind of number, tinygltf two: 12.0 becomes 12. The depth was bounded before.
void wholeFloatsToIntegers(Json& value) {
  if (value.is_structured()) {
    for (Json& member : value) wholeFloatsToIntegers(member);
  } else if (value.is_number_float()) {
    const double number = value;
    if (std::abs(number) < 9e15 && number == std::trunc(number)) value = static_cast<std::int64_t>(number);
  }
}

// The objects of an array; none of anything else.
std::vector<Json*> objectsOf(Json& parent, const char* name) {
  std::vector<Json*> out;
  const auto found = parent.find(name);
  if (found == parent.end() || !found->is_array()) return out;
  for (Json& member : *found)
    if (member.is_object()) out.push_back(&member);
  return out;
}

// -1 for anything but a whole number from 0.
std::int64_t wholeNumber(const Json& object, const char* name) {
  const auto found = object.find(name);
  const bool whole = found != object.end() && found->is_number_integer();
  return whole ? std::max(found->get<std::int64_t>(), std::int64_t{-1}) : -1;
}

// Takes an array of buffers or images out of the document. A member that is no object keeps its place.
std::vector<GltfDocument::Source> takeSources(Json& root, const char* name) {
  std::vector<GltfDocument::Source> out;
  const auto found = root.find(name);
  if (found == root.end()) return out;
  for (std::size_t i = 0; found->is_array() && i < found->size(); ++i) {
    Json& member = (*found)[i];
    GltfDocument::Source& source = out.emplace_back();
    if (!member.is_object()) continue;
    const auto text = [&](const char* key) {
      const auto value = member.find(key);
      return value != member.end() ? value->get_ptr<std::string*>() : nullptr;
    };
    if (const std::string* const given = text("name")) source.name = *given;
    if (std::string* const uri = text("uri"))
      source.uri = std::move(*uri);
    else
      source.buffer_view =
          static_cast<int>(std::min<std::int64_t>(wholeNumber(member, "bufferView"), INT_MAX));
    source.length = static_cast<std::uint64_t>(std::max<std::int64_t>(wholeNumber(member, "byteLength"), 0));
  }
  root.erase(found);
  return out;
}

// tinygltf 2.7 refuses indices without bytes, as Draco's are.
void dropDracoIndices(Json& root) {
  for (Json* mesh : objectsOf(root, "meshes"))
    for (Json* primitive : objectsOf(*mesh, "primitives"))
      if (const auto extensions = primitive->find("extensions");
          extensions != primitive->end() && extensions->is_object() &&
          extensions->contains("KHR_draco_mesh_compression"))
        primitive->erase("indices");
}

int base64Digit(char c) {
  if (c >= 'A' && c <= 'Z') return c - 'A';
  if (c >= 'a' && c <= 'z') return c - 'a' + 26;
  if (c >= '0' && c <= '9') return c - '0' + 52;
  if (c == '+' || c == '-') return 62;
  if (c == '/' || c == '_') return 63;
  return -1;
}

}  // namespace

GltfDocument readGltfDocument(const InputFiles& files) {
  GltfDocument document;
  document.file = files.readInput();
  const std::string_view text(reinterpret_cast<const char*>(document.file.data()), document.file.size());
  if (text.empty()) refuse(Exit::kInvalid, files.input(), "", "is empty; export the model again");
  std::string_view json = text;
  if (text.starts_with("glTF")) {
    json = openBinary(files, document.file, document.bin);
  } else {
    constexpr std::string_view kMark = "\xef\xbb\xbf";  // of UTF-8, which some editors write
    const std::size_t first = text.find_first_not_of(" \t\r\n", text.starts_with(kMark) ? kMark.size() : 0);
    if (first == std::string_view::npos || text[first] != '{')
      refuse(Exit::kInvalid, files.input(), "",
             "does not look like glTF (neither JSON nor the GLB signature); check the file's type");
  }
  Json root = parseJson(files, json);
  wholeFloatsToIntegers(root);
  document.buffers = takeSources(root, "buffers");
  document.images = takeSources(root, "images");
  dropDracoIndices(root);
  document.json = root.dump(-1, ' ', false, Json::error_handler_t::replace);
  return document;
}

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

GltfBuffers::GltfBuffers(const InputFiles& files, GltfDocument& document, DataBudget& budget)
    : files_(files), budget_(budget), glb_(std::move(document.file)), bin_(document.bin) {
  for (GltfDocument::Source& source : document.buffers) buffers_.push_back({std::move(source), std::nullopt});
}

std::span<const std::uint8_t> GltfBuffers::read(std::size_t index) {
  Buffer& buffer = buffers_[index];
  if (buffer.bytes) return *buffer.bytes;
  const std::string place = placeOf("buffers", index);
  const Bytes bytes = load(buffer.source, index, place);
  if (!bytes.empty() && bytes.size() < buffer.source.length)
    refuse(Exit::kInvalid, files_.input(), place,
           "declares " + std::to_string(buffer.source.length) + " bytes but has " +
               std::to_string(bytes.size()) + "; the file is truncated");
  buffer.bytes = bytes.first(std::min<std::size_t>(bytes.size(), buffer.source.length));
  return *buffer.bytes;
}

GltfBuffers::Bytes GltfBuffers::load(const GltfDocument::Source& source, std::size_t index,
                                     const std::string& place) {
  if (!source.uri) return index == 0 && bin_ ? *bin_ : Bytes();
  if (isDataUri(*source.uri)) return keep(decodeDataUri(files_, *source.uri, place), place);
  try {
    const std::filesystem::path path = files_.resolve(*source.uri, InputFiles::Reference::kUri);
    const auto found = files_read_.find(path);
    return found != files_read_.end()
               ? found->second
               : files_read_.emplace(path, keep(files_.readFile(path), place)).first->second;
  } catch (const ToolError& error) {
    if (isOfTheMachine(error)) throw;
    throw inPlace(files_, place, error);
  }
}

GltfBuffers::Bytes GltfBuffers::keep(std::vector<std::uint8_t> bytes, const std::string& place) {
  budget_.take(bytes.size(), place);
  return contents_.emplace_back(std::move(bytes));
}

std::size_t GltfBuffers::add(std::vector<std::uint8_t> bytes, const std::string& place) {
  buffers_.push_back({{}, keep(std::move(bytes), place)});
  return buffers_.size() - 1;
}

}  // namespace kelp::bake
