// SPDX-License-Identifier: MIT
// Rig files that the editor writes.
#pragma once

#include <string>

#include "rig_editor.h"

namespace kelp::view {

// Writes the part's rig to a file for kelp-bake. If the pack has several parts, the file keeps the rigs that
// it has for others. ToolError kIo if it cannot be read or written, kInvalid if it holds anything that would
// be lost.
void saveRig(const std::string& path, const RigEditor& editor, int part);

}  // namespace kelp::view
