// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <stdexcept>
#include <string>
#include <vector>

namespace kelp::bake {

struct DracoError : std::runtime_error {
  using std::runtime_error::runtime_error;
};

// The stream seems sound, but kelp does not read its kind.
struct DracoUnsupported : DracoError {
  using DracoError::DracoError;
};

struct DracoMesh {
  struct Attribute {
    int components = 0;         // 1 to 4
    bool normalized = false;    // integers were scaled to 0..1 or -1..1 as the stream asks
    float step = 0;             // the step to which the encoder rounded the values; 0: not rounded
    float largest = 1;          // the largest value of integers that were not scaled
    std::vector<float> values;  // components a point
  };
  std::vector<std::uint32_t> indices;             // three a face, below the number of points
  std::map<std::uint32_t, Attribute> attributes;  // by Draco's unique id
  std::optional<std::uint32_t> position, color;   // the ids of both, in a .drc file
};

// Decodes a Draco mesh with the attributes of `ids`; each has a name for messages. DracoError if that fails.
// Safe for hostile input: the declared counts are checked against the stream's length before memory is taken.
DracoMesh decodeDraco(std::span<const std::uint8_t> bytes, const std::map<std::uint32_t, std::string>& ids);
// The same for a .drc file: its positions and, if it has them, colors.
DracoMesh decodeDraco(std::span<const std::uint8_t> bytes);

}  // namespace kelp::bake
