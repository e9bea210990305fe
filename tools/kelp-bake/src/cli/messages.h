// SPDX-License-Identifier: MIT
// Lines on stderr, as text or as JSON (kelp-bake-progress.schema.json).
#pragma once

#include <string>
#include <string_view>

#include "kelp/common/error.h"

namespace kelp::bake_cli {

// Every line from now on is JSON. Default: text.
void speakJson();

// Each prints one line; line breaks in the text are escaped.
void sayNote(std::string_view text);                      // "kelp-bake: wrote reed.kelp: ..."
void sayDetail(std::string_view text);                    // of the note before it: "  part 'reed': ..."
void sayWarning(std::string_view text);                   // "kelp-bake: warning: ..."
void sayError(Exit exit, std::string_view text);          // "kelp-bake: ..."
std::string errorLine(Exit exit, std::string_view text);  // the line of sayError, without its end

}  // namespace kelp::bake_cli
