// SPDX-License-Identifier: MIT
// Draco files: a mesh with positions, and colors as draco_encoder writes them from PLY.
#include <algorithm>

#include "kelp/common/error.h"
#include "kelp/common/srgb.h"
#include "kelp/import/core/source_model.h"
#include "kelp/import/mesh/draco.h"
#include "mesh_file.h"

namespace kelp::bake {

void readDrc(const InputFiles& files, std::span<const std::uint8_t> bytes, SourceModel& out,
             SoupBuilder& soup) {
  out.format = "Draco";
  out.materials.push_back(plainMaterial());
  DracoMesh mesh;
  try {
    mesh = decodeDraco(bytes);
  } catch (const DracoUnsupported& error) {
    refuse(Exit::kUnsupported, files.input(), "", error.what());
  } catch (const DracoError& error) {
    refuse(Exit::kInvalid, files.input(), "", error.what());
  }
  const auto find = [&](std::optional<std::uint32_t> id) {
    return id ? mesh.attributes.find(*id) : mesh.attributes.end();
  };
  const auto at = find(mesh.position);
  if (at == mesh.attributes.end() || at->second.components != 3)
    refuse(Exit::kInvalid, files.input(), "", "has no positions of three coordinates");
  const std::vector<float>& positions = at->second.values;
  const auto colors = find(mesh.color);
  const auto colorOf = [&](std::uint32_t point) {
    glm::vec4 color(1);
    const auto width = static_cast<std::size_t>(colors->second.components);
    for (std::size_t c = 0; c < width; ++c)
      color[static_cast<int>(c)] =
          std::clamp(colors->second.values[width * point + c] / colors->second.largest, 0.0f, 1.0f);
    if (width < 3) color = {color.x, color.x, color.x, 1};  // gray
    return glm::vec4(srgbToLinear(color.r), srgbToLinear(color.g), srgbToLinear(color.b), color.a);
  };
  for (std::size_t i = 0; i + 2 < mesh.indices.size(); i += 3) {
    SoupBuilder::Triangle triangle;
    if (colors != mesh.attributes.end()) triangle.color.emplace();
    for (std::size_t c = 0; c < 3; ++c) {
      const std::uint32_t point = mesh.indices[i + c];
      triangle.position[c] = {positions[3 * std::size_t{point}], positions[3 * std::size_t{point} + 1],
                              positions[3 * std::size_t{point} + 2]};
      if (triangle.color) (*triangle.color)[c] = colorOf(point);
    }
    if (!soup.add(triangle))
      refuse(Exit::kInvalid, files.input(), "", "has more than 64 million triangles; bake it in pieces");
  }
}

}  // namespace kelp::bake
