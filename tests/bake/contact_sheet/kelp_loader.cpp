// SPDX-License-Identifier: MIT
#include "kelp/bake/bake.h"
#include "second_loader.h"

namespace kelp::sheet {

std::optional<Scene> readWithKelp(const std::filesystem::path& path, std::string& why) {
  try {
    const bake::SourceModel model = bake::importFile(path, {});
    Scene scene;
    scene.reader = "kelp";
    for (const bake::Image& image : model.images) {
      Texture& texture = scene.textures.emplace_back();
      texture.width = image.width;
      texture.height = image.height;
      for (std::size_t i = 0; i < image.rgba.size(); i += 4) {
        const auto channel = [&](std::size_t c) { return static_cast<float>(image.rgba[i + c]) / 255.0f; };
        texture.texels.emplace_back(linearFromSrgb(channel(0)), linearFromSrgb(channel(1)),
                                    linearFromSrgb(channel(2)), channel(3));
      }
    }
    for (const bake::SurfaceMaterial& material : model.materials) {
      scene.surfaces.push_back({material.base_color, material.emissive, material.texture,
                                material.alpha_cutoff, material.metallic, material.roughness});
    }
    for (const bake::SourcePart& part : model.parts) {
      const glm::dmat4x3 to_object(part.to_object);
      for (std::size_t t = 0; t < part.soup.triangles.size(); ++t) {
        Triangle& triangle = scene.triangles.emplace_back();
        triangle.surface = static_cast<int>(part.soup.triangles[t].material);
        for (std::size_t c = 0; c < 3; ++c) {
          Corner& corner = triangle.corner[c];
          corner.position =
              to_object * glm::dvec4(glm::dvec3(part.soup.positions[part.soup.triangles[t].vertex[c]]), 1.0);
          if (!part.soup.uvs.empty()) corner.uv = {part.soup.uvs[t][c].x, 1.0f - part.soup.uvs[t][c].y};
          if (!part.soup.colors.empty()) corner.color = part.soup.colors[t][c];
        }
      }
    }
    return scene;
  } catch (const kelp::ToolError& error) {
    why = error.what();
    return std::nullopt;
  }
}

}  // namespace kelp::sheet
