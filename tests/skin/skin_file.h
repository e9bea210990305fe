// SPDX-License-Identifier: MIT
// glTF files with skins, made in memory: GltfTruth reads them, and so does the importer.
#pragma once

#include <array>
#include <cstdint>
#include <cstring>
#include <string>
#include <utility>
#include <vector>

#include <glm/glm.hpp>
#include <nlohmann/json.hpp>

namespace kelp::bake::test {

class SkinFile {
 public:
  using Json = nlohmann::json;
  struct Vertex {
    glm::vec3 at{0};
    std::array<std::uint16_t, 4> joints{};
    std::array<float, 4> weights{1, 0, 0, 0};
  };

  // Returns its index. It is in the scene if it is nobody's child.
  int addNode(const std::string& name, int parent, const Json& more = Json::object()) {
    const auto index = static_cast<int>(nodes_.size());
    nodes_.push_back(more);
    nodes_.back()["name"] = name;
    if (parent < 0)
      roots_.push_back(index);
    else
      nodes_[static_cast<std::size_t>(parent)]["children"].push_back(index);
    return index;
  }

  // Without `inverse_binds`, the file has none.
  int addSkin(const std::vector<int>& joints, const std::vector<glm::dmat4>& inverse_binds = {}) {
    Json skin{{"joints", joints}};
    std::vector<float> numbers;
    for (const glm::dmat4& matrix : inverse_binds)
      for (int i = 0; i < 16; ++i) numbers.push_back(static_cast<float>(matrix[i / 4][i % 4]));
    if (!inverse_binds.empty()) skin["inverseBindMatrices"] = accessor(numbers, 5126, "MAT4", 16);
    skins_.push_back(std::move(skin));
    return static_cast<int>(skins_.size()) - 1;
  }

  // A column of boxes along y, each `width` wide; a ring of vertices each half a unit, which `ring` gives its
  // joints and weights. Returns the node.
  template <class Ring>
  int addColumn(int skin, double height, double width, const Ring& ring) {
    std::vector<Vertex> vertices;
    std::vector<std::uint16_t> faces;
    const int rings = static_cast<int>(2 * height) + 1;
    for (int k = 0; k < rings; ++k)
      for (int corner = 0; corner < 4; ++corner) {
        Vertex vertex = ring(0.5 * k);
        vertex.at = {(corner == 0 || corner == 3 ? -0.5 : 0.5) * width, 0.5 * k,
                     (corner < 2 ? 0.5 : -0.4) * width};
        vertices.push_back(vertex);
      }
    const auto face = [&](int a, int b, int c, int d) {
      for (const int i : {a, b, c, a, c, d}) faces.push_back(static_cast<std::uint16_t>(i));
    };
    for (int k = 0; k + 1 < rings; ++k)
      for (int corner = 0; corner < 4; ++corner) {
        const int a = 4 * k + corner, b = 4 * k + (corner + 1) % 4;
        face(a, b, b + 4, a + 4);
      }
    face(3, 2, 1, 0);
    face(4 * rings - 4, 4 * rings - 3, 4 * rings - 2, 4 * rings - 1);
    std::vector<float> places, weights;
    std::vector<std::uint16_t> joints;
    for (const Vertex& vertex : vertices) {
      places.insert(places.end(), {vertex.at.x, vertex.at.y, vertex.at.z});
      joints.insert(joints.end(), vertex.joints.begin(), vertex.joints.end());
      weights.insert(weights.end(), vertex.weights.begin(), vertex.weights.end());
    }
    meshes_.push_back({{"primitives",
                        {{{"attributes",
                           {{"POSITION", accessor(places, 5126, "VEC3", 3)},
                            {"JOINTS_0", accessor(joints, 5123, "VEC4", 4)},
                            {"WEIGHTS_0", accessor(weights, 5126, "VEC4", 4)}}},
                          {"indices", accessor(faces, 5123, "SCALAR", 1)}}}}});
    return addNode("mesh", -1, {{"mesh", meshes_.size() - 1}, {"skin", skin}});
  }

  // A channel of the clip of this name; clips have the order in which they first come.
  void animate(const std::string& clip, int node, const std::string& path, const std::vector<float>& times,
               const std::vector<float>& values, const std::string& interpolation = "LINEAR") {
    std::size_t a = 0;
    while (a < animations_.size() && animations_[a]["name"] != clip) ++a;
    if (a == animations_.size())
      animations_.push_back({{"name", clip}, {"samplers", Json::array()}, {"channels", Json::array()}});
    Json& animation = animations_[a];
    animation["channels"].push_back(
        {{"sampler", animation["samplers"].size()}, {"target", {{"node", node}, {"path", path}}}});
    const bool turns = path == "rotation";
    animation["samplers"].push_back(
        {{"input", accessor(times, 5126, "SCALAR", 1)},
         {"output", accessor(values, 5126, turns ? "VEC4" : "VEC3", turns ? 4 : 3)},
         {"interpolation", interpolation}});
  }

  std::string text() const {
    Json file{
        {"asset", {{"version", "2.0"}}},
        {"scene", 0},
        {"scenes", {{{"nodes", roots_}}}},
        {"nodes", nodes_},
        {"skins", skins_},
        {"meshes", meshes_},
        {"accessors", accessors_},
        {"bufferViews", views_},
        {"buffers",
         {{{"byteLength", buffer_.size()}, {"uri", "data:application/octet-stream;base64," + coded()}}}}};
    if (!animations_.empty()) file["animations"] = animations_;
    return file.dump();
  }

 private:
  template <class T>
  std::size_t accessor(const std::vector<T>& values, int component, const char* type, std::size_t width) {
    views_.push_back(
        {{"buffer", 0}, {"byteOffset", buffer_.size()}, {"byteLength", values.size() * sizeof(T)}});
    buffer_.append(reinterpret_cast<const char*>(values.data()), values.size() * sizeof(T));
    buffer_.resize((buffer_.size() + 3) / 4 * 4);
    accessors_.push_back({{"bufferView", views_.size() - 1},
                          {"componentType", component},
                          {"count", values.size() / width},
                          {"type", type}});
    return accessors_.size() - 1;
  }

  std::string coded() const {
    const char* digits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    std::string out;
    for (std::size_t i = 0; i < buffer_.size(); i += 3) {
      std::uint32_t bits = 0;
      for (std::size_t j = 0; j < 3; ++j)
        bits = bits << 8 | (i + j < buffer_.size() ? static_cast<unsigned char>(buffer_[i + j]) : 0u);
      for (std::size_t j = 0; j < 4; ++j)
        out += j <= buffer_.size() - i ? digits[bits >> (18 - 6 * j) & 63] : '=';
    }
    return out;
  }

  Json nodes_ = Json::array(), skins_ = Json::array(), meshes_ = Json::array(), animations_ = Json::array(),
       accessors_ = Json::array(), views_ = Json::array();
  std::vector<int> roots_;
  std::string buffer_;
};

}  // namespace kelp::bake::test
