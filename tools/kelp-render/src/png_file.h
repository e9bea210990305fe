// SPDX-License-Identifier: MIT
#pragma once

#include <string>
#include <vector>

#include "picture.h"

namespace kelp::render {

// To be asked before the work. RenderError: kUsage if `path` is one of the files that are read, by whatever name; kIo if it is there and no regular file.
void checkPng(const std::string& path, const std::vector<std::string>& inputs);

// Writes the picture as sRGB PNG: to a temporary file beside `path`, or beside what it is a link to, then renamed, so that an existing file is replaced whole or not at
// all. RenderError (kIo).
void writePng(const std::string& path, const Picture& picture);

}  // namespace kelp::render
