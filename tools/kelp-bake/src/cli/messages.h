// SPDX-License-Identifier: MIT
// What is said on stderr: lines for people, or each of them as JSON (kelp-bake-progress.schema.json), so that
// a program that reads the progress reads nothing else.
#pragma once

#include <string>
#include <string_view>

#include "kelp/bake/bake.h"

namespace kelp::bake_cli {

// From here on every line is JSON. Off at first.
void speakJson();

// Which asset of a batch a line is about, from 1 on; 0: none.
struct OfBatch {
  std::size_t asset = 0, assets = 0;
};

// One line each, whatever the text holds.
void sayNote(std::string_view text);  // "kelp-bake: wrote reed.kelp: ..."
// what belongs to the note before it: "  part 'reed': ..."
void sayDetail(std::string_view text);
void sayWarning(std::string_view text, const OfBatch& of = {});  // "kelp-bake: [1/3] warning: ..."
void sayError(Exit exit, std::string_view text);                 // "kelp-bake: ..."
// What became of an asset of a batch. `status` as in the batch's report; `text`: "baked, 3.2 KiB, in 0.10 s".
void sayAsset(const OfBatch& of, std::string_view output, std::string_view status, Exit exit,
              std::string_view text);

}  // namespace kelp::bake_cli
