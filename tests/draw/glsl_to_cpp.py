#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""glsl_to_cpp.py SHADERS OUT: writes each text of the shaders as C++ with GLM, under its name.

The text stays as it is but for what C++ writes otherwise: swizzles, literals, constructors of structs,
parameters that are written to. shader_stage.h has what GLSL brings along, and puts the texts together:
a stage is a struct, its globals are members, an invocation is a copy. OUT/undef.inl ends their macros."""

import os
import re
import sys

SWIZZLE = r"([xyzw]{2,4}|[rgba]{2,4})\b"


def braced(text, names):
    """Turns KelpName(...) into KelpName{...}: clang 14 has no aggregates in parentheses."""
    start = re.compile(r"\b(?:%s)\(" % "|".join(names))
    at = 0
    while match := start.search(text, at):
        at = match.end()
        depth, end = 1, at
        while depth:
            depth += {"(": 1, ")": -1}.get(text[end], 0)
            end += 1
        text = text[:at - 1] + "{" + text[at:end - 1] + "}" + text[end:]
    return text


def translate(text, structs):
    text = re.sub(r"//.*", "", text)
    text = re.sub(r"^#(version|extension)\b.*", "", text, flags=re.M)
    text = re.sub(r"(?<![\w.])((?:\d+\.\d*|\.\d+)(?:[eE][-+]?\d+)?|\d+[eE][-+]?\d+)(?![\w.])", r"\1f", text)
    text = re.sub(r"([(,]\s*)(?:inout|out) (\w+) ", r"\1\2& ", text)
    text = re.sub(r"^\w+ \w+\([^()]*\);$", "", text, flags=re.M)  # defined later on, in the same struct
    text = re.sub(r"float\[\d+\]\(([^()]*)\)", r"{\1}", text)
    text = re.sub(r"\b(\w+)\.%s = ([^;]*);" % SWIZZLE, r"kelpAssign(\1, swizzle::\2, \3);", text)
    text = re.sub(r"\.%s" % SWIZZLE, r"->*swizzle::\1", text)
    return braced(text, structs)


def main():
    folder, out = sys.argv[1:]
    texts = {}
    for name in sorted(os.listdir(folder)):
        if name.endswith((".glsl", ".vert", ".frag")):
            with open(f"{folder}/{name}", encoding="utf-8") as file:
                texts[name] = file.read()
    everything = "".join(texts.values())
    structs = sorted(set(re.findall(r"struct (Kelp\w+)", everything)))
    written = {name: f'#pragma GCC system_header\n#line 1 "{folder}/{name}"\n' + translate(text, structs)
               for name, text in texts.items()}
    macros = sorted(set(re.findall(r"\bKELP_[A-Z_]+\b", everything)))
    written["undef.inl"] = "".join(f"#undef {macro}\n" for macro in macros)
    os.makedirs(out, exist_ok=True)
    for name, text in written.items():
        with open(f"{out}/{name}", "w", encoding="utf-8") as file:
            file.write(text)


if __name__ == "__main__":
    main()
