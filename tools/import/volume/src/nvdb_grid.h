// SPDX-License-Identifier: MIT
// One grid of NanoVDB, as it lies in memory: checked, and made a grid of OpenVDB's.
#pragma once

#include <string>

#include <kelp/common/openvdb.h>

#include "nvdb_checksum.h"
#include "volume_grid.h"

namespace kelp::bake {

struct NanoType {
  std::uint32_t number;
  const char* name;
  GridKind kind;
  // `grid` is aligned to 32 bytes, and its head is complete. std::runtime_error that names a fault.
  openvdb::GridBase::Ptr (*convert)(NanoBytes grid);
};

// null: kelp does not read it
const NanoType* findNanoType(std::uint32_t number);
std::string nanoTypeName(std::uint32_t number);

}  // namespace kelp::bake
