// SPDX-License-Identifier: MIT
// The text that tells how a pack was made.
#pragma once

#include "kelp/bake/bake.h"

namespace kelp::bake {

// The pack's INFO: tool version, source name and hash, the options that change content, and the other files
// it was made of by their names beside the source: a hash, or null where one was looked for in vain. Nothing
// that differs between two bakes of the same input: no place, time or number of threads.
// `skin`: JSON, what became of a skin; empty: there was none.
std::string makeInfo(const std::filesystem::path& input, const std::string& format, bool volume,
                     const Settings& settings, const FilesUsed& used, const std::string& skin);

// STEM.rig.json, which is taken where no rig is asked for.
std::filesystem::path rigBeside(const std::filesystem::path& input);

}  // namespace kelp::bake
