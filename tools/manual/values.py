# SPDX-License-Identifier: MIT
"""The values that an option takes: words, folders, files of some kinds."""

from dataclasses import dataclass, replace

MODELS = ["glb", "gltf", "vrm", "obj", "ply", "stl", "off", "drc", "vdb", "nvdb", "vox", "binvox", "raw"]
COLORS = ["gpl", "png", "jpg", "jpeg", "webp"]

# Of values that --help calls FILE or OUT, the kinds that it does not say.
KINDS = {
    ("kelp-bake", "input"): MODELS,
    ("kelp-bake", "--output"): ["kelp"],
    ("kelp-bake", "--rig"): ["json"],
    ("kelp-bake", "--palette"): COLORS,
    ("kelp-bake", "--ramp"): COLORS,
    ("kelp-bake", "--report"): ["json"],
    ("kelp-bake", "--deps-file"): ["d"],
    ("kelp-dump", "--output"): ["kelp"],
    ("kelp-dump", "--vox"): ["vox"],
    ("kelp-dump", "--proxy"): ["obj", "ply", "stl", "off"],
    ("kelp-dump", "--vdb"): ["vdb"],
    ("kelp-dump", "--nvdb"): ["nvdb"],
}


@dataclass
class Values:
    words: list
    kinds: list  # extensions; ["*"]: files of all kinds; ["/"]: folders; empty: no files

    def add(self, other):
        return Values(self.words + other.words, self.kinds + other.kinds)


def values_of(program, option):
    words, kinds = option.choices()[0], []
    for name in option.choices()[1] + ([] if option.flags else [option.name]):
        if name in ("PACK", "A", "B"):
            kinds = kinds + ["kelp"]
        elif name == "MODEL":
            kinds = kinds + MODELS
        elif name == "FOLDER":
            kinds = kinds + ["/"]
        elif "." in name:  # OUT.png
            kinds = kinds + [name.split(".")[1]]
        elif name in ("FILE", "OUT"):
            kinds = kinds + KINDS.get((program, option.flags[-1] if option.flags else option.name), ["*"])
    return Values(words, kinds)


def options_by_flags(help_text):
    """(option, its values), each option once, also if --help tells of it in two ways."""
    found = {}
    for option in help_text.options():
        values = values_of(help_text.program, option)
        if tuple(option.flags) in found:
            first, first_values = found[tuple(option.flags)]
            values = first_values.add(values)
            option = replace(first, help=first.help + "; " + option.help)
        found[tuple(option.flags)] = (option, values)
    return list(found.values())


def argument_values(help_text):
    found = Values([], [])
    for argument in help_text.arguments:
        found = found.add(values_of(help_text.program, argument))
    return Values(found.words, list(dict.fromkeys(found.kinds)))
