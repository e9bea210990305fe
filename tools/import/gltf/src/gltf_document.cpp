// SPDX-License-Identifier: MIT
#include "gltf_document.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstring>
#include <optional>
#include <span>
#include <string_view>

#include "gltf_json.h"
#include "kelp/common/json_depth.h"

namespace kelp::bake {
namespace {

constexpr std::size_t kMaxJsonBytes = std::size_t{256} << 20;
constexpr int kMaxDepth = 64;  // real files stay below 20

// Extensions that this importer reads, or that change only what kelp does not bake.
constexpr std::array<std::string_view, 24> kKnownExtensions = {
    "KHR_draco_mesh_compression",
    "EXT_meshopt_compression",
    "KHR_mesh_quantization",
    "KHR_texture_transform",
    "EXT_texture_webp",
    "KHR_texture_basisu",  // by the plain pictures beside it; import_gltf_image refuses what has none
    "KHR_lights_punctual",
    "KHR_materials_diffuse_transmission",
    "EXT_mesh_manifold",
    "KHR_materials_unlit",
    "KHR_materials_emissive_strength",
    "KHR_materials_pbrSpecularGlossiness",
    "KHR_materials_clearcoat",
    "KHR_materials_ior",
    "KHR_materials_sheen",
    "KHR_materials_specular",
    "KHR_materials_transmission",
    "KHR_materials_volume",
    "KHR_materials_anisotropy",
    "KHR_materials_iridescence",
    "KHR_materials_dispersion",
    "KHR_materials_variants",
    "KHR_animation_pointer",
    "KHR_xmp_json_ld"};

constexpr std::uint32_t kJsonChunk = 0x4e4f534a, kBinChunk = 0x004e4942;

std::uint32_t readU32(std::span<const std::uint8_t> bytes, std::size_t at) {
  return static_cast<std::uint32_t>(bytes[at]) | static_cast<std::uint32_t>(bytes[at + 1]) << 8 |
         static_cast<std::uint32_t>(bytes[at + 2]) << 16 | static_cast<std::uint32_t>(bytes[at + 3]) << 24;
}

struct Container {
  std::string_view json;
  GltfBinary binary;
  std::vector<std::string> flaws;
};

// glTF 2.0 specification, section 4.4: 12-byte header, then chunks {length, type, data}; the first is JSON,
// the second may be BIN.
Container openBinary(const InputFiles& files, std::span<const std::uint8_t> bytes) {
  if (bytes.size() < 12)
    refuse(Exit::kInvalid, files.input(), "header",
           "the file ends inside the 12-byte GLB header; it is truncated");
  const std::uint32_t version = readU32(bytes, 4);
  if (version == 0)
    refuse(Exit::kInvalid, files.input(), "header",
           "has the GLB version 0, which does not exist; export the model again");
  if (version != 2)
    refuse(Exit::kUnsupported, files.input(), "header",
           "is GLB version " + std::to_string(version) + "; export it as glTF 2.0");
  const std::uint64_t length = readU32(bytes, 8);
  if (length > bytes.size())
    refuse(Exit::kInvalid, files.input(), "header",
           "declares " + std::to_string(length) + " bytes but has " + std::to_string(bytes.size()) +
               "; it is truncated");
  Container container;
  container.binary.is_glb = true;
  std::size_t at = 12;
  for (int index = 0; at + 8 <= length; ++index) {
    const std::uint64_t size = readU32(bytes, at);
    const std::uint32_t type = readU32(bytes, at + 4);
    const std::string place = "chunk " + std::to_string(index);
    if (size > length - at - 8)
      refuse(Exit::kInvalid, files.input(), place, "is longer than the file; it is truncated");
    const auto data = bytes.subspan(at + 8, static_cast<std::size_t>(size));
    if (index == 0) {
      if (type != kJsonChunk)
        refuse(Exit::kInvalid, files.input(), place, "is not the JSON chunk that must come first");
      container.json = {reinterpret_cast<const char*>(data.data()), data.size()};
    } else if (type == kBinChunk && index == 1) {
      container.binary.chunk = data;
    } else if (type == kJsonChunk || type == kBinChunk) {
      container.flaws.push_back(place +
                                ": is a second JSON or BIN chunk, or out of its place, and is ignored");
    }
    if (size % 4 != 0) container.flaws.push_back(place + ": has a length that is not a multiple of four");
    at += 8 + static_cast<std::size_t>(size);
  }
  if (at < length) container.flaws.push_back("GLB: ends inside the header of a chunk, which is ignored");
  if (container.json.empty())
    refuse(Exit::kInvalid, files.input(), "chunk 0", "there is no JSON; the file is truncated or not a GLB");
  return container;
}

Json parseJson(const InputFiles& files, std::string_view text) {
  if (text.size() > kMaxJsonBytes)
    refuse(Exit::kUnsupported, files.input(), "JSON", "is larger than 256 MiB; use buffers for data");
  if (nestedDeeper(text, kMaxDepth))
    refuse(Exit::kInvalid, files.input(), "JSON", "is nested deeper than 64 levels; no glTF needs that");
  Json root;
  try {
    root = Json::parse(text);
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
  if (!root.is_object())
    refuse(Exit::kInvalid, files.input(), "JSON", "is not an object; this is not a glTF file");
  return root;
}

bool isKnownExtension(std::string_view name) {
  return std::find(kKnownExtensions.begin(), kKnownExtensions.end(), name) != kKnownExtensions.end();
}

// "<major>.<minor>". Any other text asks for nothing.
bool isAbove20(std::string_view version) {
  const std::size_t dot = std::min(version.find('.'), version.size());
  const auto number = [](std::string_view text) {
    int value = 0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    return error == std::errc::result_out_of_range ? 1 << 30 : value;
  };
  const int major = number(version.substr(0, dot)),
            minor = number(version.substr(std::min(dot + 1, version.size())));
  return major > 2 || (major == 2 && minor > 0);
}

void checkVersionAndExtensions(const InputFiles& files, const Json& root) {
  const auto asset = root.find("asset");
  if (asset == root.end() || !asset->is_object() || !asset->contains("version") ||
      !(*asset)["version"].is_string())
    refuse(Exit::kInvalid, files.input(), "asset", "has no version; this is not a glTF 2.0 file");
  const std::string version = (*asset)["version"];
  if (version.rfind("2.", 0) != 0)
    refuse(Exit::kUnsupported, files.input(), "asset",
           "is glTF " + oneLine(version, 20) + "; export it as glTF 2.0");
  if (const auto least = asset->find("minVersion");
      least != asset->end() && least->is_string() && isAbove20(least->get_ref<const std::string&>()))
    refuse(Exit::kUnsupported, files.input(), "asset",
           "needs a reader of glTF " + oneLine(least->get_ref<const std::string&>(), 20) +
               " (minVersion); export it as glTF 2.0");
  const auto required = root.find("extensionsRequired");
  if (required == root.end()) return;
  if (!required->is_array()) refuse(Exit::kInvalid, files.input(), "extensionsRequired", "is not an array");
  for (const Json& name : *required) {
    if (!name.is_string())
      refuse(Exit::kInvalid, files.input(), "extensionsRequired", "has an element that is not a string");
    const std::string text = name;
    if (!isKnownExtension(text))
      refuse(Exit::kUnsupported, files.input(), "extensionsRequired",
             "the file needs the extension '" + oneLine(text, 80) +
                 "', which kelp does not read; export without it");
  }
}

// The names in every `extensions`, declared or not. The depth was bounded before.
void listExtensions(const Json& value, std::set<std::string>& names) {
  for (const auto& [key, member] : value.items()) {
    if (value.is_object() && key == "extensions" && member.is_object())
      for (const auto& [name, content] : member.items()) names.insert(name);
    if (member.is_structured() && key != "extras") listExtensions(member, names);
  }
}

// Unknown extensions that are used and not required may have placed or shaped meshes: one notice for all.
void noteUnknownExtensions(const Json& root, std::vector<std::string>& notices) {
  constexpr std::size_t kShown = 8;
  std::set<std::string> names;
  listExtensions(root, names);
  if (const auto used = root.find("extensionsUsed"); used != root.end() && used->is_array())
    for (const Json& name : *used)
      if (name.is_string()) names.insert(name.get<std::string>());
  std::erase_if(names, [](const std::string& name) { return isKnownExtension(name); });
  if (names.empty()) return;
  std::string list;
  std::size_t shown = 0;
  for (const std::string& name : names) {
    if (++shown > kShown) break;
    list += (list.empty() ? "" : ", ") + oneLine(name, 40) +
            (name == "EXT_mesh_gpu_instancing" ? " (each mesh is baked once)" : "");
  }
  if (names.size() > kShown) list += " and " + std::to_string(names.size() - kShown) + " more";
  notices.push_back("extensions that kelp does not know are ignored: " + list +
                    "; if they place, hide or shape meshes, export without them");
}

// The members of an array; none of anything else.
const Json::array_t& membersOf(const Json& object, const char* name) {
  static const Json::array_t kNone;
  const auto found = object.is_object() ? object.find(name) : object.end();
  return object.is_object() && found != object.end() && found->is_array()
             ? found->get_ref<const Json::array_t&>()
             : kNone;
}

// Counted here, because tinygltf skips channels without a node.
void notePointers(const Json& root, std::vector<std::string>& notices) {
  std::size_t pointers = 0;
  for (const Json& animation : membersOf(root, "animations"))
    for (const Json& channel : membersOf(animation, "channels"))
      pointers += channel.is_object() && channel.contains("target") && channel["target"].is_object() &&
                  channel["target"].contains("path") && channel["target"]["path"] == "pointer";
  if (pointers > 0)
    notices.push_back(
        std::to_string(pointers) + (pointers == 1 ? " animation channel is" : " animation channels are") +
        " left out: KHR_animation_pointer is not read; animate translation, rotation and scale of nodes");
}

std::vector<GltfDocument::ImageSource> listImages(const InputFiles& files, Json& root) {
  std::vector<GltfDocument::ImageSource> images;
  for (Json& image : objects(files, root, "images")) {
    const std::string place = placeOf("images", images.size());
    GltfDocument::ImageSource source;
    if (image.contains("name") && image["name"].is_string()) source.name = image["name"];
    if (image.contains("uri") && image["uri"].is_string()) source.uri = image["uri"];
    if (source.uri.empty()) {
      const std::uint64_t view = wholeNumber(files, image, "bufferView", 0x7fffffff, place);
      source.buffer_view = static_cast<int>(std::min<std::uint64_t>(view, 0x7fffffff));
    }
    images.push_back(std::move(source));
  }
  return images;
}

// The rig in an object's extras.
std::optional<std::string> rigOf(const Json& object) {
  const auto extras = object.find("extras");
  if (extras == object.end() || !extras->is_object()) return std::nullopt;
  const auto kelp = extras->find("kelp");
  if (kelp == extras->end()) return std::nullopt;
  // Blender's custom properties hold the rig as a string, hand-written files as an object. Both have the
  // rules of *.rig.json.
  if (kelp->is_string()) return kelp->get<std::string>();
  const Json& rig = kelp->is_object() ? *kelp : *extras;  // extras may be the rig itself: {"kelp": 1, ...}
  return rig.dump(-1, ' ', false, Json::error_handler_t::replace);
}

// Searches the whole document, so that no rig is ignored without a notice. The depth was bounded before.
void listRigs(const Json& value, const std::string& place, std::map<std::string, std::string>& rigs) {
  if (value.is_array()) {
    for (std::size_t i = 0; i < value.size(); ++i)
      if (value[i].is_structured()) listRigs(value[i], placeOf(place, i), rigs);
  } else if (value.is_object()) {
    if (std::optional<std::string> rig = rigOf(value)) rigs.emplace(place, *std::move(rig));
    for (const auto& [key, member] : value.items())
      if (key != "extras" && member.is_structured())
        listRigs(member, place.empty() ? oneLine(key, 60) : place + "." + oneLine(key, 60), rigs);
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

}  // namespace

Json& objects(const InputFiles& files, Json& parent, const char* name, const std::string& where) {
  Json& array = parent[name];
  const std::string place = where.empty() ? name : where + "." + name;
  if (array.is_null()) array = Json::array();
  if (!array.is_array()) refuse(Exit::kInvalid, files.input(), place, "is not an array");
  for (std::size_t i = 0; i < array.size(); ++i)
    if (!array[i].is_object()) refuse(Exit::kInvalid, files.input(), placeOf(place, i), "is not an object");
  return array;
}

std::uint64_t wholeNumber(const InputFiles& files, const Json& object, const char* name,
                          std::uint64_t fallback, const std::string& place) {
  const auto member = object.find(name);
  if (member == object.end()) return fallback;
  if (member->is_number_unsigned()) return member->get<std::uint64_t>();
  // Some exporters write 12.0: any whole number is accepted.
  if (member->is_number_float()) {
    const double value = *member;
    if (value >= 0 && value < 9e15 && value == static_cast<double>(static_cast<std::uint64_t>(value)))
      return static_cast<std::uint64_t>(value);
  }
  refuse(Exit::kInvalid, files.input(), place, std::string(name) + " is not a whole number of at least 0");
}

Json* extension(Json& object, const char* name) {
  const auto extensions = object.find("extensions");
  if (extensions == object.end() || !extensions->is_object()) return nullptr;
  const auto found = extensions->find(name);
  return found != extensions->end() && found->is_object() ? &*found : nullptr;
}

GltfDocument readGltfDocument(const InputFiles& files, DataBudget& budget) {
  std::vector<std::uint8_t> bytes = files.readInput();
  if (bytes.empty()) refuse(Exit::kInvalid, files.input(), "", "is empty; export the model again");
  Container container;
  if (bytes.size() >= 4 && std::memcmp(bytes.data(), "glTF", 4) == 0) {
    container = openBinary(files, bytes);
  } else {
    const bool mark = bytes.size() >= 3 && bytes[0] == 0xef && bytes[1] == 0xbb && bytes[2] == 0xbf;
    std::size_t first = mark ? 3 : 0;
    while (first < bytes.size() && std::strchr(" \t\r\n", bytes[first]) && bytes[first]) ++first;
    if (first == bytes.size() || bytes[first] != '{')
      refuse(Exit::kInvalid, files.input(), "",
             "does not look like glTF (neither JSON nor the GLB signature); check the file's type");
    container.json = {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
  }
  GltfDocument document;
  document.flaws = std::move(container.flaws);
  constexpr std::string_view kMark = "\xef\xbb\xbf";  // of UTF-8, which some editors write
  if (container.json.substr(0, kMark.size()) == kMark) {
    document.flaws.push_back("JSON: begins with a byte order mark, which glTF does not have");
    container.json.remove_prefix(kMark.size());
  }
  Json root = parseJson(files, container.json);
  checkVersionAndExtensions(files, root);
  noteUnknownExtensions(root, document.notices);
  notePointers(root, document.notices);
  for (std::string& flaw : findFlaws(root)) document.flaws.push_back(std::move(flaw));
  document.unknown_accessors = hideUnknownAccessors(root);
  loadBuffers(files, root, container.binary, budget, document);
  if (container.binary.chunk) document.contents.push_back(std::move(bytes));  // its place stays
  unpackMeshopt(files, root, budget, document);
  unpackDraco(files, root, budget, document);
  document.images = listImages(files, root);
  listRigs(root, "", document.rigs);
  root.erase("buffers");
  root.erase("images");
  wholeFloatsToIntegers(root);
  document.json = root.dump(-1, ' ', false, Json::error_handler_t::replace);
  return document;
}

}  // namespace kelp::bake
