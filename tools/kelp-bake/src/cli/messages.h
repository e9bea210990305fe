// SPDX-License-Identifier: MIT
// Lines on stderr, as text or as JSON (kelp-bake-progress.schema.json).
#pragma once

#include <string>
#include <string_view>

#include "kelp/bake/bake.h"

namespace kelp::bake_cli {

// Every line from now on is JSON. Default: text.
void speakJson();

// Which asset of a batch a line is about, from 1 on; 0: none.
struct OfBatch {
  std::size_t asset = 0, assets = 0;
};

// Each prints one line; line breaks in the text are escaped.
void sayNote(std::string_view text);  // "kelp-bake: wrote reed.kelp: ..."
// more about the note before it: "  part 'reed': ..."
void sayDetail(std::string_view text);
void sayWarning(std::string_view text, const OfBatch& of = {});  // "kelp-bake: [1/3] warning: ..."
void sayError(Exit exit, std::string_view text);                 // "kelp-bake: ..."
std::string errorLine(Exit exit, std::string_view text);         // what that prints, without its end
// The result of an asset of a batch. `status` as in the batch's report; `text`: "baked, 3.2 KiB, in 0.10 s".
void sayAsset(const OfBatch& of, std::string_view output, std::string_view status, Exit exit,
              std::string_view text);

}  // namespace kelp::bake_cli
