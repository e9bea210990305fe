// SPDX-License-Identifier: MIT
// In place of vdb_program.cpp where kelp-dump-vdb can not be.
#include "extract.h"

namespace kelp::dump {

constinit const Writer kVdbWriter{.name = "vdb", .needs = "OpenVDB"};
constinit const Writer kNanoVdbWriter{.name = "nvdb", .needs = "OpenVDB and NanoVDB"};

}  // namespace kelp::dump
