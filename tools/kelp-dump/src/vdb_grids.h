// SPDX-License-Identifier: MIT
// A pack's parts as OpenVDB's grids, for the two formats that are written of them.
#pragma once

#include <openvdb/openvdb.h>

#include "extract.h"

namespace kelp::dump {

// Of one part, its grids have the names that other programs look for: a level set by the part's name with its colours in Cd, or density and heat. Of several,
// the part's name and a dot stand before them. DumpError.
openvdb::GridPtrVec vdbGrids(const ExtractRequest& request);

// Runs `write`, and makes one line of what OpenVDB throws.
template <class Write>
void withOpenVdb(const ExtractRequest& request, Write&& write) {
  try {
    write();
  } catch (const DumpError&) {
    throw;
  } catch (const std::bad_alloc&) {
    throw;
  } catch (const std::exception& error) {
    throw DumpError(kFailure, request.output + ": OpenVDB failed: " + std::string(error.what()).substr(0, 200) + "; check the disk, or extract a coarser --level");
  }
}

}  // namespace kelp::dump
