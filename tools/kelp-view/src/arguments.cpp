// SPDX-License-Identifier: MIT
#include "arguments.h"

#include <cstdlib>
#include <filesystem>
#include <string_view>

namespace kelp::view {
namespace {

// If `words[i]` is this option of kelp-bake, takes its value: "-o FILE", "-oFILE" or "--output=FILE".
bool takeValue(int count, const char* const* words, int& i, std::string_view brief, std::string_view full,
               std::string& value) {
  const std::string_view word = words[i];
  if (word == full || (!brief.empty() && word == brief)) {
    if (i + 1 < count) value = words[++i];
    return true;
  }
  if (word.starts_with(full) && word.substr(full.size()).starts_with("="))
    return value = word.substr(full.size() + 1), true;
  if (!brief.empty() && word.starts_with(brief)) return value = word.substr(brief.size()), true;
  return false;
}

// The words after --watch MODEL: options of kelp-bake. Answers an empty text, or what is wrong.
std::string takeOrder(int count, const char* const* words, int i, BakeOrder& order) {
  for (; i < count; ++i) {
    const std::string_view word = words[i];
    if (takeValue(count, words, i, "-o", "--output", order.output) ||
        takeValue(count, words, i, "", "--rig", order.rig))
      continue;
    for (const std::string_view reserved :
         {"--progress", "-MF", "-MD", "-MP", "-MT", "--write-deps", "--deps-file", "--deps-phony",
          "--deps-target", "--help", "--version"}) {
      if (word == reserved || (word.starts_with(reserved) && word.substr(reserved.size()).starts_with("=")))
        return std::string(word) + ": kelp-view sets this itself; leave it out";
    }
    for (const std::string_view own : {"--frames", "--edit", "--watch", "--view"}) {
      if (word == own)
        return std::string(word) + ": options after the model go to kelp-bake; write it before --watch";
    }
    order.options.emplace_back(word);
  }
  if (order.output.empty()) order.output = std::filesystem::path(order.source).replace_extension(".kelp");
  return {};
}

}  // namespace

const char* const kHelp = R"(Shows .kelp packs in a window: turns them, plays their clips, edits their rigs.
Usage: kelp-view [OPTIONS] [PACK]
       kelp-view [OPTIONS] --watch PACK
       kelp-view [OPTIONS] --watch MODEL [OPTIONS OF kelp-bake]

  PACK                      the .kelp file to show; drop others onto the window
  --view shaded|normals|distances|parts|steps|levels|bounds|splines|cages
                            what the colors mean, or lines over the picture (key V: the next one)
  --edit                    open the rig editor at once (key E)
  --watch PACK              show the pack again whenever it changes
  --watch MODEL             bake a model and show it, again whenever it, its rig or a texture changes.
                            The options after MODEL go to kelp-bake. The pack is MODEL with .kelp in place
                            of its extension, unless -o names another
  --frames N [PICTURE.ppm]  end after N frames, and save the last one. Frames count from when all voxels
                            are loaded
  -h,--help                 print this text and exit
  --version                 print the version and exit

Mouse: left drag turns, or moves a handle; right drag moves the camera; wheel zooms.
Keys: space play, F fit, V next view, H handles, E rig editor, R reset handles; in the editor Ctrl Z undo,
Ctrl Y redo, Ctrl S save.
It needs a display (DISPLAY) and OpenGL 3.3.

Examples:
  kelp-view reed.kelp
  kelp-view --view distances fox.kelp
  kelp-view --watch reed.glb --rig sway --resolution 256
  kelp-view --frames 1 reed.ppm --watch reed.glb    bakes, saves one picture and ends

Exit codes: 0 ok, 1 usage, 2 input/output, 3 invalid pack, 4 failure at run time, 5 unsupported feature. With
--frames, a bake that fails ends the program with kelp-bake's exit code.
)";

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
    } else if (word == "--view") {
      const std::string_view value = i + 1 < count ? words[++i] : "";
      if (value == "fit")
        return wrong = "--view fit is gone; see clips[].fit of kelp-bake --report", std::nullopt;
      const auto surface = parseSurface(value);
      if (!surface) return wrong = std::string("--view: give one of ") + kSurfaceNames, std::nullopt;
      arguments.surface = *surface;
    } else if (word == "--frames") {
      if (i + 1 >= count || std::atoi(words[i + 1]) <= 0)
        return wrong = "--frames: give a number of frames, 1 or more", std::nullopt;
      arguments.frames = std::atoi(words[++i]);
    } else if (word == "--watch") {
      if (i + 1 >= count || words[i + 1][0] == '-')
        return wrong = "--watch: name the pack or the model to watch", std::nullopt;
      if (!arguments.pack.empty())
        return wrong = "--watch: there is a pack already, " + arguments.pack + "; give one of them",
               std::nullopt;
      arguments.watch = true;
      arguments.pack = words[++i];
      if (std::filesystem::path(arguments.pack).extension() == ".kelp") {
        if (i + 1 < count)
          return wrong = std::string(words[i + 1]) +
                         ": nothing may follow --watch PACK; options of kelp-bake are for models",
                 std::nullopt;
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
      return wrong = std::string(word) + ": give one pack, before --frames", std::nullopt;
    }
  }
  return arguments;
}

}  // namespace kelp::view
