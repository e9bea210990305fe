// SPDX-License-Identifier: MIT
// A second reader of glTF, as short as it can be: the JSON as it stands, in double precision, for what nodes
// and vertices do over time. Knows what the tests' files hold (one buffer, no compressed data) and checks
// nothing.
#pragma once

#include <array>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <vector>

#include <glm/glm.hpp>
#include <nlohmann/json.hpp>

namespace kelp::bake::test {

class GltfTruth {
 public:
  explicit GltfTruth(const std::filesystem::path& path) {
    std::string text = contentOf(path);
    if (path.extension() == ".glb") {  // a header, then two chunks, each with its size and kind in front
      std::uint32_t size = 0;
      std::memcpy(&size, text.data() + 12, 4);
      buffer_ = text.substr(20 + size + 8);
      text = text.substr(20, size);
    }
    json_ = nlohmann::json::parse(text);
    const std::string uri = json_["buffers"][0].value("uri", "");
    if (uri.rfind("data:", 0) == 0) {
      buffer_ = decode(uri.substr(uri.find(',') + 1));
    } else if (!uri.empty()) {
      buffer_ = contentOf(path.parent_path() / uri);
    }
    parents_.assign(json_["nodes"].size(), -1);
    for (std::size_t i = 0; i < parents_.size(); ++i)
      for (const auto& child : json_["nodes"][i].value("children", nlohmann::json::array()))
        parents_[child.get<std::size_t>()] = static_cast<int>(i);
  }

  // A node's transform at a time of an animation; animation -1: at rest.
  glm::dmat4 world(int node, int animation, double time) const {
    const glm::dmat4 local = localAt(node, animation, time);
    const int parent = parents_[static_cast<std::size_t>(node)];
    return parent < 0 ? local : world(parent, animation, time) * local;
  }

  // The corners of a node's triangles, three a triangle, in the space of its mesh, morphed.
  std::vector<glm::dvec3> corners(int node, int animation = -1, double time = 0) const {
    return cornersAt(node, weightsAt(node, animation, time));
  }
  std::vector<glm::dvec3> cornersAt(int node, const std::vector<double>& weights) const {
    std::vector<glm::dvec3> out;
    for (const auto& primitive : meshOf(node)["primitives"]) {
      std::vector<glm::dvec3> at = vectors(primitive["attributes"]["POSITION"]);
      for (std::size_t t = 0; t < weights.size(); ++t) {
        const std::vector<glm::dvec3> delta = vectors(primitive["targets"][t]["POSITION"]);
        for (std::size_t i = 0; i < at.size(); ++i) at[i] += weights[t] * delta[i];
      }
      each(primitive, at.size(), [&](std::size_t i) { out.push_back(at[i]); });
    }
    return out;
  }

  // The same in the world, by the node or, where it has one, by its skin.
  std::vector<glm::dvec3> worldCorners(int node, int animation, double time) const {
    return worldCornersAt(node, animation, time, weightsAt(node, animation, time));
  }
  std::vector<glm::dvec3> worldCornersAt(int node, int animation, double time,
                                         const std::vector<double>& weights) const {
    std::vector<glm::dvec3> out = cornersAt(node, weights);
    const auto& source = json_["nodes"][static_cast<std::size_t>(node)];
    if (!source.contains("skin")) {
      const glm::dmat4 matrix = world(node, animation, time);
      for (glm::dvec3& p : out) p = glm::dvec3(matrix * glm::dvec4(p, 1));
      return out;
    }
    const auto& skin = json_["skins"][source["skin"].get<std::size_t>()];
    std::vector<double> binds;
    if (skin.contains("inverseBindMatrices")) binds = numbers(skin["inverseBindMatrices"]);
    std::vector<glm::dmat4> joints;
    for (std::size_t j = 0; j < skin["joints"].size(); ++j) {
      glm::dmat4 bind(1);
      for (int c = 0; c < 16 && !binds.empty(); ++c)
        bind[c / 4][c % 4] = binds[16 * j + static_cast<std::size_t>(c)];
      joints.push_back(world(skin["joints"][j], animation, time) * bind);
    }
    std::size_t corner = 0;
    for (const auto& primitive : meshOf(node)["primitives"]) {
      const std::vector<double> which = numbers(primitive["attributes"]["JOINTS_0"]),
                                weight = numbers(primitive["attributes"]["WEIGHTS_0"]);
      each(primitive, weight.size() / 4, [&](std::size_t i) {
        glm::dvec4 sum(0);
        for (std::size_t c = 4 * i; c < 4 * i + 4; ++c)
          sum += weight[c] * (joints[static_cast<std::size_t>(which[c])] * glm::dvec4(out[corner], 1));
        out[corner++] = glm::dvec3(sum) / sum.w;
      });
    }
    return out;
  }

