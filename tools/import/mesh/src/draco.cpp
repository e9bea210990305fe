// SPDX-License-Identifier: MIT
#include "kelp/import/mesh/draco.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <optional>

#include <draco/attributes/attribute_quantization_transform.h>
#include <draco/compression/decode.h>

namespace kelp::bake {
namespace {

constexpr std::uint64_t kMaxFaces = std::uint64_t{1} << 26;
constexpr std::uint64_t kFacesPerByte = 64;  // a flat regular grid, which nothing predicts better, has 3.3

// The unsigned LEB128 numbers of a Draco stream.
std::optional<std::uint64_t> readVarint(std::span<const std::uint8_t> bytes, std::size_t& at) {
  std::uint64_t value = 0;
  for (int shift = 0; shift < 35; shift += 7) {
    if (at >= bytes.size()) return std::nullopt;
    const std::uint8_t byte = bytes[at++];
    value |= static_cast<std::uint64_t>(byte & 0x7fu) << shift;
    if (!(byte & 0x80u)) return value;
  }
  return std::nullopt;
}

// Entries and sub-elements of one element of metadata. Lengths beyond the stream are refused before the
// library takes memory for them.
void skipElement(std::span<const std::uint8_t> bytes, std::size_t& at, int depth) {
  const auto skip = [&](std::uint64_t count) {
    if (count > bytes.size() - at) throw DracoError("ends inside its metadata; the data are truncated");
    at += static_cast<std::size_t>(count);
  };
  const auto number = [&] {
    const std::optional<std::uint64_t> value = readVarint(bytes, at);
    if (!value) throw DracoError("ends inside its metadata; the data are truncated");
    return *value;
  };
  const auto name = [&] {
    skip(1);
    skip(bytes[at - 1]);
  };
  if (depth > 8) throw DracoError("has metadata nested deeper than eight levels; the data are damaged");
  for (std::uint64_t entries = number(); entries > 0; --entries) {
    name();
    skip(number());
  }
  for (std::uint64_t elements = number(); elements > 0; --elements) {
    name();
    skipElement(bytes, at, depth + 1);
  }
}

// Draco bitstream specification, section 4.1: one element for each attribute that has any, then the file's
// own.
void skipMetadata(std::span<const std::uint8_t> bytes, std::size_t& at) {
  const std::optional<std::uint64_t> attributes = readVarint(bytes, at);
  if (!attributes || *attributes > bytes.size())
    throw DracoError("ends inside its metadata; the data are truncated");
  for (std::uint64_t i = 0; i < *attributes; ++i) {
    if (!readVarint(bytes, at)) throw DracoError("ends inside its metadata; the data are truncated");
    skipElement(bytes, at, 0);
  }
  skipElement(bytes, at, 0);
}

// Refuses a stream whose declared counts do not fit its length: the library would allocate memory by them.
// Header: "DRACO", major, minor, encoder type, method, flags (u16). Draco bitstream specification, sections 3
// and 4.
void checkDeclaredCounts(std::span<const std::uint8_t> bytes) {
  constexpr std::array<std::uint8_t, 5> kMagic = {'D', 'R', 'A', 'C', 'O'};
  if (bytes.size() < 12 || !std::equal(kMagic.begin(), kMagic.end(), bytes.begin()))
    throw DracoError("does not begin as a Draco stream");
  const int version = bytes[5] * 256 + bytes[6];
  if (version != 0x202)
    throw DracoUnsupported("is a Draco stream of another version than 2.2; encode it again");
  if (bytes[7] != 1) throw DracoUnsupported("holds a point cloud, which has no surface; encode a mesh");
  std::size_t at = 11;
  if (bytes[10] & 0x80u) skipMetadata(bytes, at);
  std::array<std::optional<std::uint64_t>, 2> counts;
  if (bytes[8] == 1) {  // edgebreaker: traversal type, encoded vertices, faces
    ++at;
    counts = {readVarint(bytes, at), std::nullopt};
    counts[1] = readVarint(bytes, at);
  } else {  // sequential: faces, points
    counts[0] = readVarint(bytes, at);
    counts[1] = readVarint(bytes, at);
  }
  for (const auto& count : counts) {
    if (!count) throw DracoError("ends inside its header; the data are truncated");
    if (*count > kMaxFaces || *count > 4096 + kFacesPerByte * bytes.size())
      throw DracoError("declares " + std::to_string(*count) + " faces or points in " +
                       std::to_string(bytes.size()) + " bytes; the data are damaged");
  }
}

float largestOf(draco::DataType type) {
  switch (type) {
    case draco::DT_INT8:
      return 127.0f;
    case draco::DT_UINT8:
      return 255.0f;
    case draco::DT_INT16:
      return 32767.0f;
    case draco::DT_UINT16:
      return 65535.0f;
    default:
      return 1.0f;
  }
}

// Positions are read as the stored integers, so that their rounding step is known.
void scaleBack(const draco::PointAttribute& attribute, DracoMesh::Attribute& out) {
  draco::AttributeQuantizationTransform transform;
  if (!transform.InitFromAttribute(attribute))
    throw DracoError("has positions whose scale is missing; the data are damaged");
  const int bits = transform.quantization_bits();
  if (bits < 1 || bits > 30 || !std::isfinite(transform.range()))
    throw DracoError("has positions whose scale is damaged");
  out.step = transform.range() / static_cast<float>((std::int64_t{1} << bits) - 1);
  for (std::size_t i = 0; i < out.values.size(); ++i)
    out.values[i] = out.values[i] * out.step +
                    transform.min_value(static_cast<int>(i % static_cast<std::size_t>(out.components)));
}

DracoMesh::Attribute readAttribute(const draco::Mesh& mesh, const draco::PointAttribute& attribute) {
  DracoMesh::Attribute out;
  out.components = attribute.num_components();
  out.normalized = attribute.normalized();
  out.largest = out.normalized ? 1.0f : largestOf(attribute.data_type());
  if (out.components < 1 || out.components > 4)
    throw DracoError("has an attribute of more than four components");
  const auto width = static_cast<std::size_t>(out.components);
  out.values.resize(width * mesh.num_points());
  for (draco::PointIndex point(0); point < mesh.num_points(); ++point) {
    const draco::AttributeValueIndex value = attribute.mapped_index(point);
    if (value.value() >= attribute.size())
      throw DracoError("maps a point to a value that does not exist; the data are damaged");
    float* to = out.values.data() + width * point.value();
    if (!attribute.ConvertValue<float>(value, static_cast<std::int8_t>(out.components), to))
      throw DracoError("has an attribute of an unknown type");
  }
  const draco::AttributeTransformData* transform = attribute.GetAttributeTransformData();
  if (transform && transform->transform_type() == draco::ATTRIBUTE_QUANTIZATION_TRANSFORM)
    scaleBack(attribute, out);
  return out;
}

// The mesh; its indices are checked.
std::unique_ptr<draco::Mesh> decodeMesh(std::span<const std::uint8_t> bytes, DracoMesh& out) {
  checkDeclaredCounts(bytes);
  draco::DecoderBuffer buffer;
  buffer.Init(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  draco::Decoder decoder;
  decoder.SetSkipAttributeTransform(draco::GeometryAttribute::POSITION);
  draco::StatusOr<std::unique_ptr<draco::Mesh>> decoded = decoder.DecodeMeshFromBuffer(&buffer);
  if (!decoded.ok()) throw DracoError(std::string("cannot be decoded: ") + decoded.status().error_msg());
  std::unique_ptr<draco::Mesh> mesh = std::move(decoded).value();
  out.indices.reserve(std::size_t{3} * mesh->num_faces());
  for (draco::FaceIndex face(0); face < mesh->num_faces(); ++face) {
    for (const draco::PointIndex& corner : mesh->face(face)) {
      if (corner.value() >= mesh->num_points())
        throw DracoError("has a face that names a point that does not exist; the data are damaged");
      out.indices.push_back(corner.value());
    }
  }
  return mesh;
}

}  // namespace

DracoMesh decodeDraco(std::span<const std::uint8_t> bytes, const std::map<std::uint32_t, std::string>& ids) {
  DracoMesh out;
  const std::unique_ptr<draco::Mesh> mesh = decodeMesh(bytes, out);
  for (const auto& [id, name] : ids) {
    const draco::PointAttribute* attribute = mesh->GetAttributeByUniqueId(id);
    if (!attribute)
      throw DracoError("has no attribute with the id " + std::to_string(id) + " that " + name + " names");
    out.attributes[id] = readAttribute(*mesh, *attribute);
  }
  return out;
}

DracoMesh decodeDraco(std::span<const std::uint8_t> bytes) {
  DracoMesh out;
  const std::unique_ptr<draco::Mesh> mesh = decodeMesh(bytes, out);
  const auto read = [&](draco::GeometryAttribute::Type type) -> std::optional<std::uint32_t> {
    const draco::PointAttribute* const attribute = mesh->GetNamedAttribute(type);
    if (!attribute) return std::nullopt;
    out.attributes[attribute->unique_id()] = readAttribute(*mesh, *attribute);
    return attribute->unique_id();
  };
  out.position = read(draco::GeometryAttribute::POSITION);
  out.color = read(draco::GeometryAttribute::COLOR);
  return out;
}

}  // namespace kelp::bake
