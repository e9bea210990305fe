// SPDX-License-Identifier: MIT
// The second module: bakes a MagicaVoxel file to a pack, in the page, as `kelp-bake --rig sway` does. It runs
// in a worker, has memory of its own, and is thrown away after a file, so a hostile one takes nothing along.
#include <emscripten/emscripten.h>

#include <algorithm>
#include <cstdio>
#include <exception>
#include <string>
#include <vector>

#include "kelp/bake/bake.h"

namespace {

struct Baked {
  std::vector<std::byte> bytes;
  std::string words;  // why there are none, or what the baker noticed
};

constexpr std::uint64_t kMemory = 384ull << 20;  // as estimated before it is taken

void bakeInto(const char* path, Baked& out) {
  kelp::bake::Settings settings;
  settings.rig_preset = "sway";
  settings.threads = 1;
  settings.max_memory = kMemory;
  kelp::bake::Report report;
  const kelp::RawPack pack = kelp::bake::bake(path, settings, report);
  if (const auto written = kelp::writePack(pack, kelp::Sink::into(out.bytes), 1, settings.effort); !written)
    throw std::runtime_error(written.error().detail);
  for (const std::string& notice : report.notices) out.words += notice + "\n";
}

// An error without advice about options of the command, which a page does not have.
std::string inPage(std::string words) {
  const std::size_t option = std::min(words.find(" --"), words.find("(--"));
  if (option == std::string::npos) return words;
  words.erase(std::min(words.find_last_of(";", option), option));
  while (words.ends_with(' ')) words.pop_back();
  return words + "; kelp-bake has options for that: bake the file with it, and open its pack here";
}

}  // namespace

extern "C" {

// Bakes the file at `path`. Never null.
EMSCRIPTEN_KEEPALIVE Baked* kelp_bake(const char* path) {
  auto* out = new Baked;
  try {
    bakeInto(path, *out);
  } catch (const std::exception& error) {  // kelp::ToolError says what to do
    out->bytes.clear();
    out->words = inPage(error.what());
  }
  return out;
}
EMSCRIPTEN_KEEPALIVE const std::byte* kelp_baked_bytes(const Baked* baked) { return baked->bytes.data(); }
EMSCRIPTEN_KEEPALIVE std::size_t kelp_baked_size(const Baked* baked) { return baked->bytes.size(); }
EMSCRIPTEN_KEEPALIVE const char* kelp_baked_words(const Baked* baked) { return baked->words.c_str(); }

}  // extern "C"