 private:
  using Json = nlohmann::json;

  static std::string contentOf(const std::filesystem::path& path) {
    std::ifstream file(path, std::ios::binary);
    return {std::istreambuf_iterator<char>(file), {}};
  }

  static std::string decode(const std::string& text) {
    static const std::string kDigits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    std::string out;
    unsigned bits = 0;
    int count = 0;
    for (const char c : text) {
      if (c == '=') break;
      bits = bits << 6 | static_cast<unsigned>(kDigits.find(c));
      if ((count += 6) >= 8) out += static_cast<char>(bits >> (count -= 8) & 255);
    }
    return out;
  }

  std::vector<double> numbers(std::size_t accessor) const {
    const Json& a = json_["accessors"][accessor];
    const std::string type = a["type"];
    const std::size_t width = type == "SCALAR" ? 1
                              : type == "MAT4" ? 16
                                               : static_cast<std::size_t>(type[3] - '0');
    if (!a.contains("sparse")) return numbers(a, width, a["componentType"], a["count"]);
    const Json& sparse = a["sparse"];
    std::vector<double> out(width * a["count"].get<std::size_t>(), 0.0);
    if (a.contains("bufferView")) out = numbers(a, width, a["componentType"], a["count"]);
    const std::vector<double> at = numbers(sparse["indices"], 1, sparse["indices"]["componentType"],
                                           sparse["count"]),
                              values = numbers(sparse["values"], width, a["componentType"], sparse["count"]);
    for (std::size_t i = 0; i < values.size(); ++i)
      out[width * static_cast<std::size_t>(at[i / width]) + i % width] = values[i];
    return out;
  }

  std::vector<double> numbers(const Json& a, std::size_t width, int component, std::size_t count) const {
    const Json& view = json_["bufferViews"][a["bufferView"].get<std::size_t>()];
    const std::size_t size = component == 5126 || component == 5125 ? 4 : component == 5123 ? 2 : 1;
    const std::size_t stride = view.value("byteStride", width * size),
                      first =
                          view.value("byteOffset", std::size_t{0}) + a.value("byteOffset", std::size_t{0});
    std::vector<double> out;
    for (std::size_t i = 0; i < count; ++i) {
      for (std::size_t c = 0; c < width; ++c) {
        const char* at = buffer_.data() + first + i * stride + c * size;
        float real;
        std::uint32_t whole = 0;
        std::memcpy(&real, at, size == 4 ? 4 : 0);
        std::memcpy(&whole, at, size);
        out.push_back(component == 5126 ? static_cast<double>(real) : static_cast<double>(whole));
      }
    }
    return out;
  }

  std::vector<glm::dvec3> vectors(std::size_t accessor) const {
    const std::vector<double> flat = numbers(accessor);
    std::vector<glm::dvec3> out;
    for (std::size_t i = 0; i < flat.size(); i += 3) out.emplace_back(flat[i], flat[i + 1], flat[i + 2]);
    return out;
  }

  template <class Visit>
  void each(const Json& primitive, std::size_t vertices, const Visit& visit) const {
    if (primitive.contains("indices")) {
      for (const double index : numbers(primitive["indices"])) visit(static_cast<std::size_t>(index));
    } else {
      for (std::size_t i = 0; i < vertices; ++i) visit(i);
    }
  }

  const Json& meshOf(int node) const {
    return json_["meshes"][json_["nodes"][static_cast<std::size_t>(node)]["mesh"].get<std::size_t>()];
  }

