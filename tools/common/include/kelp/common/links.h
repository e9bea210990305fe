// SPDX-License-Identifier: MIT
// Symbolic links: one rule for all programs.
#pragma once

#include <filesystem>
#include <optional>

namespace kelp {

// The place that a path names once its last component is followed through symbolic links, 40 at most. That
// place need not exist. A program that writes there replaces the file and keeps the link.
std::filesystem::path followLinks(const std::filesystem::path& path);

// The descriptor of the open stream that a path names, also through links: 1 for /dev/stdout, /dev/fd/1 and
// /proc/self/fd/1. Nothing if the path names no stream. A stream is written to; it must not be replaced.
std::optional<int> streamOf(const std::filesystem::path& path);

}  // namespace kelp
