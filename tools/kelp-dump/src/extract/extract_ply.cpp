// SPDX-License-Identifier: MIT
// The visible faces of voxels as a mesh. Each face has corners of its own, so every viewer shows its colour
// and the voxel's normal. Corners in one place are equal to the last bit, so welding makes the mesh
// watertight.
#include <cmath>
#include <limits>

#include <fmt/format.h>

#include "extract/extract.h"
#include "kelp/common/console.h"
#include "kelp/common/output_file.h"
#include "text/text.h"

namespace kelp::dump {
namespace {

// Common readers store a vertex's index in a signed 32-bit number.
constexpr std::uint64_t kMostFaces = static_cast<std::uint64_t>(std::numeric_limits<std::int32_t>::max()) / 4;

struct Face {
  glm::ivec3 outward;
  glm::ivec3 corners[4];  // of the voxel's cube, counter-clockwise seen from outside
};
constexpr int kFaces = 6;

Face faceOf(int side) {
  const int axis = side / 2, u = (axis + 1) % 3, v = (axis + 2) % 3;
  const bool high = side % 2 == 1;
  Face face{glm::ivec3(0), {}};
  face.outward[axis] = high ? 1 : -1;
  for (int i = 0; i < 4; ++i) {
    const int at = high ? i : 3 - i;  // (0,0) (1,0) (1,1) (0,1), or back
    glm::ivec3& corner = face.corners[i];
    corner = glm::ivec3(0);
    corner[axis] = high ? 1 : 0;
    corner[u] = at == 1 || at == 2 ? 1 : 0;
    corner[v] = at >= 2 ? 1 : 0;
  }
  return face;
}

template <class F>
void eachFace(const LevelVoxels& level, F&& f) {
  Face faces[kFaces];
  for (int side = 0; side < kFaces; ++side) faces[side] = faceOf(side);
  level.eachSolid([&](const glm::ivec3& voxel) {
    for (const Face& face : faces)
      if (!level.solid(voxel + face.outward)) f(voxel, face);
  });
}

void writeVertices(const ExtractRequest& request, const LevelVoxels& level, OutputFile& out) {
  const std::span<const Material> palette = request.file.pack().palette();
  const glm::dmat4x3& to_object = level.toObject();
  // Normals transform by the inverse transpose. Up to a positive factor that is the matrix of cofactors times
  // the sign of the determinant.
  const glm::dmat3 linear(to_object);
  const bool mirrored = glm::determinant(linear) < 0;
  const double sign = mirrored ? -1.0 : 1.0;
  const glm::dmat3 normal_to_object(sign * glm::cross(linear[1], linear[2]),
                                    sign * glm::cross(linear[2], linear[0]),
                                    sign * glm::cross(linear[0], linear[1]));
  eachFace(level, [&](const glm::ivec3& voxel, const Face& face) {
    const std::optional<std::uint32_t> attribute = level.attribute(voxel);
    const glm::vec3 stored = attribute ? decodeNormal(attributeNormal(*attribute)) : glm::vec3(face.outward);
    const std::size_t entry = attribute ? attributePalette(*attribute) : 0;
    const Rgba color = displayColor(palette[std::min(entry, palette.size() - 1)]);
    const glm::dvec3 normal = glm::normalize(normal_to_object * glm::dvec3(stored));
    for (int i = 0; i < 4; ++i) {
      const glm::ivec3 corner = voxel + face.corners[mirrored ? 3 - i : i];
      const glm::vec3 place(to_object * glm::dvec4(glm::dvec3(corner), 1));
      for (int axis = 0; axis < 3; ++axis) out.number(place[axis]);
      for (int axis = 0; axis < 3; ++axis) out.number(static_cast<float>(normal[axis]));
      for (const std::uint8_t channel : {color.r, color.g, color.b, color.a}) out.number(channel);
    }
  });
}

}  // namespace

void extractPly(const ExtractRequest& request) {
  const std::vector<std::uint32_t> parts = solidParts(request, "a mesh");
  std::uint64_t faces = 0;
  for (const std::uint32_t part : parts)
    eachFace(request.read(part), [&](const glm::ivec3&, const Face&) { ++faces; });
  if (faces > kMostFaces)
    throw ToolError(
        Exit::kUnsupported,
        fmt::format(
            "{}: has {} visible voxel faces, a PLY file holds {}; extract a coarser --level, or one --part",
            request.file.path(), countText(faces), countText(kMostFaces)));
  OutputFile out = OutputFile::orStandardOutput(console::pathOf(request.output));
  std::string header =
      "ply\nformat binary_little_endian 1.0\ncomment kelp-dump " KELP_VERSION ", metres, +y up\n";
  header += fmt::format("element vertex {}\n", 4 * faces);
  for (const char* name : {"x", "y", "z", "nx", "ny", "nz"})
    header += fmt::format("property float {}\n", name);
  for (const char* name : {"red", "green", "blue", "alpha"})
    header += fmt::format("property uchar {}\n", name);
  out.write(header +
            fmt::format("element face {}\nproperty list uchar int vertex_indices\nend_header\n", faces));
  for (const std::uint32_t part : parts) writeVertices(request, request.read(part), out);
  for (std::uint64_t face = 0; face < faces; ++face) {
    out.number(std::uint8_t{4});
    for (std::uint64_t corner = 0; corner < 4; ++corner)
      out.number(static_cast<std::int32_t>(4 * face + corner));
  }
  out.commit();
}

constinit const Writer kPlyWriter{.shown_as = "a binary PLY", .write = extractPly};

}  // namespace kelp::dump
