// SPDX-License-Identifier: MIT
#include "second_loader.h"

#include <cmath>
#include <cstring>
#include <map>

#include <assimp/GltfMaterial.h>
#include <assimp/postprocess.h>
#include <assimp/scene.h>
#include <assimp/Importer.hpp>

#include "pixels.h"

namespace kelp::sheet {
namespace {

glm::dmat4 matrixOf(const aiMatrix4x4& m) {
  glm::dmat4 out;
  for (unsigned r = 0; r < 4; ++r) {
    for (unsigned c = 0; c < 4; ++c)
      out[static_cast<int>(c)][static_cast<int>(r)] = static_cast<double>(m[r][c]);
  }
  return out;
}

glm::vec3 vectorOf(const aiColor3D& c) { return {c.r, c.g, c.b}; }

class Reader {
 public:
  Reader(const aiScene& file, const std::filesystem::path& path)
      : file_(file), folder_(path.parent_path()), gltf_(isGltf(path)) {}

  Scene read() {
    for (unsigned i = 0; i < file_.mNumMaterials; ++i)
      scene_.surfaces.push_back(surfaceOf(*file_.mMaterials[i], gltf_ && i + 1 == file_.mNumMaterials));
    placeNodes(*file_.mRootNode, glm::dmat4(1));
    for (const auto& [node, to_world] : nodes_) {
      for (unsigned i = 0; i < node->mNumMeshes; ++i) addMesh(*file_.mMeshes[node->mMeshes[i]], to_world);
    }
    scene_.reader = "assimp";
    return std::move(scene_);
  }

 private:
  static bool isGltf(const std::filesystem::path& path) {
    return path.extension() == ".glb" || path.extension() == ".gltf";
  }

  // glTF's colours are linear; the plain formats say nothing, and painters mean what they see.
  glm::vec3 linear(const glm::vec3& c) const {
    return gltf_ ? c : glm::vec3(linearFromSrgb(c.r), linearFromSrgb(c.g), linearFromSrgb(c.b));
  }

  void placeNodes(const aiNode& node, const glm::dmat4& parent) {
    const glm::dmat4 to_world = parent * matrixOf(node.mTransformation);
    nodes_.emplace_back(&node, to_world);
    named_[node.mName.C_Str()] = to_world;
    for (unsigned i = 0; i < node.mNumChildren; ++i) placeNodes(*node.mChildren[i], to_world);
  }

  // For primitives without a material assimp puts one at the end of a glTF file's. By the format's defaults
  // it is white metal; kelp documents that it takes it for white paint.
  Surface surfaceOf(const aiMaterial& material, bool made_up) {
    Surface surface;
    aiColor3D color(1, 1, 1);
    aiColor4D base;
    if (gltf_ && material.Get(AI_MATKEY_BASE_COLOR, base) == AI_SUCCESS) {
      color = aiColor3D(base.r, base.g, base.b);
    } else {
      material.Get(AI_MATKEY_COLOR_DIFFUSE, color);
    }
    // Where a plain file defines no material assimp makes up a grey one: there is nothing to compare with.
    if (!gltf_ && color == aiColor3D(0.6f, 0.6f, 0.6f)) color = aiColor3D(1, 1, 1);
    surface.color = glm::vec4(linear(vectorOf(color)), 1);
    if (gltf_ && !made_up) {
      material.Get(AI_MATKEY_METALLIC_FACTOR, surface.metallic);
      material.Get(AI_MATKEY_ROUGHNESS_FACTOR, surface.roughness);
    }
    aiColor3D glow(0, 0, 0);
    if (gltf_ && material.Get(AI_MATKEY_COLOR_EMISSIVE, glow) == AI_SUCCESS) surface.glow = vectorOf(glow);
    aiString mode, file;
    if (material.Get(AI_MATKEY_GLTF_ALPHAMODE, mode) == AI_SUCCESS &&
        std::strcmp(mode.C_Str(), "MASK") == 0) {
      surface.alpha_cutoff = 0.5f;
      material.Get(AI_MATKEY_GLTF_ALPHACUTOFF, surface.alpha_cutoff);
    }
    aiTextureMapMode wrap[2] = {aiTextureMapMode_Wrap, aiTextureMapMode_Wrap};
    for (const aiTextureType type : {aiTextureType_BASE_COLOR, aiTextureType_DIFFUSE}) {
      if (material.GetTexture(type, 0, &file, nullptr, nullptr, nullptr, nullptr, wrap) != AI_SUCCESS)
        continue;
      surface.texture = textureOf(file, repeatOf(wrap[0]), repeatOf(wrap[1]));
      if (surface.texture >= 0) break;
    }
    return surface;
  }

