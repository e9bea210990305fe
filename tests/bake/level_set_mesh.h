// SPDX-License-Identifier: MIT
#pragma once

#include <filesystem>

#include "kelp/import/core/source_model.h"

namespace kelp::test {

// The zero surface of the first level set in a .vdb file as triangles, in the grid's world space: OpenVDB's
// own mesher.
bake::TriangleSoup levelSetMesh(const std::filesystem::path& path);

}  // namespace kelp::test
