// SPDX-License-Identifier: MIT
#pragma once

#include <string>

#include "picture.h"

namespace kelp::render {

// Writes the picture as sRGB PNG: to a temporary file beside `path`, then renamed, so that an existing file is replaced whole or not at
// all. RenderError (kIo).
void writePng(const std::string& path, const Picture& picture);

}  // namespace kelp::render
