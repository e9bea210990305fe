// SPDX-License-Identifier: MIT
// Any bytes as a file that somebody bakes: through its importer, and now and then through the whole baker.
// Must be refused in one line by a ToolError, or be a model, and a pack, that keep their own rules; must not
// crash, hang or take more memory than the settings say.
#pragma once

#include <cstdint>
#include <filesystem>
#include <span>

#include "input_folder.h"
#include "kelp/bake/bake.h"

// A hash of all bytes of an input, which chooses its options: every kind of input gets every option.
std::uint64_t choiceOf(std::span<const std::uint8_t> bytes);

// Resolution, threads and memory so small that an input takes milliseconds. The estimate counts 32 MB for the
// program itself (memory_estimate.cpp): what is left is for some 100 x 100 x 100 voxels, or for a few
// pictures and thousands of triangles.
inline constexpr std::uint64_t kVolumeBytes = 45'000'000, kMeshBytes = 58'000'000;
kelp::bake::Settings smallSettings(std::uint64_t bytes);

// Imports the file; one in eight, by `choice`, is baked, written and verified instead.
void exerciseImport(const std::filesystem::path& path, const kelp::bake::Settings& settings,
                    std::uint64_t choice);
