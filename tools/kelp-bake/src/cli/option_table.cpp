// SPDX-License-Identifier: MIT
#include "cli/option_table.h"

#include <algorithm>

namespace kelp::bake_cli {
namespace {

using T = OptionType;
using S = OptionScope;
using P = OptionPath;

constexpr OptionInfo kOptions[] = {
    {"resolution", "N", T::kNumber, S::kPack, P::kNone, true, "128",
     "voxels along the longest side of the largest part, 1 to 8192 (default 128)"},
    {"voxel-size", "LENGTH", T::kNumber, S::kPack, P::kNone, false, "0.01",
     "edge of a voxel in metres; .vox and .binvox keep their voxels, and get this size"},
    {"rig", "FILE|PRESET", T::kText, S::kPack, P::kFileOrPreset, false, "\"sway\"",
     "a rig as JSON, or a preset: none, sway, swim (default: STEM.rig.json beside the input, or what the "
     "file itself holds)"},
    {"axis", "AXIS", T::kText, S::kPack, P::kNone, false, "\"+y\"",
     "the axis to bend along where the rig names none, in the file's own axes: +x -x +y -y +z -z (default: "
     "--up)"},
    {"up", "AXIS", T::kText, S::kPack, P::kNone, false, "\"+z\"",
     "the file's axis that points up, +y in the pack: +x -x +y -y +z -z (default +y, of .vox +z)"},
    {"unit", "UNIT", T::kTextOrNumber, S::kPack, P::kNone, true, "\"m\"",
     "the length of a unit of the file: m, cm, mm, in, ft, or a number of metres (default m); a voxel of "
     ".vox is a unit"},
    {"pad", "N", T::kNumber, S::kPack, P::kNone, true, "0",
     "empty voxels on every side of a part, 0 to 1024 (default 0); none along the axis of one that bends"},
    {"scene", "NAME|INDEX", T::kTextOrNumber, S::kPack, P::kNone, false, "0",
     "the scene of a glTF file to bake, by index from 0 or by name; a number that is an index counts as one "
     "(default: the file's own default)"},
    {"fill", "auto|solid|surface", T::kText, S::kPack, P::kNone, true, "\"auto\"",
     "auto: solid where closed, holes capped; solid; surface"},
    {"parts", "one|nodes", T::kText, S::kPack, P::kNone, true, "\"one\"",
     "one: one part beside those with rigs of their own; nodes: of glTF, a part for every node with a mesh, "
     "and clips of their animations; .vox: a part for every object"},
    {"at", "CLIP:SECONDS", T::kText, S::kPack, P::kNone, false, "\"Walk:0.3\"",
     "glTF: bake nodes, skins and morph targets as an animation has them at a time, e.g. Walk:0.3"},
    {"frame", "N", T::kNumber, S::kPack, P::kNone, false, "0",
     "MagicaVoxel: the frame of its animation to bake, from 0 on (default: where it begins)"},
    {"palette", "FILE", T::kText, S::kPack, P::kFile, false, "\"colors.gpl\"",
     "bake with these colours alone: a GIMP palette (.gpl) or a picture of at most 256 colours"},
    {"keep-materials", "", T::kFlag, S::kPack, P::kNone, true, "false",
     "materials of one colour keep palette entries of their own; --report names them"},
    {"grid", "NAME|INDEX", T::kTextOrNumber, S::kPack, P::kNone, false, "\"density\"",
     "volumes: the grid to bake, by name or else by index from 0; needed where a file has several"},
    {"volume", "auto|solid|fog", T::kText, S::kPack, P::kNone, true, "\"auto\"",
     "volumes: auto: level sets and masks are solid, densities fog unless --isovalue is given; solid; fog"},
    {"isovalue", "VALUE", T::kNumber, S::kPack, P::kNone, false, "0.5",
     "volumes: solid where a density is at least this, or a level set at most (default 0 for level sets, "
     "half the greatest value for others)"},
    {"color-grid", "NAME|INDEX", T::kTextOrNumber, S::kPack, P::kNone, false, "\"Cd\"",
     "volumes: the grid of vectors that colours a solid (default: Cd or color)"},
    {"heat-grid", "NAME|INDEX|none", T::kTextOrNumber, S::kPack, P::kNone, false, "\"flame\"",
     "volumes: the grid that fog glows of (default: flame, flames, heat or temperature); none"},
    {"density", "FACTOR", T::kNumber, S::kPack, P::kNone, true, "1",
     "volumes: factor on the densities of fog (default 1)"},
    {"ramp", "FILE", T::kText, S::kPack, P::kFile, false, "\"fire.gpl\"",
     "volumes: the colours that fog glows in, cold to hot: a GIMP palette (.gpl) or a picture (default: "
     "those of a black body)"},
    {"levels", "N", T::kNumber, S::kPack, P::kNone, false, "4",
     "levels of detail (default: down to one brick)"},
    {"threads", "N", T::kNumber, S::kRun, P::kNone, false, "4",
     "threads (default: all); the pack does not depend on it"},
    {"max-memory", "SIZE", T::kText, S::kRun, P::kNone, false, "\"4G\"",
     "refuse to start a bake that needs more, or to read a file that does, e.g. 4G (default: the machine's "
     "memory; pictures get 1G and 256 bytes for each of the files' own)"},
    {"max-import-time", "SECONDS", T::kNumber, S::kRun, P::kNone, true, "1800",
     "give up on a file that takes longer to read (default 1800)"},
    {"progress", "auto|bar|json|none", T::kText, S::kRun, P::kNone, true, "\"auto\"",
     "auto: a bar on a terminal; bar; json: every line on stderr is JSON (kelp-dump schema bake-progress); "
     "none"},
    {"cache", "FOLDER", T::kText, S::kRun, P::kFile, false, "\"cache\"",
     "keep packs in a folder, by the content of all that they are made of, and take them from there; any "
     "number of processes may share it"},
    {"cache-size", "SIZE", T::kText, S::kRun, P::kNone, true, "\"10G\"",
     "what that folder may hold; beyond this, what was used longest ago is removed (default 10G)"},
    {"report", "FILE", T::kText, S::kPack, P::kFile, false, "\"report.json\"",
     "write what was done and how long it took, as JSON; of a batch, what became of each asset"},
    {"write-deps", "", T::kFlag, S::kPack, P::kNone, true, "false",
     "write the files that were read as a make rule to OUT.d (also -MD)"},
    {"deps-phony", "", T::kFlag, S::kPack, P::kNone, true, "false",
     "add an empty rule for every file in that rule, so that make goes on when one is gone (also -MP)"},
    {"deps-target", "NAME", T::kText, S::kPack, P::kNone, false, "\"packs/reed.kelp\"",
     "the target of that rule, exactly so, in place of the output (also -MT)"},
    {"deps-file", "FILE", T::kText, S::kPack, P::kFile, false, "\"pack.d\"",
     "where to write that rule instead (also -MF)"},
};

}  // namespace

std::span<const OptionInfo> optionTable() { return kOptions; }

const OptionInfo* findOption(std::string_view name) {
  const auto found = std::find_if(std::begin(kOptions), std::end(kOptions),
                                  [&](const OptionInfo& option) { return option.name == name; });
  return found == std::end(kOptions) ? nullptr : &*found;
}

}  // namespace kelp::bake_cli
