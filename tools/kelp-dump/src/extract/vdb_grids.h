// SPDX-License-Identifier: MIT
// A pack's parts as OpenVDB grids, for the formats vdb and nvdb.
#pragma once

#include <kelp/common/openvdb.h>

#include "extract/extract.h"

namespace kelp::dump {

// The grids of one part have the names that other programs look for: a level set by the part's name and its
// colors in Cd, or density and heat. With several parts, the part's name and a dot stand before these names.
// ToolError.
openvdb::GridPtrVec vdbGrids(const ExtractRequest& request);

// Runs `write` and turns what OpenVDB throws into a ToolError.
template <class Write>
void withOpenVdb(const ExtractRequest& request, Write&& write) {
  try {
    write();
  } catch (const ToolError&) {
    throw;
  } catch (const std::bad_alloc&) {
    throw;
  } catch (const std::exception& error) {
    throw ToolError(Exit::kRuntime, request.output +
                                        ": OpenVDB failed: " + std::string(error.what()).substr(0, 200) +
                                        "; check the disk, or extract a coarser --level");
  }
}

}  // namespace kelp::dump
