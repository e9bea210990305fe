// SPDX-License-Identifier: MIT
// The tree of a grid in an OpenVDB file: first its topology, with the values of its tables, then the voxels
// of its leaves.
#pragma once

#include <optional>

#include "sparse_grid.h"
#include "vdb_cursor.h"

namespace kelp::bake {

enum class VdbScalar : std::uint8_t { kFloat, kDouble, kInt32, kInt64, kBool };

struct VdbType {
  GridKind kind = GridKind::kScalar;
  VdbScalar scalar = VdbScalar::kFloat;
  int components = 1;
  bool mask = false;  // voxels have no values but their active state
};
// Of the format's word for it ("float", "vec3s"); nullopt if kelp does not read it.
std::optional<VdbType> vdbType(std::string_view word);

// How the bytes of a grid are written.
struct VdbCoding {
  VdbType type;
  bool half = false;              // floats are stored in 16 bits
  std::uint32_t version = 0;      // of the file
  std::uint32_t compression = 0;  // flags, below
};
inline constexpr std::uint32_t kVdbZip = 1, kVdbActiveMask = 2, kVdbBlosc = 4;
// from it on, inactive values are left out and compression is each grid's own
inline constexpr std::uint32_t kVdbMaskVersion = 222;

// Fills all but the leaves' numbers. Trees that would take more than `limit` bytes are refused (kRuntime)
// before the memory is.
void readVdbTopology(VdbCursor& cursor, const VdbCoding& coding, std::uint64_t limit, SparseGrid& grid);
// The leaves' numbers, after the topology. With keep = false they are only stepped over.
void readVdbLeaves(VdbCursor& cursor, const VdbCoding& coding, std::uint64_t limit, SparseGrid& grid,
                   bool keep = true);

}  // namespace kelp::bake
