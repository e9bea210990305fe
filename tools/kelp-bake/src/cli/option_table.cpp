// SPDX-License-Identifier: MIT
#include "cli/option_table.h"

#include <algorithm>

namespace kelp::bake_cli {
namespace {

using T = OptionType;
using S = OptionScope;
using P = OptionPath;

constexpr OptionInfo kOptions[] = {
    {"resolution", "Size and place", "N", T::kNumber, S::kPack, P::kNone, true, "128",
     "voxels along the longest side of the largest part, 1 to 8192 (default 128)"},
    {"voxel-size", "Size and place", "LENGTH", T::kNumber, S::kPack, P::kNone, false, "0.01",
     "edge of a voxel in metres, in place of --resolution; voxels of .vox and .binvox stay, with this size"},
    {"rig", "Bending", "FILE|none|sway|swim|skin", T::kText, S::kPack, P::kFileOrPreset, false, "\"sway\"",
     "a rig file (JSON), a preset, or skin: the file's skin (default: STEM.rig.json beside the input, or "
     "else the rig or the skin in the file)"},
    {"axis", "Bending", "+x|-x|+y|-y|+z|-z", T::kText, S::kPack, P::kNone, false, "\"+y\"",
     "the axis to bend along if the rig has none, in the file's axes (default: --up)"},
    {"bend", "Bending", "shear|sweep", T::kText, S::kPack, P::kNone, false, "\"sweep\"",
     "how solid parts bend whose rig does not say; sweep: sections stay perpendicular to the spline, which "
     "may curl; shear: they stay level (default)"},
    {"up", "Size and place", "+x|-x|+y|-y|+z|-z", T::kText, S::kPack, P::kNone, false, "\"+z\"",
     "the file's axis that points up (default +y; of .vox +z)"},
    {"unit", "Size and place", "m|cm|mm|in|ft|METRES", T::kTextOrNumber, S::kPack, P::kNone, true, "\"m\"",
     "the file's unit of length (default m); of .vox, the size of a voxel"},
    {"pad", "Size and place", "N", T::kNumber, S::kPack, P::kNone, true, "0",
     "empty voxels on every side of a part, 0 to 1024 (default 0), except along the axis of a part that "
     "bends"},
    {"scene", "Model", "NAME|INDEX", T::kTextOrNumber, S::kPack, P::kNone, false, "0",
     "glTF: the scene to bake, by name or by index from 0; a number in the range of indices is an index "
     "(default: the file's default scene)"},
    {"fill", "Model", "auto|solid|surface", T::kText, S::kPack, P::kNone, true, "\"auto\"",
     "what to fill; auto: closed components, small holes capped; solid: all; surface: none"},
    {"parts", "Model", "one|nodes", T::kText, S::kPack, P::kNone, true, "\"one\"",
     "one: a single part, besides nodes that have their own rig; nodes: a part for every glTF node with a "
     "mesh, with its animations as clips, or for every .vox object"},
    {"at", "Model", "CLIP:SECONDS", T::kText, S::kPack, P::kNone, false, "\"Walk:0.3\"",
     "glTF: bake nodes, skins and morph targets at a moment of an animation, e.g. Walk:0.3"},
    {"frame", "Model", "N", T::kNumber, S::kPack, P::kNone, false, "0",
     "MagicaVoxel: the frame of the animation to bake, from 0 (default: the first)"},
    {"palette", "Colours", "FILE", T::kText, S::kPack, P::kFile, false, "\"colors.gpl\"",
     "use only these colours: a GIMP palette (.gpl) or a picture of at most 256 colours"},
    {"keep-materials", "Colours", "", T::kFlag, S::kPack, P::kNone, true, "false",
     "give every material its own palette entries; --report names them"},
    {"grid", "Volumes", "NAME|INDEX", T::kTextOrNumber, S::kPack, P::kNone, false, "\"density\"",
     "volumes: the grid to bake, by name or by index from 0; needed if the file has several"},
    {"volume", "Volumes", "auto|solid|fog", T::kText, S::kPack, P::kNone, true, "\"auto\"",
     "volumes; auto: solid for level sets, masks, and densities with --isovalue, fog for other densities; "
     "solid; fog"},
    {"isovalue", "Volumes", "VALUE", T::kNumber, S::kPack, P::kNone, false, "0.5",
     "volumes: solid where a density is at least VALUE, or a level set at most VALUE (default: 0 for level "
     "sets, half the greatest value for densities)"},
    {"color-grid", "Volumes", "NAME|INDEX", T::kTextOrNumber, S::kPack, P::kNone, false, "\"Cd\"",
     "volumes: the vector grid with the colours of a solid (default: Cd or color)"},
    {"heat-grid", "Volumes", "NAME|INDEX|none", T::kTextOrNumber, S::kPack, P::kNone, false, "\"flame\"",
     "volumes: the grid that makes fog glow (default: flame, flames, heat or temperature); none: no glow"},
    {"density", "Volumes", "FACTOR", T::kNumber, S::kPack, P::kNone, true, "1",
     "volumes: multiplies the density of fog (default 1)"},
    {"ramp", "Volumes", "FILE", T::kText, S::kPack, P::kFile, false, "\"fire.gpl\"",
     "volumes: colours of glowing fog, cold to hot: a GIMP palette (.gpl) or a picture (default: a black "
     "body's)"},
    {"levels", "Pack", "N", T::kNumber, S::kPack, P::kNone, false, "4",
     "levels of detail (default: as many as it takes to reach one brick)"},
    {"no-distance", "Pack", "", T::kFlag, S::kPack, P::kNone, true, "false",
     "leave out the exact distances, which games ask for collisions and shaders for soft shadows"},
    {"effort", "Pack", "fast|best", T::kText, S::kPack, P::kNone, true, "\"fast\"",
     "how hard to try to make the pack small; best: a little smaller, the writing takes longer (default "
     "fast)"},
    {"threads", "Run", "N", T::kNumber, S::kRun, P::kNone, false, "4",
     "threads (default: all); the pack is the same with any number"},
    {"max-memory", "Run", "SIZE", T::kText, S::kRun, P::kNone, false, "\"4G\"",
     "refuse a bake or a file that needs more memory, e.g. 4G (default: the machine's memory; for pictures "
     "1G plus 256 bytes per byte of their files)"},
    {"max-import-time", "Run", "SECONDS", T::kNumber, S::kRun, P::kNone, true, "1800",
     "refuse a file that takes longer to read, or whose bake stands still for longer (default 1800)"},
    {"progress", "Run", "auto|bar|json|none", T::kText, S::kRun, P::kNone, true, "\"auto\"",
     "auto: a bar if stderr is a terminal; bar; json: each line on stderr is JSON (kelp-dump schema "
     "bake-progress); none"},
    {"cache", "Run", "FOLDER", T::kText, S::kRun, P::kFile, false, "\"cache\"",
     "keep packs in FOLDER, and reuse one if all files it was made of have the same content; processes may "
     "share the folder"},
    {"cache-size", "Run", "SIZE", T::kText, S::kRun, P::kNone, true, "\"10G\"",
     "limit of the cache; the least recently used packs are deleted first (default 10G)"},
    {"report", "Run", "FILE", T::kText, S::kPack, P::kFile, false, "\"report.json\"",
     "write a report as JSON: what was baked and how long it took; of a batch, the result of each asset"},
    {"write-deps", "Make rules", "", T::kFlag, S::kPack, P::kNone, true, "false",
     "write a make rule with all files that were read to OUT.d (also -MD)"},
    {"deps-phony", "Make rules", "", T::kFlag, S::kPack, P::kNone, true, "false",
     "add an empty rule for each of these files, so that make goes on when one is deleted (also -MP)"},
    {"deps-target", "Make rules", "NAME", T::kText, S::kPack, P::kNone, false, "\"packs/reed.kelp\"",
     "the target of the rule, unescaped (default: the output; also -MT)"},
    {"deps-file", "Make rules", "FILE", T::kText, S::kPack, P::kFile, false, "\"pack.d\"",
     "write the rule to FILE instead of OUT.d (also -MF)"},
};

}  // namespace

std::span<const OptionInfo> optionTable() { return kOptions; }

const OptionInfo* findOption(std::string_view name) {
  const auto found = std::find_if(std::begin(kOptions), std::end(kOptions),
                                  [&](const OptionInfo& option) { return option.name == name; });
  return found == std::end(kOptions) ? nullptr : &*found;
}

}  // namespace kelp::bake_cli
