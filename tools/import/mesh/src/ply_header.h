// SPDX-License-Identifier: MIT
// The header of a PLY file: its elements and their properties, and which of these are colors.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "kelp/import/core/input_files.h"

namespace kelp::bake {

enum class PlyType { kNone, kInt8, kUint8, kInt16, kUint16, kInt32, kUint32, kFloat, kDouble };
std::size_t sizeOf(PlyType type);

struct PlyProperty {
  std::string name;                // in lower case
  PlyType count = PlyType::kNone;  // of a list
  PlyType type = PlyType::kNone;
};

struct PlyElement {
  std::string name;
  std::int64_t count = 0;
  std::vector<PlyProperty> properties;

  // Indices into `properties`; -1: none.
  int find(std::string_view wanted) const;
  int findScalar(std::string_view wanted) const;
  int findList(std::string_view wanted, std::string_view other) const;
  // Red, green, blue and alpha. Without one of the first three there is no color.
  std::array<int, 4> findColor() const;
};

enum class PlyEncoding { kText, kLittle, kBig };

struct PlyHeader {
  PlyEncoding encoding = PlyEncoding::kText;
  std::vector<PlyElement> elements;
};

// Takes the header off `text` and checks the counts against the rest. Adds a notice for colors and textures
// that are not read. ToolError kInvalid.
PlyHeader readPlyHeader(const InputFiles& files, std::string_view& text, std::vector<std::string>& notices);

}  // namespace kelp::bake
