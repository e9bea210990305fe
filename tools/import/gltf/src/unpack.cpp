// SPDX-License-Identifier: MIT
// Replaces compressed geometry in a glTF document by plain buffers. Later stages know nothing of compression.
#include <algorithm>
#include <iterator>
#include <map>
#include <span>
#include <string>
#include <tuple>
#include <utility>

#include "gltf_json.h"
#include "kelp/common/error.h"
#include "kelp/import/mesh/draco.h"
#include "meshopt.h"

namespace kelp::bake {
namespace {

// The bytes [offset, offset + length) of a buffer.
std::span<const std::uint8_t> bufferRange(const InputFiles& files, const GltfDocument& document,
                                          std::uint64_t buffer, std::uint64_t offset, std::uint64_t length,
                                          const std::string& place) {
  if (buffer >= document.buffers.size())
    refuse(Exit::kInvalid, files.input(), place,
           "names buffer " + std::to_string(buffer) + ", which does not exist");
  if (const auto missing = document.missing.find(static_cast<std::size_t>(buffer));
      missing != document.missing.end())
    throw missing->second;
  const std::span<const std::uint8_t> bytes = document.buffers[static_cast<std::size_t>(buffer)];
  if (offset > bytes.size() || length > bytes.size() - offset)
    refuse(
        Exit::kInvalid, files.input(), place,
        "reaches beyond buffer " + std::to_string(buffer) + " (" + std::to_string(bytes.size()) + " bytes)");
  return bytes.subspan(static_cast<std::size_t>(offset), static_cast<std::size_t>(length));
}

// Identifies bytes by their place in memory, whichever buffers and views lead to them.
using PackedKey = std::pair<std::uintptr_t, std::size_t>;
PackedKey keyOf(std::span<const std::uint8_t> bytes) {
  return {reinterpret_cast<std::uintptr_t>(bytes.data()), bytes.size()};
}

// Returns the new buffer's index.
std::size_t appendBuffer(GltfDocument& document, std::vector<std::uint8_t> bytes) {
  document.buffers.push_back(document.contents.emplace_back(std::move(bytes)));
  return document.buffers.size() - 1;
}

// Appends values as a new buffer with a view over it. Returns the view's index.
template <class T>
std::size_t appendView(Json& root, GltfDocument& document, const std::vector<T>& values) {
  const auto* first = reinterpret_cast<const std::uint8_t*>(values.data());
  const std::size_t size = values.size() * sizeof(T);
  Json& views = root["bufferViews"];
  views.push_back(
      {{"buffer", appendBuffer(document, {first, first + size})}, {"byteOffset", 0}, {"byteLength", size}});
  return views.size() - 1;
}

// The largest value of normalised integers; 1 for other types. The accessor says whether they are normalised:
// not every encoder writes it into the stream.
float fractionScale(const InputFiles& files, const Json& root, const Json& primitive, const std::string& name,
                    const std::string& place) {
  const auto attributes = primitive.find("attributes");
  if (attributes == primitive.end() || !attributes->is_object() || !attributes->contains(name)) return 1;
  const std::uint64_t index = wholeNumber(files, *attributes, name.c_str(), 0, place);
  const Json& accessors = root["accessors"];
  if (index >= accessors.size())
    refuse(Exit::kInvalid, files.input(), place, name + " names an accessor that does not exist");
  const Json& accessor = accessors[static_cast<std::size_t>(index)];
  const auto flag = accessor.find("normalized");
  if (flag == accessor.end() || *flag != true) return 1;
  const std::uint64_t type = wholeNumber(files, accessor, "componentType", 0, place);
  return type == 5120   ? 127.0f
         : type == 5121 ? 255.0f
         : type == 5122 ? 32767.0f
         : type == 5123 ? 65535.0f
                        : 1.0f;
}

constexpr const char* kVectorTypes[] = {"SCALAR", "VEC2", "VEC3", "VEC4"};

// A Draco stream and the primitives that lie in it.
struct DracoStream {
  struct Use {
    Json* primitive = nullptr;
    std::string place;
    std::map<std::string, std::uint32_t> ids;  // of its attributes
  };
  std::span<const std::uint8_t> bytes;
  std::map<std::uint32_t, std::string> ids;  // all that are asked for, and by whom
  std::vector<Use> uses;
};

// The streams of a file may together be this many times as long as its buffers, where they overlap. Each is
// decoded by itself.
constexpr std::uint64_t kMostOverlap = 4;

// The streams, in the order in which primitives first name them.
std::vector<DracoStream> findDraco(const InputFiles& files, Json& root, const GltfDocument& document) {
  std::vector<DracoStream> streams;
  std::map<PackedKey, std::size_t> known;
  std::uint64_t whole = 0, packed_bytes = 0;
  for (const std::span<const std::uint8_t> buffer : document.buffers) whole += buffer.size();
  Json& meshes = objects(files, root, "meshes");
  const Json& views = root["bufferViews"];
  for (std::size_t m = 0; m < meshes.size(); ++m) {
    Json& primitives = objects(files, meshes[m], "primitives", placeOf("meshes", m));
    for (std::size_t p = 0; p < primitives.size(); ++p) {
      const Json* packed = extension(primitives[p], "KHR_draco_mesh_compression");
      if (!packed) continue;
      DracoStream::Use use{
          &primitives[p],
          placeOf("meshes", m) + "." + placeOf("primitives", p) + ".KHR_draco_mesh_compression",
          {}};
      const std::string& place = use.place;
      const std::uint64_t view_index = wholeNumber(files, *packed, "bufferView", ~std::uint64_t{0}, place);
      if (view_index >= views.size())
        refuse(Exit::kInvalid, files.input(), place, "names a bufferView that does not exist");
      const Json& view = views[static_cast<std::size_t>(view_index)];
      const std::string view_place = placeOf("bufferViews", static_cast<std::size_t>(view_index));
      const auto bytes =
          bufferRange(files, document, wholeNumber(files, view, "buffer", ~std::uint64_t{0}, view_place),
                      wholeNumber(files, view, "byteOffset", 0, view_place),
                      wholeNumber(files, view, "byteLength", 0, view_place), view_place);
      const auto [at, fresh] = known.try_emplace(keyOf(bytes), streams.size());
      if (fresh) {
        packed_bytes += bytes.size();
        if (packed_bytes > kMostOverlap * whole)
          refuse(Exit::kInvalid, files.input(), place,
                 "has overlapping streams of together more than " + std::to_string(kMostOverlap) +
                     " times the buffers' bytes; export it again");
        streams.push_back({bytes, {}, {}});
      }
      DracoStream& stream = streams[at->second];
      const auto attributes = packed->find("attributes");
      if (attributes == packed->end() || !attributes->is_object())
        refuse(Exit::kInvalid, files.input(), place, "has no attributes");
      for (const auto& [name, id] : attributes->items()) {
        (void)id;
        const std::uint64_t value = wholeNumber(files, *attributes, name.c_str(), 0, place);
        if (value > 0xffffffffu)
          refuse(Exit::kInvalid, files.input(), place, "has an attribute id out of range");
        use.ids[name] = static_cast<std::uint32_t>(value);
        stream.ids.emplace(static_cast<std::uint32_t>(value), name);
      }
      stream.uses.push_back(std::move(use));
    }
  }
  return streams;
}

// Makes accessors of one stream for all of its primitives.
void unpackStream(const InputFiles& files, Json& root, DracoStream& stream, DataBudget& budget,
                  GltfDocument& document) {
  const std::string& first = stream.uses.front().place;
  DracoMesh mesh;
  try {
    mesh = decodeDraco(stream.bytes, stream.ids);
  } catch (const DracoUnsupported& error) {
    refuse(Exit::kUnsupported, files.input(), first, error.what());
  } catch (const DracoError& error) {
    refuse(Exit::kInvalid, files.input(), first, error.what());
  }
  Json& accessors = root["accessors"];
  budget.take(mesh.indices.size() * sizeof(std::uint32_t), first);
  const std::size_t indices = accessors.size();
  accessors.push_back({{"bufferView", appendView(root, document, mesh.indices)},
                       {"componentType", 5125},
                       {"count", mesh.indices.size()},
                       {"type", "SCALAR"}});
  // accessors, by attribute and what it was divided by
  std::map<std::pair<std::uint32_t, float>, std::size_t> made;
  for (const DracoStream::Use& use : stream.uses) {
    Json& primitive = *use.primitive;
    std::map<std::string, std::size_t> attributes;
    for (const auto& [name, id] : use.ids) {
      const DracoMesh::Attribute& attribute = mesh.attributes.at(id);
      const float largest = attribute.normalized ? 1 : fractionScale(files, root, primitive, name, use.place);
      const auto [at, fresh] = made.try_emplace({id, largest}, accessors.size());
      attributes[name] = at->second;
      if (!fresh) continue;
      budget.take(attribute.values.size() * sizeof(float), use.place);
      std::vector<float> scaled;
      if (largest != 1)
        std::transform(attribute.values.begin(), attribute.values.end(), std::back_inserter(scaled),
                       [&](float value) { return value / largest; });
      if (attribute.step > 0) document.steps[static_cast<int>(accessors.size())] = attribute.step;
      accessors.push_back(
          {{"bufferView", appendView(root, document, largest != 1 ? scaled : attribute.values)},
           {"componentType", 5126},
           {"count", attribute.values.size() / static_cast<std::size_t>(attribute.components)},
           {"type", kVectorTypes[attribute.components - 1]}});
    }
    primitive["indices"] = indices;
    for (const auto& [name, accessor] : attributes) primitive["attributes"][name] = accessor;
  }
}

}  // namespace

void unpackMeshopt(const InputFiles& files, Json& root, DataBudget& budget, GltfDocument& document) {
  // buffers
  std::map<std::tuple<PackedKey, std::uint64_t, std::uint64_t, std::string, std::string>, std::size_t> done;
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
    const auto bytes =
        bufferRange(files, document, wholeNumber(files, *packed, "buffer", ~std::uint64_t{0}, place),
                    wholeNumber(files, *packed, "byteOffset", 0, place),
                    wholeNumber(files, *packed, "byteLength", 0, place), place);
    const auto [at, fresh] = done.try_emplace({keyOf(bytes), view.count, view.stride, view.mode, view.filter},
                                              document.buffers.size());
    if (fresh) {
      try {
        appendBuffer(document, decodeMeshopt(bytes, view));
      } catch (const MeshoptError& error) {
        refuse(Exit::kInvalid, files.input(), place, error.what());
      }
      budget.take(document.buffers.back().size(), place);
    }
    views[i]["buffer"] = at->second;
    views[i]["byteOffset"] = 0;
    views[i]["byteLength"] = document.buffers[at->second].size();
    views[i]["extensions"].erase("EXT_meshopt_compression");
    if (view.mode == "ATTRIBUTES")
      views[i]["byteStride"] = view.stride;
    else
      views[i].erase("byteStride");
  }
}

void unpackDraco(const InputFiles& files, Json& root, DataBudget& budget, GltfDocument& document) {
  objects(files, root, "bufferViews");
  objects(files, root, "accessors");
  for (DracoStream& stream : findDraco(files, root, document))
    unpackStream(files, root, stream, budget, document);
}

}  // namespace kelp::bake
