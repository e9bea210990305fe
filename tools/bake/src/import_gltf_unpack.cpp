// SPDX-License-Identifier: MIT
// Replaces compressed geometry in a glTF document by plain buffers: what comes after need not know of compression.
#include <map>
#include <span>
#include <string>

#include "import_draco.h"
#include "import_gltf_json.h"
#include "import_meshopt.h"

namespace kelp::bake {
namespace {

// The bytes [offset, offset + length) of a buffer.
std::span<const std::uint8_t> bufferRange(const InputFiles& files, const GltfDocument& document, std::uint64_t buffer,
                                          std::uint64_t offset, std::uint64_t length, const std::string& place) {
  const std::vector<std::vector<std::uint8_t>>& buffers = document.buffers;
  if (buffer >= buffers.size()) refuse(Exit::kInvalid, files.input(), place, "names buffer " + std::to_string(buffer) + ", which does not exist");
  if (const auto missing = document.missing.find(static_cast<std::size_t>(buffer)); missing != document.missing.end()) throw missing->second;
  const std::vector<std::uint8_t>& bytes = buffers[static_cast<std::size_t>(buffer)];
  if (offset > bytes.size() || length > bytes.size() - offset)
    refuse(Exit::kInvalid, files.input(), place, "reaches beyond buffer " + std::to_string(buffer) + " (" + std::to_string(bytes.size()) + " bytes)");
  return {bytes.data() + offset, static_cast<std::size_t>(length)};
}

// Appends the bytes as a new buffer with a view over it; answers the view's index.
std::size_t appendView(Json& root, std::vector<std::vector<std::uint8_t>>& buffers, std::vector<std::uint8_t> bytes) {
  Json& views = root["bufferViews"];
  views.push_back({{"buffer", buffers.size()}, {"byteOffset", 0}, {"byteLength", bytes.size()}});
  buffers.push_back(std::move(bytes));
  return views.size() - 1;
}

template <class T>
std::vector<std::uint8_t> asBytes(const std::vector<T>& values) {
  const auto* first = reinterpret_cast<const std::uint8_t*>(values.data());
  return {first, first + values.size() * sizeof(T)};
}

// Whether integers are fractions is the accessor's to say; the stream says so too only if its encoder cared.
void applyNormalization(const InputFiles& files, const Json& root, const Json& primitive, const std::string& name, DracoMesh::Attribute& attribute,
                        const std::string& place) {
  if (attribute.normalized) return;
  const auto attributes = primitive.find("attributes");
  if (attributes == primitive.end() || !attributes->is_object() || !attributes->contains(name)) return;
  const std::uint64_t index = wholeNumber(files, *attributes, name.c_str(), 0, place);
  const Json& accessors = root["accessors"];
  if (index >= accessors.size()) refuse(Exit::kInvalid, files.input(), place, name + " names an accessor that does not exist");
  const Json& accessor = accessors[static_cast<std::size_t>(index)];
  const auto flag = accessor.find("normalized");
  if (flag == accessor.end() || *flag != true) return;
  const std::uint64_t type = wholeNumber(files, accessor, "componentType", 0, place);
  const float largest = type == 5120 ? 127.0f : type == 5121 ? 255.0f : type == 5122 ? 32767.0f : type == 5123 ? 65535.0f : 1.0f;
  for (float& value : attribute.values) value /= largest;
}

constexpr const char* kVectorTypes[] = {"SCALAR", "VEC2", "VEC3", "VEC4"};

}  // namespace

void unpackMeshopt(const InputFiles& files, Json& root, GltfDocument& document) {
  std::vector<std::vector<std::uint8_t>>& buffers = document.buffers;
  Json& views = objects(files, root, "bufferViews");
  for (std::size_t i = 0; i < views.size(); ++i) {
    const Json* packed = extension(views[i], "EXT_meshopt_compression");
    if (!packed) continue;
    const std::string place = placeOf("bufferViews", i) + ".EXT_meshopt_compression";
    MeshoptView view;
    view.count = wholeNumber(files, *packed, "count", 0, place);
    view.stride = wholeNumber(files, *packed, "byteStride", 0, place);
    view.mode = packed->value("mode", "");
    view.filter = packed->value("filter", "NONE");
    const auto bytes = bufferRange(files, document, wholeNumber(files, *packed, "buffer", ~std::uint64_t{0}, place),
                                   wholeNumber(files, *packed, "byteOffset", 0, place), wholeNumber(files, *packed, "byteLength", 0, place), place);
    std::vector<std::uint8_t> decoded;
    try {
      decoded = decodeMeshopt(bytes, view);
    } catch (const MeshoptError& error) {
      refuse(Exit::kInvalid, files.input(), place, error.what());
    }
    views[i]["buffer"] = buffers.size();
    views[i]["byteOffset"] = 0;
    views[i]["byteLength"] = decoded.size();
    views[i]["extensions"].erase("EXT_meshopt_compression");
    if (view.mode == "ATTRIBUTES") views[i]["byteStride"] = view.stride;
    else views[i].erase("byteStride");
    buffers.push_back(std::move(decoded));
  }
}

void unpackDraco(const InputFiles& files, Json& root, GltfDocument& document) {
  std::vector<std::vector<std::uint8_t>>& buffers = document.buffers;
  struct Unpacked {
    std::size_t indices = 0;
    std::map<std::string, std::size_t> attributes;
  };
  std::map<std::string, Unpacked> done;  // primitives may share a stream; keyed by the extension's text
  objects(files, root, "bufferViews");
  objects(files, root, "accessors");
  Json& meshes = objects(files, root, "meshes");
  for (std::size_t m = 0; m < meshes.size(); ++m) {
    Json& primitives = objects(files, meshes[m], "primitives", placeOf("meshes", m));
    for (std::size_t p = 0; p < primitives.size(); ++p) {
      Json* packed = extension(primitives[p], "KHR_draco_mesh_compression");
      if (!packed) continue;
      const std::string place = placeOf("meshes", m) + "." + placeOf("primitives", p) + ".KHR_draco_mesh_compression";
      const std::string key = packed->dump(-1, ' ', false, Json::error_handler_t::replace);
      auto found = done.find(key);
      if (found == done.end()) {
        const std::uint64_t view_index = wholeNumber(files, *packed, "bufferView", ~std::uint64_t{0}, place);
        Json& views = root["bufferViews"];
        if (view_index >= views.size()) refuse(Exit::kInvalid, files.input(), place, "names a bufferView that does not exist");
        const Json& view = views[static_cast<std::size_t>(view_index)];
        const std::string view_place = placeOf("bufferViews", static_cast<std::size_t>(view_index));
        const auto bytes = bufferRange(files, document, wholeNumber(files, view, "buffer", ~std::uint64_t{0}, view_place),
                                       wholeNumber(files, view, "byteOffset", 0, view_place), wholeNumber(files, view, "byteLength", 0, view_place), view_place);
        std::map<std::string, std::uint32_t> ids;
        const auto attributes = packed->find("attributes");
        if (attributes == packed->end() || !attributes->is_object()) refuse(Exit::kInvalid, files.input(), place, "has no attributes");
        for (const auto& [name, id] : attributes->items()) {
          (void)id;
          const std::uint64_t value = wholeNumber(files, *attributes, name.c_str(), 0, place);
          if (value > 0xffffffffu) refuse(Exit::kInvalid, files.input(), place, "has an attribute id out of range");
          ids[name] = static_cast<std::uint32_t>(value);
        }
        DracoMesh mesh;
        try {
          mesh = decodeDraco(bytes, ids);
        } catch (const DracoUnsupported& error) {
          refuse(Exit::kUnsupported, files.input(), place, error.what());
        } catch (const DracoError& error) {
          refuse(Exit::kInvalid, files.input(), place, error.what());
        }
        Unpacked unpacked;
        Json& accessors = root["accessors"];
        unpacked.indices = accessors.size();
        accessors.push_back({{"bufferView", appendView(root, buffers, asBytes(mesh.indices))}, {"componentType", 5125},
                             {"count", mesh.indices.size()}, {"type", "SCALAR"}});
        for (auto& [name, attribute] : mesh.attributes) {
          applyNormalization(files, root, primitives[p], name, attribute, place);
          unpacked.attributes[name] = accessors.size();
          if (attribute.step > 0) document.steps[static_cast<int>(accessors.size())] = attribute.step;
          accessors.push_back({{"bufferView", appendView(root, buffers, asBytes(attribute.values))}, {"componentType", 5126},
                               {"count", attribute.values.size() / static_cast<std::size_t>(attribute.components)},
                               {"type", kVectorTypes[attribute.components - 1]}});
        }
        found = done.emplace(key, std::move(unpacked)).first;
      }
      primitives[p]["indices"] = found->second.indices;
      for (const auto& [name, accessor] : found->second.attributes) primitives[p]["attributes"][name] = accessor;
    }
  }
}

}  // namespace kelp::bake
