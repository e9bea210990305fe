// SPDX-License-Identifier: MIT
// In place of vdb_program.cpp on systems without kelp-dump-vdb.
#include "extract/extract.h"

namespace kelp::dump {

constinit const Writer kVdbWriter{.needs = "OpenVDB"};
constinit const Writer kNanoVdbWriter{.needs = "OpenVDB and NanoVDB"};

}  // namespace kelp::dump
