// SPDX-License-Identifier: MIT
#include <algorithm>
#include <cstring>

#include "gltf_model.h"

namespace kelp::bake {
namespace {

constexpr std::size_t kMaxElements = std::size_t{1} << 28;
constexpr std::size_t kMaxZeroElements = std::size_t{1} << 22;  // of accessors without bytes behind them

// A range of a buffer: `count` elements of `size` bytes, `stride` bytes apart.
struct Elements {
  const std::uint8_t* data = nullptr;
  std::size_t stride = 0;
};

Elements elementRange(const GltfModel& model, int view_index, std::size_t offset, std::size_t count,
                      std::size_t size, bool strided, const std::string& place) {
  if (view_index < 0 || view_index >= static_cast<int>(model.data.bufferViews.size()))
    model.refuse(place, "names a bufferView that does not exist");
  const tinygltf::BufferView& view = model.data.bufferViews[static_cast<std::size_t>(view_index)];
  const std::span<const std::uint8_t> bytes = readView(model, view_index, place);
  const std::size_t stride = strided && view.byteStride != 0 ? view.byteStride : size;
  if (stride < size)
    model.refuse(placeOf("bufferViews", static_cast<std::size_t>(view_index)),
                 "has a byteStride smaller than the elements that " + place + " reads");
  if (stride > 65536)
    model.refuse(placeOf("bufferViews", static_cast<std::size_t>(view_index)),
                 "has a byteStride beyond reason");
  const bool fits = count == 0 || (offset <= bytes.size() && size <= bytes.size() - offset &&
                                   (count - 1) <= (bytes.size() - offset - size) / stride);
  if (!fits)
    model.refuse(place, "reaches beyond bufferViews[" + std::to_string(view_index) + "] (" +
                            std::to_string(count) + " elements from byte " + std::to_string(offset) + " of " +
                            std::to_string(bytes.size()) + ")");
  return {bytes.data() + (count == 0 ? 0 : offset), stride};
}

template <class T>
T load(const std::uint8_t* bytes) {
  T value;
  std::memcpy(&value, bytes, sizeof value);
  return value;
}

// Section 3.11 of the specification: the signed types map their lowest value to -1 as well.
float component(const std::uint8_t* bytes, int type, bool normalized) {
  switch (type) {
    case TINYGLTF_COMPONENT_TYPE_BYTE: {
      const float value = load<std::int8_t>(bytes);
      return normalized ? std::max(value / 127.0f, -1.0f) : value;
    }
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE: {
      const float value = load<std::uint8_t>(bytes);
      return normalized ? value / 255.0f : value;
    }
    case TINYGLTF_COMPONENT_TYPE_SHORT: {
      const float value = load<std::int16_t>(bytes);
      return normalized ? std::max(value / 32767.0f, -1.0f) : value;
    }
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT: {
      const float value = load<std::uint16_t>(bytes);
      return normalized ? value / 65535.0f : value;
    }
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT:
      return static_cast<float>(load<std::uint32_t>(bytes));
    default:
      return load<float>(bytes);
  }
}

std::size_t componentSize(int type) {
  switch (type) {
    case TINYGLTF_COMPONENT_TYPE_BYTE:
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE:
      return 1;
    case TINYGLTF_COMPONENT_TYPE_SHORT:
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT:
      return 2;
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT:
    case TINYGLTF_COMPONENT_TYPE_FLOAT:
      return 4;
    default:
      return 0;
  }
}

int componentCount(int type) {
  switch (type) {
    case TINYGLTF_TYPE_SCALAR:
      return 1;
    case TINYGLTF_TYPE_VEC2:
      return 2;
    case TINYGLTF_TYPE_VEC3:
      return 3;
    case TINYGLTF_TYPE_VEC4:
      return 4;
    case TINYGLTF_TYPE_MAT4:
      return 16;
    default:
      return 0;
  }
}

std::uint32_t indexAt(const std::uint8_t* bytes, int type) {
  if (type == TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE) return load<std::uint8_t>(bytes);
  if (type == TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT) return load<std::uint16_t>(bytes);
  return load<std::uint32_t>(bytes);
}

bool isIndexType(int type) {
  return type == TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE || type == TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT ||
         type == TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT;
}

const tinygltf::Accessor& findAccessor(const GltfModel& model, int index, const std::string& user) {
  if (index < 0 || index >= static_cast<int>(model.data.accessors.size()))
    model.refuse(user, "names accessor " + std::to_string(index) + ", which does not exist");
  return model.data.accessors[static_cast<std::size_t>(index)];
}

// The indices of the elements that a sparse accessor replaces; all are checked.
struct SparseRange {
  std::size_t count = 0;
  int index_type = 0;
  Elements indices, values;
  std::size_t element(std::size_t i) const { return indexAt(indices.data + i * indices.stride, index_type); }
};

SparseRange sparseRange(const GltfModel& model, const tinygltf::Accessor& accessor, std::size_t size,
                        const std::string& place) {
  const auto& sparse = accessor.sparse;
  if (sparse.count < 0 || static_cast<std::size_t>(sparse.count) > accessor.count)
    model.refuse(place, "has more sparse values than elements");
  if (!isIndexType(sparse.indices.componentType))
    model.refuse(place, "has sparse indices of an unknown type");
  if (sparse.indices.byteOffset < 0 || sparse.values.byteOffset < 0)
    model.refuse(place, "has a negative offset");
  SparseRange out;
  out.count = static_cast<std::size_t>(sparse.count);
  out.index_type = sparse.indices.componentType;
  out.indices =
      elementRange(model, sparse.indices.bufferView, static_cast<std::size_t>(sparse.indices.byteOffset),
                   out.count, componentSize(out.index_type), false, place + ".sparse.indices");
  out.values =
      elementRange(model, sparse.values.bufferView, static_cast<std::size_t>(sparse.values.byteOffset),
                   out.count, size, false, place + ".sparse.values");
  for (std::size_t i = 0; i < out.count; ++i)
    if (out.element(i) >= accessor.count) model.refuse(place, "has a sparse index beyond its elements");
  return out;
}

void applySparse(const GltfModel& model, const tinygltf::Accessor& accessor, bool normalized,
                 const std::string& place, GltfValues& out) {
  const std::size_t one = componentSize(accessor.componentType),
                    width = static_cast<std::size_t>(out.components);
  const SparseRange sparse = sparseRange(model, accessor, one * width, place);
  for (std::size_t i = 0; i < sparse.count; ++i)
    for (std::size_t c = 0; c < width; ++c)
      out.values[sparse.element(i) * width + c] = component(
          sparse.values.data + i * sparse.values.stride + c * one, accessor.componentType, normalized);
}

}  // namespace

std::span<const std::uint8_t> readView(const GltfModel& model, int view_index, const std::string& user) {
  if (view_index < 0 || view_index >= static_cast<int>(model.data.bufferViews.size()))
    model.refuse(user, "names a bufferView that does not exist");
  const tinygltf::BufferView& view = model.data.bufferViews[static_cast<std::size_t>(view_index)];
  const std::string place = placeOf("bufferViews", static_cast<std::size_t>(view_index));
  if (view.buffer < 0 || view.buffer >= static_cast<int>(model.buffers->size()))
    model.refuse(place, "names a buffer that does not exist");
  const std::span<const std::uint8_t> bytes = model.buffers->read(static_cast<std::size_t>(view.buffer));
  if (view.byteOffset > bytes.size() || view.byteLength > bytes.size() - view.byteOffset)
    model.refuse(place, "reaches beyond buffers[" + std::to_string(view.buffer) + "] (" +
                            std::to_string(bytes.size()) + " bytes)");
  return bytes.subspan(view.byteOffset, view.byteLength);
}

GltfValues readValues(const GltfModel& model, int index, const std::string& user, bool fractions) {
  const tinygltf::Accessor& accessor = findAccessor(model, index, user);
  const std::string place = placeOf("accessors", static_cast<std::size_t>(index));
  GltfValues out;
  out.count = accessor.count;
  out.components = componentCount(accessor.type);
  const std::size_t one = componentSize(accessor.componentType),
                    width = static_cast<std::size_t>(out.components);
  if (one == 0 || width == 0) model.refuse(place, "has a type that " + user + " cannot use");
  if (accessor.count > (accessor.bufferView < 0 ? kMaxZeroElements : kMaxElements))
    model.refuse(place, "has more elements than kelp reads");
  model.countRead(out.count * width / 4, place);
  const bool normalized = accessor.normalized || fractions;
  if (accessor.bufferView < 0) {
    out.values.assign(out.count * width, 0.0f);
  } else {
    const Elements elements = elementRange(model, accessor.bufferView, accessor.byteOffset, accessor.count,
                                           one * width, true, place);
    out.values.resize(out.count * width);
    for (std::size_t i = 0; i < out.count; ++i)
      for (std::size_t c = 0; c < width; ++c)
        out.values[i * width + c] =
            component(elements.data + i * elements.stride + c * one, accessor.componentType, normalized);
  }
  if (accessor.sparse.isSparse) applySparse(model, accessor, normalized, place, out);
  return out;
}

GltfValues readSized(const GltfModel& model, int accessor, int least, int most, std::size_t count,
                     const std::string& place, const char* name, bool fractions) {
  GltfValues values = readValues(model, accessor, place + "." + name, fractions);
  if (values.components < least || values.components > most)
    model.refuse(place, std::string(name) + " has the wrong number of components");
  if (values.count != count)
    model.refuse(place, std::string(name) + " has " + std::to_string(values.count) + " values for " +
                            std::to_string(count) + " vertices");
  return values;
}

bool isDraco(const GltfModel& model, int accessor) { return model.draco_steps.contains(accessor); }

float stepOf(const GltfModel& model, int index) {
  if (const auto found = model.draco_steps.find(index); found != model.draco_steps.end())
    return found->second;
  const tinygltf::Accessor& accessor = model.data.accessors[static_cast<std::size_t>(index)];
  const bool fraction = accessor.normalized;
  switch (accessor.componentType) {
    case TINYGLTF_COMPONENT_TYPE_BYTE:
      return fraction ? 1.0f / 127 : 1.0f;
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE:
      return fraction ? 1.0f / 255 : 1.0f;
    case TINYGLTF_COMPONENT_TYPE_SHORT:
      return fraction ? 1.0f / 32767 : 1.0f;
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT:
      return fraction ? 1.0f / 65535 : 1.0f;
    default:
      return 0;
  }
}

std::vector<std::uint32_t> readIndices(const GltfModel& model, int index, const std::string& user) {
  const tinygltf::Accessor& accessor = findAccessor(model, index, user);
  const std::string place = placeOf("accessors", static_cast<std::size_t>(index));
  if (accessor.type != TINYGLTF_TYPE_SCALAR || !isIndexType(accessor.componentType))
    model.refuse(place, "does not hold unsigned integers, as " + user + " needs for indices");
  if (accessor.count > (accessor.bufferView < 0 ? kMaxZeroElements : kMaxElements))
    model.refuse(place, "has more elements than kelp reads");
  std::vector<std::uint32_t> out(accessor.count);
  const std::size_t one = componentSize(accessor.componentType);
  if (accessor.bufferView >= 0) {
    const Elements elements =
        elementRange(model, accessor.bufferView, accessor.byteOffset, accessor.count, one, true, place);
    for (std::size_t i = 0; i < out.size(); ++i)
      out[i] = indexAt(elements.data + i * elements.stride, accessor.componentType);
  }
  if (accessor.sparse.isSparse) {
    const SparseRange sparse = sparseRange(model, accessor, one, place);
    for (std::size_t i = 0; i < sparse.count; ++i)
      out[sparse.element(i)] = indexAt(sparse.values.data + i * sparse.values.stride, accessor.componentType);
  }
  return out;
}

}  // namespace kelp::bake
