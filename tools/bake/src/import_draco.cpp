// SPDX-License-Identifier: MIT
#include "import_draco.h"

#include <algorithm>
#include <array>
#include <memory>
#include <optional>

#include <draco/compression/decode.h>

namespace kelp::bake {
namespace {

constexpr std::uint64_t kMaxFaces = std::uint64_t{1} << 26;
constexpr std::uint64_t kFacesPerByte = 1024;  // the best that entropy coding reaches on regular meshes is far below

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

// Refuses a stream whose declared counts its length can not hold: the library allocates from them first.
// Header: "DRACO", major, minor, encoder type, method, flags (u16). Draco bitstream specification, sections 3 and 4.
void checkDeclaredCounts(std::span<const std::uint8_t> bytes) {
  constexpr std::array<std::uint8_t, 5> kMagic = {'D', 'R', 'A', 'C', 'O'};
  if (bytes.size() < 12 || !std::equal(kMagic.begin(), kMagic.end(), bytes.begin())) throw DracoError("does not begin as a Draco stream");
  const int version = bytes[5] * 256 + bytes[6];
  if (version != 0x202) throw DracoError("is a Draco stream of another version than 2.2; encode it again");
  if (bytes[7] != 1) throw DracoError("holds a point cloud, not a mesh");
  if (bytes[10] & 0x80u) throw DracoError("holds Draco metadata, which glTF does not use; encode it again without");
  std::size_t at = 11;
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
      throw DracoError("declares " + std::to_string(*count) + " faces or points in " + std::to_string(bytes.size()) + " bytes; the data are damaged");
  }
}

DracoMesh::Attribute readAttribute(const draco::Mesh& mesh, const draco::PointAttribute& attribute) {
  DracoMesh::Attribute out;
  out.components = attribute.num_components();
  out.normalized = attribute.normalized();
  if (out.components < 1 || out.components > 4) throw DracoError("has an attribute of more than four components");
  const auto width = static_cast<std::size_t>(out.components);
  out.values.resize(width * mesh.num_points());
  for (draco::PointIndex point(0); point < mesh.num_points(); ++point) {
    const draco::AttributeValueIndex value = attribute.mapped_index(point);
    if (value.value() >= attribute.size()) throw DracoError("maps a point to a value that does not exist; the data are damaged");
    float* to = out.values.data() + width * point.value();
    if (!attribute.ConvertValue<float>(value, static_cast<std::int8_t>(out.components), to)) throw DracoError("has an attribute of an unknown type");
  }
  return out;
}

}  // namespace

DracoMesh decodeDraco(std::span<const std::uint8_t> bytes, const std::map<std::string, std::uint32_t>& ids) {
  checkDeclaredCounts(bytes);
  draco::DecoderBuffer buffer;
  buffer.Init(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  draco::Decoder decoder;
  draco::StatusOr<std::unique_ptr<draco::Mesh>> decoded = decoder.DecodeMeshFromBuffer(&buffer);
  if (!decoded.ok()) throw DracoError(std::string("can not be decoded: ") + decoded.status().error_msg());
  const std::unique_ptr<draco::Mesh> mesh = std::move(decoded).value();

  DracoMesh out;
  out.indices.reserve(std::size_t{3} * mesh->num_faces());
  for (draco::FaceIndex face(0); face < mesh->num_faces(); ++face) {
    for (const draco::PointIndex& corner : mesh->face(face)) {
      if (corner.value() >= mesh->num_points()) throw DracoError("has a face that names a point that does not exist; the data are damaged");
      out.indices.push_back(corner.value());
    }
  }
  for (const auto& [name, id] : ids) {
    const draco::PointAttribute* attribute = mesh->GetAttributeByUniqueId(id);
    if (!attribute) throw DracoError("has no attribute with the id " + std::to_string(id) + " that " + name + " names");
    out.attributes[name] = readAttribute(*mesh, *attribute);
  }
  return out;
}

}  // namespace kelp::bake
