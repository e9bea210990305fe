// SPDX-License-Identifier: MIT
// Writes a model of one part as glTF in the ways that compressors write it.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "kelp/import/core/source_model.h"

namespace kelp::bake::test {

// Triangles of one material over vertices of their own.
struct VariantMesh {
  std::uint32_t material = 0;
  std::vector<std::uint32_t> indices;
  std::vector<glm::vec3> positions;
  std::vector<glm::vec2> uvs;     // empty, or one a vertex
  std::vector<glm::vec4> colors;  // empty, or one a vertex; linear
};

class VariantWriter {
 public:
  explicit VariantWriter(const SourceModel& model);

  std::string plain() const;  // floats
  // KHR_mesh_quantization: 14 bits a position, 16 a texture coordinate, 8 a color
  std::string quantized() const;
  // EXT_meshopt_compression over either; floats with the exponential filter
  std::string meshopt(bool quantized) const;
  // KHR_draco_mesh_compression: 14 bits a position, 12 a texture coordinate
  std::string draco(bool edgebreaker = true) const;
  std::string drc(bool metadata) const;  // a .drc file: positions of 14 bits, colors as bytes

 private:
  std::string write(bool quantized, bool meshopt) const;
  std::string materials(bool quantized) const;

  SourceModel model_;  // without its triangles
  std::vector<VariantMesh> meshes_;
  glm::vec3 low_{0};
  float step_ = 1;  // of a quantized position
  glm::vec2 uv_low_{0}, uv_size_{1};
};

// A Draco stream, and the unique ids of POSITION, TEXCOORD_0 and COLOR_0 in it. `bytes`: colors as display
// values of eight bits.
std::string encodeDraco(const VariantMesh& mesh, bool edgebreaker, bool bytes, bool metadata,
                        std::map<std::string, int>& ids);

// A buffer view compressed for EXT_meshopt_compression.
std::string encodeMeshoptVertices(const std::string& bytes, std::size_t stride);
std::string encodeMeshoptTriangles(const std::vector<std::uint32_t>& indices, std::size_t vertices);
// Floats to the exponential filter's integers of 15 bits, one exponent a vector.
std::string filterExponential(const std::vector<glm::vec3>& values);

}  // namespace kelp::bake::test
