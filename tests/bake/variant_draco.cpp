// SPDX-License-Identifier: MIT
#include <cmath>
#include <stdexcept>

#include <draco/compression/encode.h>

#include "variant_writer.h"

namespace kelp::bake::test {
namespace {

template <class T>
int addAttribute(draco::Mesh& mesh, draco::GeometryAttribute::Type type, draco::DataType data, int components,
                 bool normalized, const T* values) {
  draco::GeometryAttribute attribute;
  attribute.Init(type, nullptr, static_cast<std::int8_t>(components), data, normalized,
                 static_cast<std::int64_t>(sizeof(T)) * components, 0);
  const int id = mesh.AddAttribute(attribute, true, mesh.num_points());
  for (std::uint32_t i = 0; i < mesh.num_points(); ++i)
    mesh.attribute(id)->SetAttributeValue(
        draco::AttributeValueIndex(i),
        values + static_cast<std::size_t>(i) * static_cast<std::size_t>(components));
  return static_cast<int>(mesh.attribute(id)->unique_id());
}

std::uint8_t displayByte(float linear) {
  const float value = linear <= 0.0031308f ? 12.92f * linear : 1.055f * std::pow(linear, 1 / 2.4f) - 0.055f;
  return static_cast<std::uint8_t>(std::lround(255 * value));
}

}  // namespace

std::string encodeDraco(const VariantMesh& source, bool edgebreaker, bool bytes, bool metadata,
                        std::map<std::string, int>& ids) {
  draco::Mesh mesh;
  mesh.SetNumFaces(source.indices.size() / 3);
  for (std::size_t i = 0; i + 2 < source.indices.size(); i += 3)
    mesh.SetFace(draco::FaceIndex(static_cast<std::uint32_t>(i / 3)),
                 {draco::PointIndex(source.indices[i]), draco::PointIndex(source.indices[i + 1]),
                  draco::PointIndex(source.indices[i + 2])});
  mesh.set_num_points(static_cast<std::uint32_t>(source.positions.size()));
  ids["POSITION"] = addAttribute(mesh, draco::GeometryAttribute::POSITION, draco::DT_FLOAT32, 3, false,
                                 &source.positions[0].x);
  if (!source.uvs.empty())
    ids["TEXCOORD_0"] = addAttribute(mesh, draco::GeometryAttribute::TEX_COORD, draco::DT_FLOAT32, 2, false,
                                     &source.uvs[0].x);
  if (!source.colors.empty() && bytes) {
    std::vector<std::uint8_t> display;
    for (const glm::vec4& color : source.colors)
      display.insert(display.end(), {displayByte(color.r), displayByte(color.g), displayByte(color.b)});
    addAttribute(mesh, draco::GeometryAttribute::COLOR, draco::DT_UINT8, 3, true, display.data());
  } else if (!source.colors.empty()) {
    ids["COLOR_0"] =
        addAttribute(mesh, draco::GeometryAttribute::COLOR, draco::DT_FLOAT32, 4, false, &source.colors[0].x);
  }
  if (metadata) {
    auto file = std::make_unique<draco::GeometryMetadata>();
    file->AddEntryString("author", "somebody");
    auto part = std::make_unique<draco::Metadata>();
    part->AddEntryInt("answer", 42);
    file->AddSubMetadata("part", std::move(part));
    auto positions = std::make_unique<draco::AttributeMetadata>();
    positions->AddEntryString("name", "positions");
    mesh.AddMetadata(std::move(file));
    mesh.AddAttributeMetadata(mesh.GetNamedAttributeId(draco::GeometryAttribute::POSITION),
                              std::move(positions));
  }
  draco::Encoder encoder;
  encoder.SetEncodingMethod(edgebreaker ? draco::MESH_EDGEBREAKER_ENCODING : draco::MESH_SEQUENTIAL_ENCODING);
  encoder.SetAttributeQuantization(draco::GeometryAttribute::POSITION, 14);
  encoder.SetAttributeQuantization(draco::GeometryAttribute::TEX_COORD, 12);
  draco::EncoderBuffer buffer;
  const draco::Status status = encoder.EncodeMeshToBuffer(mesh, &buffer);
  if (!status.ok()) throw std::runtime_error(status.error_msg());
  return std::string(buffer.data(), buffer.size());
}

}  // namespace kelp::bake::test