  // The animated value of a property of a node; empty: it is not animated. Sections 3.11 and C of the
  // specification.
  std::vector<double> animated(int node, const std::string& path, std::size_t width, int animation,
                               double time) const {
    if (animation < 0) return {};
    const Json& source = json_["animations"][static_cast<std::size_t>(animation)];
    for (const Json& channel : source["channels"]) {
      if (channel["target"]["node"] != node || channel["target"]["path"] != path) continue;
      const Json& sampler = source["samplers"][channel["sampler"].get<std::size_t>()];
      const std::vector<double> times = numbers(sampler["input"]), values = numbers(sampler["output"]);
      const std::string how = sampler.value("interpolation", "LINEAR");
      const std::size_t rows = how == "CUBICSPLINE" ? 3 : 1;
      const auto row = [&](std::size_t key, std::size_t part) {
        const auto at = values.begin() + static_cast<std::ptrdiff_t>((key * rows + part) * width);
        return std::vector<double>(at, at + static_cast<std::ptrdiff_t>(width));
      };
      std::size_t k = 0;
      while (k + 1 < times.size() && times[k + 1] <= time) ++k;
      const std::vector<double> a = row(k, rows / 2);
      if (time <= times[0] || k + 1 == times.size() || how == "STEP") return a;
      const std::vector<double> b = row(k + 1, rows / 2);
      const double span = times[k + 1] - times[k], t = (time - times[k]) / span;
      std::vector<double> out(width);
      if (rows == 3) {
        const std::vector<double> leave = row(k, 2), arrive = row(k + 1, 0);
        for (std::size_t i = 0; i < width; ++i)
          out[i] = (1 + 2 * t) * (1 - t) * (1 - t) * a[i] + span * t * (1 - t) * (1 - t) * leave[i] +
                   t * t * (3 - 2 * t) * b[i] + span * t * t * (t - 1) * arrive[i];
        return out;
      }
      double wa = 1 - t, wb = t;
      if (path == "rotation") {
        double dot = 0;
        for (std::size_t i = 0; i < 4; ++i) dot += a[i] * b[i];
        const double angle = std::acos(std::min(1.0, std::abs(dot)));
        if (angle > 1e-9) {
          wa = std::sin((1 - t) * angle) / std::sin(angle);
          wb = std::sin(t * angle) / std::sin(angle);
        }
        if (dot < 0) wb = -wb;
      }
      for (std::size_t i = 0; i < width; ++i) out[i] = wa * a[i] + wb * b[i];
      return out;
    }
    return {};
  }

  std::vector<double> weightsAt(int node, int animation, double time) const {
    const Json& source = json_["nodes"][static_cast<std::size_t>(node)];
    const Json& mesh = meshOf(node);
    const std::size_t count = mesh["primitives"][0].value("targets", Json::array()).size();
    std::vector<double> at = animated(node, "weights", count, animation, time);
    if (at.empty()) at = source.value("weights", mesh.value("weights", std::vector<double>()));
    at.resize(count, 0.0);
    return at;
  }

  glm::dmat4 localAt(int node, int animation, double time) const {
    const Json& source = json_["nodes"][static_cast<std::size_t>(node)];
    glm::dmat4 matrix(1);
    if (source.contains("matrix")) {
      for (int c = 0; c < 16; ++c) matrix[c / 4][c % 4] = source["matrix"][static_cast<std::size_t>(c)];
      return matrix;
    }
    const auto property = [&](const char* path, std::vector<double> otherwise) {
      const std::vector<double> moved = animated(node, path, otherwise.size(), animation, time);
      return moved.empty() ? source.value(path, otherwise) : moved;
    };
    const std::vector<double> t = property("translation", {0, 0, 0}), s = property("scale", {1, 1, 1});
    std::vector<double> q = property("rotation", {0, 0, 0, 1});
    const double length = std::sqrt(q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3]);
    for (double& component : q) component /= length;
    const double x = q[0], y = q[1], z = q[2], w = q[3];
    matrix[0] = s[0] * glm::dvec4(1 - 2 * (y * y + z * z), 2 * (x * y + z * w), 2 * (x * z - y * w), 0);
    matrix[1] = s[1] * glm::dvec4(2 * (x * y - z * w), 1 - 2 * (x * x + z * z), 2 * (y * z + x * w), 0);
    matrix[2] = s[2] * glm::dvec4(2 * (x * z + y * w), 2 * (y * z - x * w), 1 - 2 * (x * x + y * y), 0);
    matrix[3] = glm::dvec4(t[0], t[1], t[2], 1);
    return matrix;
  }

  Json json_;
  std::string buffer_;
  std::vector<int> parents_;
};

}  // namespace kelp::bake::test
