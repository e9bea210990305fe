// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <map>
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
  std::map<std::string, Attribute> attributes;
};

// Decodes a Draco mesh; `ids` maps glTF attribute names to Draco's unique ids. Safe for hostile input: the counts that the stream
// declares are checked against its length before any memory is taken.
DracoMesh decodeDraco(std::span<const std::uint8_t> bytes, const std::map<std::string, std::uint32_t>& ids);
// The same for a file of its own: "POSITION" and "COLOR", those that it has.
DracoMesh decodeDraco(std::span<const std::uint8_t> bytes);

}  // namespace kelp::bake
