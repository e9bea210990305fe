// SPDX-License-Identifier: MIT
// Replaces compressed geometry by plain buffers in tinygltf's document. Later stages know nothing of
// compression.
#include <cmath>
#include <cstring>
#include <map>
#include <span>
#include <string>
#include <utility>

#include <meshoptimizer.h>

#include "gltf_model.h"
#include "kelp/import/mesh/draco.h"

namespace kelp::bake {
namespace {

using tinygltf::Value;

const Value* extensionOf(const tinygltf::ExtensionMap& extensions, const char* name) {
  const auto found = extensions.find(name);
  return found != extensions.end() && found->second.IsObject() ? &found->second : nullptr;
}

std::size_t wholeNumber(const GltfModel& model, const Value& object, const std::string& name,
                        const std::string& place) {
  const Value& value = object.Get(name);
  if (!value.IsInt() || value.GetNumberAsInt() < 0)
    model.refuse(place, oneLine(name, 60) + " is not a whole number of at least 0");
  return static_cast<std::size_t>(value.GetNumberAsInt());
}

std::string textOf(const Value& object, const char* name, const char* otherwise) {
  return object.Get(name).IsString() ? object.Get(name).Get<std::string>() : otherwise;
}

template <class T>
std::vector<std::uint8_t> bytesOf(const std::vector<T>& values) {
  std::vector<std::uint8_t> bytes(values.size() * sizeof(T));
  if (!bytes.empty()) std::memcpy(bytes.data(), values.data(), bytes.size());
  return bytes;
}

// The fields of EXT_meshopt_compression.
struct MeshoptView {
  std::size_t count = 0, stride = 0;
  std::string mode, filter;
};

// Decodes one compressed buffer view to count * stride bytes.
std::vector<std::uint8_t> decodeMeshopt(const GltfModel& model, std::span<const std::uint8_t> bytes,
                                        const MeshoptView& view, const std::string& place) {
  // The codec needs at least two bits for every 16 bytes of a channel, even for zeros, and a byte for every
  // triangle. A count of more than twice that is false.
  constexpr std::size_t kMaxRatio = 128, kMaxBytes = std::size_t{2} << 30;
  const bool attributes = view.mode == "ATTRIBUTES";
  if (!attributes && view.mode != "TRIANGLES" && view.mode != "INDICES")
    model.refuse(place, "has an unknown mode");
  const bool stride_ok = attributes ? view.stride > 0 && view.stride <= 256 && view.stride % 4 == 0
                                    : view.stride == 2 || view.stride == 4;
  if (!stride_ok) model.refuse(place, "has a byteStride that its mode does not allow");
  if (view.mode == "TRIANGLES" && view.count % 3 != 0)
    model.refuse(place, "has a count that is not a multiple of three");
  if (view.count > kMaxBytes / view.stride || view.count * view.stride > 4096 + kMaxRatio * bytes.size())
    model.refuse(place, "asks for more elements than its bytes can hold");

  const std::size_t count = view.count, stride = view.stride;
  std::vector<std::uint8_t> out(count * stride);
  const int result = attributes
                         ? meshopt_decodeVertexBuffer(out.data(), count, stride, bytes.data(), bytes.size())
                     : view.mode == "TRIANGLES"
                         ? meshopt_decodeIndexBuffer(out.data(), count, stride, bytes.data(), bytes.size())
                         : meshopt_decodeIndexSequence(out.data(), count, stride, bytes.data(), bytes.size());
  if (result != 0) model.refuse(place, "cannot be decoded; the data are damaged");

  if (!attributes || view.filter == "NONE") return out;
  if (view.filter == "OCTAHEDRAL" && (stride == 4 || stride == 8))
    meshopt_decodeFilterOct(out.data(), count, stride);
  else if (view.filter == "QUATERNION" && stride == 8)
    meshopt_decodeFilterQuat(out.data(), count, stride);
  else if (view.filter == "EXPONENTIAL")
    meshopt_decodeFilterExp(out.data(), count, stride);
  else
    model.refuse(place, "has a filter that is unknown or does not suit its byteStride");
  return out;
}

// The largest value of normalized integers; 1 for other types. The accessor says whether they are normalized:
// not every encoder writes it into the stream.
float fractionScale(const GltfModel& model, const tinygltf::Primitive& primitive, const std::string& name,
                    const std::string& place) {
  const auto attribute = primitive.attributes.find(name);
  if (attribute == primitive.attributes.end()) return 1;
  if (attribute->second < 0 || attribute->second >= static_cast<int>(model.data.accessors.size()))
    model.refuse(place, oneLine(name, 60) + " names an accessor that does not exist");
  const tinygltf::Accessor& accessor = model.data.accessors[static_cast<std::size_t>(attribute->second)];
  const float step = accessor.normalized ? stepOf(model, attribute->second) : 0;
  return step > 0 ? std::round(1 / step) : 1;
}

int addAccessor(GltfModel& model, std::vector<std::uint8_t> bytes, int component, int components,
                std::size_t count, const std::string& place) {
  tinygltf::BufferView& view = model.data.bufferViews.emplace_back();
  view.byteLength = bytes.size();
  view.buffer = static_cast<int>(model.buffers->add(std::move(bytes), place));
  tinygltf::Accessor& accessor = model.data.accessors.emplace_back();
  accessor.bufferView = static_cast<int>(model.data.bufferViews.size()) - 1;
  accessor.componentType = component;
  accessor.type = components == 1 ? TINYGLTF_TYPE_SCALAR : components;
  accessor.count = count;
  return static_cast<int>(model.data.accessors.size()) - 1;
}

DracoMesh decode(const GltfModel& model, std::span<const std::uint8_t> bytes,
                 const std::map<std::uint32_t, std::string>& names, const std::string& place) {
  model.countRead(bytes.size(), place);
  try {
    return decodeDraco(bytes, names);
  } catch (const DracoUnsupported& error) {
    refuse(Exit::kUnsupported, model.files->input(), place, error.what());
  } catch (const DracoError& error) {
    model.refuse(place, error.what());
  }
}

void unpackPrimitive(GltfModel& model, tinygltf::Primitive& primitive, const std::string& place) {
  const Value* const packed = extensionOf(primitive.extensions, "KHR_draco_mesh_compression");
  if (!packed) return;
  const Value& attributes = packed->Get("attributes");
  if (!attributes.IsObject()) model.refuse(place, "has no attributes");
  std::map<std::uint32_t, std::string> names;
  std::map<std::string, std::uint32_t> ids;
  for (const std::string& name : attributes.Keys()) {
    ids[name] = static_cast<std::uint32_t>(wholeNumber(model, attributes, name, place));
    names.emplace(ids[name], name);
  }
  const std::size_t view = wholeNumber(model, *packed, "bufferView", place);
  const DracoMesh mesh = decode(model, readView(model, static_cast<int>(view), place), names, place);
  primitive.indices = addAccessor(model, bytesOf(mesh.indices), TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT, 1,
                                  mesh.indices.size(), place);
  for (const auto& [name, id] : ids) {
    const DracoMesh::Attribute& attribute = mesh.attributes.at(id);
    std::vector<float> values = attribute.values;
    if (const float largest = attribute.normalized ? 1 : fractionScale(model, primitive, name, place);
        largest != 1)
      for (float& value : values) value /= largest;
    const int accessor =
        addAccessor(model, bytesOf(values), TINYGLTF_COMPONENT_TYPE_FLOAT, attribute.components,
                    values.size() / static_cast<std::size_t>(attribute.components), place);
    if (attribute.step > 0) model.draco_steps[accessor] = attribute.step;
    primitive.attributes[name] = accessor;
  }
}

}  // namespace

void unpackMeshopt(GltfModel& model) {
  for (std::size_t i = 0; i < model.data.bufferViews.size(); ++i) {
    tinygltf::BufferView& view = model.data.bufferViews[i];
    const Value* const packed = extensionOf(view.extensions, "EXT_meshopt_compression");
    if (!packed) continue;
    const std::string place = placeOf("bufferViews", i) + ".EXT_meshopt_compression";
    const auto number = [&](const char* name) { return wholeNumber(model, *packed, name, place); };
    const MeshoptView wanted{number("count"), number("byteStride"), textOf(*packed, "mode", ""),
                             textOf(*packed, "filter", "NONE")};
    view.buffer = static_cast<int>(number("buffer"));
    view.byteOffset = packed->Has("byteOffset") ? number("byteOffset") : 0;
    view.byteLength = number("byteLength");
    std::vector<std::uint8_t> bytes =
        decodeMeshopt(model, readView(model, static_cast<int>(i), place), wanted, place);
    view.byteOffset = 0;
    view.byteLength = bytes.size();
    view.byteStride = wanted.mode == "ATTRIBUTES" ? wanted.stride : 0;
    view.buffer = static_cast<int>(model.buffers->add(std::move(bytes), place));
  }
}

void unpackDraco(GltfModel& model) {
  for (std::size_t m = 0; m < model.data.meshes.size(); ++m)
    for (std::size_t p = 0; p < model.data.meshes[m].primitives.size(); ++p)
      unpackPrimitive(model, model.data.meshes[m].primitives[p],
                      placeOf("meshes", m) + "." + placeOf("primitives", p) + ".KHR_draco_mesh_compression");
}

}  // namespace kelp::bake
