// SPDX-License-Identifier: MIT
#include "arguments.h"

#include <cstdlib>
#include <filesystem>
#include <string_view>

namespace viewer {
namespace {

// "-o FILE", "-oFILE", "--output=FILE": takes the value of an option of kelp-bake, if `words[i]` is that option.
bool takeValue(int count, const char* const* words, int& i, std::string_view brief, std::string_view full, std::string& value) {
  const std::string_view word = words[i];
  if (word == full || (!brief.empty() && word == brief)) {
    if (i + 1 < count) value = words[++i];
    return true;
  }
  if (word.starts_with(full) && word.substr(full.size()).starts_with("=")) return value = word.substr(full.size() + 1), true;
  if (!brief.empty() && word.starts_with(brief)) return value = word.substr(brief.size()), true;
  return false;
}

// All words after --watch SOURCE are kelp-bake's.
std::string takeOrder(int count, const char* const* words, int i, BakeOrder& order) {
  for (; i < count; ++i) {
    const std::string_view word = words[i];
    if (takeValue(count, words, i, "-o", "--output", order.output) || takeValue(count, words, i, "", "--rig", order.rig)) continue;
    for (const std::string_view own : {"--progress", "-MF", "-MD", "-MP", "-MT", "--write-deps", "--deps-file", "--deps-phony", "--deps-target", "--help", "--version"}) {
      if (word == own || (word.starts_with(own) && word.substr(own.size()).starts_with("="))) return std::string(word) + ": the viewer sets this itself; leave it out";
    }
    for (const std::string_view viewers : {"--frames", "--edit", "--watch"}) {
      if (word == viewers) return std::string(word) + ": what follows the source goes to kelp-bake; write it before --watch";
    }
    order.options.emplace_back(word);
  }
  if (order.output.empty()) order.output = std::filesystem::path(order.source).replace_extension(".kelp");
  return {};
}

}  // namespace

const char* const kUsage =
    "usage: viewer [--edit] [PACK.kelp] [--frames N [PICTURE.ppm]]\n"
    "       viewer [--edit] [--frames N [PICTURE.ppm]] --watch PACK.kelp\n"
    "       viewer [--edit] [--frames N [PICTURE.ppm]] --watch SOURCE [OPTIONS OF kelp-bake]\n"
    "Shows a pack; drop others onto the window to see them.\n"
    "  --edit    begins with the rig editor open (key E)\n"
    "  --watch   shows the pack anew when it changes. Of a model (reed.glb): bakes it, and again whenever it, its rig or a texture changes. The pack is\n"
    "            SOURCE with .kelp in place of its extension, unless -o says otherwise.\n"
    "  --frames  ends after N frames and saves the last as a picture\n"
    "  --version says which version of kelp this is\n"
    "Example: viewer --watch reed.glb --rig sway --resolution 256\n";

std::optional<Arguments> parseArguments(int count, const char* const* words, std::string& wrong) {
  Arguments arguments;
  for (int i = 1; i < count; ++i) {
    const std::string_view word = words[i];
    if (word == "--help" || word == "-h") {
      arguments.help = true;
      return arguments;
    }
    if (word == "--version") {
      arguments.version = true;
      return arguments;
    }
    if (word == "--edit") {
      arguments.edit = true;
    } else if (word == "--frames") {
      if (i + 1 >= count || std::atoi(words[i + 1]) <= 0) return wrong = "--frames: needs a number from 1 on", std::nullopt;
      arguments.frames = std::atoi(words[++i]);
    } else if (word == "--watch") {
      if (i + 1 >= count || words[i + 1][0] == '-') return wrong = "--watch: needs the pack, or the model, to watch", std::nullopt;
      if (!arguments.pack.empty()) return wrong = std::string(word) + ": " + arguments.pack + " is there already; watch one or the other", std::nullopt;
      arguments.watch = true;
      arguments.pack = words[++i];
      if (std::filesystem::path(arguments.pack).extension() == ".kelp") {
        if (i + 1 < count) return wrong = std::string(words[i + 1]) + ": a pack takes no options; --watch PACK.kelp comes last", std::nullopt;
        break;
      }
      arguments.bake = BakeOrder{arguments.pack, {}, {}, {}};
      if (wrong = takeOrder(count, words, i + 1, *arguments.bake); !wrong.empty()) return std::nullopt;
      arguments.pack = arguments.bake->output;
      break;
    } else if (word.starts_with("-")) {
      return wrong = std::string(word) + ": no such option", std::nullopt;
    } else if (arguments.frames > 0 && arguments.picture.empty()) {
      arguments.picture = word;
    } else if (arguments.pack.empty() && arguments.frames == 0) {
      arguments.pack = word;
    } else {
      return wrong = std::string(word) + ": one pack at a time, and it comes before --frames", std::nullopt;
    }
  }
  return arguments;
}

}  // namespace viewer