  static Repeat repeatOf(aiTextureMapMode mode) {
    return mode == aiTextureMapMode_Clamp    ? Repeat::kNone
           : mode == aiTextureMapMode_Mirror ? Repeat::kMirror
                                             : Repeat::kPlain;
  }

  int textureOf(const aiString& name, Repeat repeat_u, Repeat repeat_v) {
    std::optional<Texture> texture;
    if (const aiTexture* inside = file_.GetEmbeddedTexture(name.C_Str())) {
      if (inside->mHeight == 0) texture = decodeTexture(inside->pcData, inside->mWidth);
    } else {
      std::string file = name.C_Str();
      for (char& c : file) c = c == '\\' ? '/' : c;
      texture = readTexture(folder_ / file);
    }
    if (!texture) return -1;
    texture->repeat_u = repeat_u;
    texture->repeat_v = repeat_v;
    scene_.textures.push_back(std::move(*texture));
    return static_cast<int>(scene_.textures.size()) - 1;
  }

  void addMesh(const aiMesh& mesh, const glm::dmat4& to_world) {
    std::vector<glm::dvec3> positions(mesh.mNumVertices, glm::dvec3(0));
    for (unsigned i = 0; i < mesh.mNumBones; ++i) {
      const aiBone& bone = *mesh.mBones[i];
      const glm::dmat4 skin = named_[bone.mName.C_Str()] * matrixOf(bone.mOffsetMatrix);
      for (unsigned k = 0; k < bone.mNumWeights; ++k) {
        const aiVector3D& v = mesh.mVertices[bone.mWeights[k].mVertexId];
        positions[bone.mWeights[k].mVertexId] +=
            static_cast<double>(bone.mWeights[k].mWeight) * glm::dvec3(skin * glm::dvec4(v.x, v.y, v.z, 1));
      }
    }
    for (unsigned i = 0; mesh.mNumBones == 0 && i < mesh.mNumVertices; ++i) {
      const aiVector3D& v = mesh.mVertices[i];
      positions[i] = glm::dvec3(to_world * glm::dvec4(v.x, v.y, v.z, 1));
    }
    for (unsigned f = 0; f < mesh.mNumFaces; ++f) {
      if (mesh.mFaces[f].mNumIndices != 3) continue;
      Triangle& triangle = scene_.triangles.emplace_back();
      triangle.surface = static_cast<int>(mesh.mMaterialIndex);
      for (std::size_t c = 0; c < 3; ++c) {
        const unsigned at = mesh.mFaces[f].mIndices[c];
        triangle.corner[c].position = positions[at];
        if (mesh.mTextureCoords[0])
          triangle.corner[c].uv = {mesh.mTextureCoords[0][at].x, mesh.mTextureCoords[0][at].y};
        if (mesh.mColors[0]) {
          const aiColor4D& color = mesh.mColors[0][at];
          triangle.corner[c].color = glm::vec4(linear({color.r, color.g, color.b}), color.a);
        }
      }
    }
  }

  const aiScene& file_;
  std::filesystem::path folder_;
  bool gltf_;
  Scene scene_;
  std::vector<std::pair<const aiNode*, glm::dmat4>> nodes_;
  std::map<std::string, glm::dmat4> named_;
};

}  // namespace

std::optional<Scene> readWithAssimp(const std::filesystem::path& path, std::string& why) {
  Assimp::Importer importer;
  const aiScene* file = importer.ReadFile(path.string(), aiProcess_Triangulate);
  if (!file || !file->mRootNode) {
    why = importer.GetErrorString();
    return std::nullopt;
  }
  Scene scene = Reader(*file, path).read();
  if (scene.triangles.empty()) {
    why = "no triangles";
    return std::nullopt;
  }
  return scene;
}

}  // namespace kelp::sheet
