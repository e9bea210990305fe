// SPDX-License-Identifier: MIT
// Meshes as somebody else reads them: assimp, so that a mistake of kelp's importers shows as a difference
// between two pictures.
#pragma once

#include <array>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include <glm/glm.hpp>

namespace kelp::sheet {

enum class Repeat { kPlain, kMirror, kNone };

// Linear RGBA, row 0 at v = 1.
struct Texture {
  int width = 0, height = 0;
  std::vector<glm::vec4> texels;
  Repeat repeat_u = Repeat::kPlain, repeat_v = Repeat::kPlain;
};

struct Surface {
  glm::vec4 color{1};  // linear
  glm::vec3 glow{0};
  int texture = -1;
  float alpha_cutoff = 0;
  float metallic = 0, roughness = 1;
};

struct Corner {
  glm::dvec3 position{0};  // world
  glm::vec2 uv{0};         // v upward
  glm::vec4 color{1};      // linear
};

struct Triangle {
  std::array<Corner, 3> corner;
  int surface = 0;
};

struct Scene {
  std::vector<Triangle> triangles;
  std::vector<Surface> surfaces;
  std::vector<Texture> textures;
  std::string reader;  // who read it, for the caption
};

// All triangles of the file's scene at rest, skins in their bind pose. nullopt where assimp cannot read it
// (`why` then says so).
std::optional<Scene> readWithAssimp(const std::filesystem::path& path, std::string& why);

// The same from kelp's own importer, for files that assimp cannot read. nullopt where kelp refuses them too.
std::optional<Scene> readWithKelp(const std::filesystem::path& path, std::string& why);

float linearFromSrgb(float value);

}  // namespace kelp::sheet
