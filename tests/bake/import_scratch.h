// SPDX-License-Identifier: MIT
// Small files for the importers' tests, written where a test may write.
#pragma once

#include <gtest/gtest.h>

#include <array>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <functional>
#include <iterator>
#include <string>
#include <utility>
#include <vector>

#include "kelp/bake/bake.h"
#include "support/scratch.h"

namespace kelp::bake::test {

using kelp::test::Scratch;

inline SourceModel importText(const Scratch& scratch, const std::string& text,
                              const Settings& settings = {}) {
  return importFile(scratch.write("model.gltf", text), settings);
}

// The message of the ToolError that importing a file throws; its code must be `code`.
inline std::string refusal(const std::filesystem::path& path, Exit code, const Settings& settings = {}) {
  try {
    importFile(path, settings);
  } catch (const ToolError& error) {
    EXPECT_EQ(static_cast<int>(error.exit), static_cast<int>(code)) << error.what();
    EXPECT_EQ(std::string(error.what()).find('\n'), std::string::npos) << error.what();
    return error.what();
  }
  ADD_FAILURE() << path << " was accepted";
  return {};
}

inline Settings with(const std::function<void(Settings&)>& change) {
  Settings settings;
  change(settings);
  return settings;
}

inline std::string contentOf(const std::filesystem::path& path) {
  std::ifstream in(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>()};
}

inline bool contains(const std::string& text, const std::string& part) {
  return text.find(part) != std::string::npos;
}

inline bool anyContains(const std::vector<std::string>& lines, const std::string& part) {
  for (const std::string& line : lines)
    if (contains(line, part)) return true;
  return false;
}

struct Bounds {
  glm::vec3 low{1e30f}, high{-1e30f};
};
inline Bounds boundsOf(const SourcePart& part) {
  Bounds bounds;
  for (const glm::vec3& p : part.soup.positions) {
    const glm::vec3 object = part.to_object * glm::vec4(p, 1);
    bounds.low = glm::min(bounds.low, object);
    bounds.high = glm::max(bounds.high, object);
  }
  return bounds;
}

// Volume by the divergence theorem, in the object: positive where the triangles wind counter-clockwise seen
// from outside.
inline double signedVolume(const SourcePart& part) {
  double volume = 0;
  for (const auto& triangle : part.soup.triangles) {
    std::array<glm::dvec3, 3> p;
    for (std::size_t i = 0; i < 3; ++i) p[i] = glm::dvec3(part.soup.positions[triangle.vertex[i]]);
    volume += glm::dot(p[0], glm::cross(p[1], p[2])) / 6;
  }
  return volume;
}

inline std::string base64(const std::string& bytes) {
  const char* digits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string out;
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    std::uint32_t bits = 0;
    for (std::size_t j = 0; j < 3; ++j)
      bits = bits << 8 | (i + j < bytes.size() ? static_cast<unsigned char>(bytes[i + j]) : 0u);
    for (std::size_t j = 0; j < 4; ++j)
      out += j <= bytes.size() - i ? digits[bits >> (18 - 6 * j) & 63] : '=';
  }
  return out;
}

template <class T>
std::string bytesOf(const std::vector<T>& values) {
  return {reinterpret_cast<const char*>(values.data()), values.size() * sizeof(T)};
}

using Texels = std::vector<std::array<std::uint8_t, 4>>;

// A TGA picture: uncompressed true color with alpha, first row at the top.
inline std::string tga(const Texels& texels, int width) {
  const auto height = texels.size() / static_cast<std::size_t>(width);
  std::string bytes("\0\0\2\0\0\0\0\0\0\0\0\0", 12);
  bytes += {static_cast<char>(width), 0, static_cast<char>(height), 0, 32, 0x28};
  for (const auto& t : texels)
    bytes +=
        {static_cast<char>(t[2]), static_cast<char>(t[1]), static_cast<char>(t[0]), static_cast<char>(t[3])};
  return bytes;
}

// A glTF file in the making: one buffer as a data URI; accessors are numbered in the order of their adding.
class GltfMaker {
 public:
  int floats(const std::vector<float>& values, int components) {
    static const char* const kTypes[] = {"SCALAR", "VEC2", "VEC3", "VEC4"};
    return add(bytesOf(values), 5126, values.size() / static_cast<std::size_t>(components),
               kTypes[components - 1]);
  }
  int indices(const std::vector<std::uint16_t>& values) {
    return add(bytesOf(values), 5123, values.size(), "SCALAR");
  }

  int joints(const std::vector<std::uint16_t>& values) {
    return add(bytesOf(values), 5123, values.size() / 4, "VEC4");
  }

  // Accessor 0: eight corners of the box [-0.1, 0.1] x [0, 2] x [-0.1, 0.1]; accessor 1: its twelve
  // triangles, wound outward.
  void addBox() {
    std::vector<float> corners;
    for (int i = 0; i < 8; ++i) {
      corners.push_back(i & 1 ? 0.1f : -0.1f);
      corners.push_back(i & 2 ? 2.0f : 0.0f);
      corners.push_back(i & 4 ? 0.1f : -0.1f);
    }
    floats(corners, 3);
    indices({0, 2, 1, 1, 2, 3, 4, 5, 6, 5, 7, 6, 0, 1, 4, 1, 5, 4,
             2, 6, 3, 3, 6, 7, 0, 4, 2, 2, 4, 6, 1, 3, 5, 3, 7, 5});
  }

  // JOINTS_0 and WEIGHTS_0 of addBox's corners: how much joints 0 and 1 of the skin hold its lower and its
  // upper end.
  std::pair<int, int> addBoxWeights(const glm::vec2& lower, const glm::vec2& upper) {
    std::vector<std::uint16_t> held;
    std::vector<float> weights;
    for (int i = 0; i < 8; ++i) {
      const glm::vec2& weight = i & 2 ? upper : lower;
      held.insert(held.end(), {0, 1, 0, 0});
      weights.insert(weights.end(), {weight.x, weight.y, 0, 0});
    }
    const int first = joints(held);
    return {first, floats(weights, 4)};
  }

  // An accessor over bytes of its own; `more` is further members of it.
  int add(const std::string& bytes, int component, std::size_t count, const char* type,
          const std::string& more = "") {
    const std::string comma = next_ == 0 ? "" : ",";
    views_ += comma + R"({"buffer":0,"byteOffset":)" + std::to_string(buffer_.size()) + R"(,"byteLength":)" +
              std::to_string(bytes.size()) + "}";
    accessors_ += comma + R"({"bufferView":)" + std::to_string(next_) + R"(,"componentType":)" +
                  std::to_string(component) + R"(,"count":)" + std::to_string(count) + R"(,"type":")" + type +
                  "\"" + (more.empty() ? "" : "," + more) + "}";
    buffer_ += bytes;
    buffer_.resize((buffer_.size() + 3) / 4 * 4);
    return next_++;
  }

  // `rest` is the other members of the root object.
  std::string text(const std::string& rest) const {
    return R"({"asset":{"version":"2.0"},"buffers":[{"byteLength":)" + std::to_string(buffer_.size()) +
           R"(,"uri":"data:application/octet-stream;base64,)" + base64(buffer_) + R"("}],"bufferViews":[)" +
           views_ + R"(],"accessors":[)" + accessors_ + "]," + rest + "}";
  }
  static std::string boxMesh() {
    return R"("meshes":[{"primitives":[{"attributes":{"POSITION":0},"indices":1}]}])";
  }

 private:
  std::string buffer_, views_, accessors_;
  int next_ = 0;
};

}  // namespace kelp::bake::test
