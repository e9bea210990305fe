// SPDX-License-Identifier: MIT
// Readers of plain meshes; importMesh chooses one. Each adds at least one material to `out`. All are safe for
// hostile input.
#pragma once

#include <span>
#include <string>

#include "kelp/import/core/input_files.h"
#include "kelp/import/core/source_model.h"
#include "kelp/import/mesh/soup.h"

namespace kelp::bake {

// Wavefront OBJ with MTL. `max_memory` as in ImportSettings, for its pictures.
void readObj(const InputFiles& files, std::span<const std::uint8_t> bytes, std::uint64_t max_memory,
             SourceModel& out, SoupBuilder& soup);
// PLY 1.0: ASCII and binary of either byte order, vertex and face colors.
void readPly(const InputFiles& files, std::span<const std::uint8_t> bytes, SourceModel& out,
             SoupBuilder& soup);
// STL, ASCII and binary.
void readStl(const InputFiles& files, std::span<const std::uint8_t> bytes, SourceModel& out,
             SoupBuilder& soup);
// OFF, COFF and NOFF as text.
void readOff(const InputFiles& files, std::span<const std::uint8_t> bytes, SourceModel& out,
             SoupBuilder& soup);

// Draco files: a mesh's positions and colors.
void readDrc(const InputFiles& files, std::span<const std::uint8_t> bytes, SourceModel& out,
             SoupBuilder& soup);

// The vertices of a mesh of polygons. Colors are linear; there are none or one for each vertex.
struct IndexedMesh {
  std::vector<glm::dvec3> positions;
  std::vector<glm::vec4> colors;
};
// Adds a polygon to the soup as triangles, relative to the soup's origin. `corners` index the mesh's vertices
// and are checked. `face_color` may be null; it multiplies the vertices' colors. Answers what is wrong with
// the polygon, or nothing.
[[nodiscard]] std::string addPolygon(const IndexedMesh& mesh, std::span<const std::int64_t> corners,
                                     const glm::vec4* face_color, SoupBuilder& soup);

// The number of a full channel, by the largest channel of a file: programs write fractions (some a little
// above 1), or 0 to 255, or more.
double fullChannel(double largest);
// A display color (sRGB) of fractions, as viewers of these formats show it, in linear light. A channel that
// is not finite is full.
glm::vec4 linearColor(const glm::dvec4& fractions);

// The material of files that have none.
SurfaceMaterial plainMaterial();

}  // namespace kelp::bake
