// SPDX-License-Identifier: MIT
// How large a part will be, known before its voxels are.
#pragma once

#include "kelp/import/core/frame.h"
#include "kelp/import/core/memory_estimate.h"
#include "kelp/import/core/source_model.h"

namespace kelp::bake {

// Of a mesh, a volume or fog. `frame`, for meshes, has been padded; a volume has not.
PartSize partSize(const SourcePart& part, const Frame& frame, const glm::ivec3& pad);

// True if thousands of triangles lie over each other nearly everywhere: sorting their crossings would take
// too long.
bool isPile(const PartSize& part);

}  // namespace kelp::bake
