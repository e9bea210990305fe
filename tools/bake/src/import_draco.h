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

// Sound, as far as it was looked at, but not of a kind that is read.
struct DracoUnsupported : DracoError {
  using DracoError::DracoError;
};

struct DracoMesh {
  struct Attribute {
    int components = 0;          // 1 to 4
    bool normalized = false;     // integers were scaled to 0..1 or -1..1 as the stream asks
    float step = 0;              // to which the encoder rounded the values; 0: not at all
    float largest = 1;           // what integers that were not scaled count to
    std::vector<float> values;   // components a point
  };
  std::vector<std::uint32_t> indices;  // three a face, below the number of points
  std::map<std::uint32_t, Attribute> attributes;   // by Draco's unique ids
  std::optional<std::uint32_t> position, color;    // of these, in a file of its own
};

// Decodes a Draco mesh with the attributes of `ids`, each with the name that a message gives it. Safe for hostile input: the counts that the stream
// declares are checked against its length before any memory is taken.
DracoMesh decodeDraco(std::span<const std::uint8_t> bytes, const std::map<std::uint32_t, std::string>& ids);
// The same for a file of its own: positions and colours, those that it has.
DracoMesh decodeDraco(std::span<const std::uint8_t> bytes);

}  // namespace kelp::bake
