// SPDX-License-Identifier: MIT
// Readers of plain meshes; importMesh chooses among them. Each adds at least one material to `out`.
#pragma once

#include <span>

#include "import_files.h"
#include "import_soup.h"

namespace kelp::bake {

// Wavefront OBJ with MTL. `max_memory` as in Settings, for its pictures.
void readObj(const InputFiles& files, std::span<const std::uint8_t> bytes, std::uint64_t max_memory, SourceModel& out, SoupBuilder& soup);
// PLY 1.0: ASCII and binary of either byte order, vertex and face colours.
void readPly(const InputFiles& files, std::span<const std::uint8_t> bytes, SourceModel& out, SoupBuilder& soup);
// STL, ASCII and binary.
void readStl(const InputFiles& files, std::span<const std::uint8_t> bytes, SourceModel& out, SoupBuilder& soup);
// OFF, COFF and NOFF as text.
void readOff(const InputFiles& files, std::span<const std::uint8_t> bytes, SourceModel& out, SoupBuilder& soup);

// Draco files: a mesh's positions and colours.
void readDrc(const InputFiles& files, std::span<const std::uint8_t> bytes, SourceModel& out, SoupBuilder& soup);

// A polygon as its corners' vertices; colours are linear and may be empty.
struct IndexedMesh {
  std::vector<glm::dvec3> positions;
  std::vector<glm::vec4> colors;
};
// Cuts a polygon into the soup, relative to its origin. `place` names it in errors; indices are checked. A face colour multiplies.
void addPolygon(const InputFiles& files, const IndexedMesh& mesh, std::span<const std::int64_t> corners, const std::string& place,
                const glm::vec4* face_color, SoupBuilder& soup);

// The material of files that have none.
SurfaceMaterial plainMaterial();

}  // namespace kelp::bake
