#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Checks that the house is in order: seconds, no build. ctest runs it (house); by hand: tests/check_house.py

- Includes follow the arrows: a room includes its own headers and those of the rooms that ROOMS names for it.
- runtime/draw names no function, type or constant of OpenGL.
- No line is wider than 110 columns, in code and in Markdown prose. Tables, links, addresses and the raw data
  of tests may be.
- No product source has more than 400 lines, and no function more than 80, unless a comment just above says
  why: "Long: REASON".
- Every room has a README, or the room around it has.
- What tests/ports.sh web compiles calls no algorithm of std::ranges: emscripten's libc++ 13 has none.
- A file that a README's table of files names exists in its folder; a source that any document names exists,
  and a file that it links.
- clang-format, where it is installed, would change nothing.
"""

import fnmatch
import os
import re
import shutil
import subprocess
import sys

WIDTH = 110
FILE_LINES = 400
FUNCTION_LINES = 80

# A room: the start of its include paths, and the rooms whose headers it may include.
IMPORT_CORE = ["formats", "tools/common", "tools/fields", "tools/rig", "tools/import/core"]
VOXELIZE = IMPORT_CORE + ["tools/voxelize/topology"]
ROOMS = {
    "formats": ("kelp/formats/", []),
    "shaders": ("kelp/shaders/", []),
    "runtime/src/simd": ("kelp/simd/", ["formats"]),
    "runtime/src/cages": ("kelp/cages/", ["formats", "runtime", "runtime/src/simd"]),
    "runtime": ("kelp/runtime/",
                ["formats", "shaders", "runtime/src/cages", "runtime/src/simd", "runtime/src/streaming"]),
    "runtime/src/streaming": ("kelp/streaming/", ["formats", "runtime"]),
    "runtime/draw": ("kelp/draw/",
                     ["formats", "shaders", "runtime", "runtime/src/cages", "runtime/src/simd",
                      "runtime/src/streaming"]),
    "runtime/gl": ("kelp/gl/", ["formats", "runtime", "runtime/draw"]),
    "runtime/c": ("kelp/c/", ["formats", "runtime", "runtime/draw", "runtime/gl"]),
    "tools/common": ("kelp/common/", ["formats"]),
    "tools/fields": ("kelp/fields/", ["formats", "tools/common"]),
    "tools/rig": ("kelp/rig/", ["formats", "tools/common"]),
    "tools/import/core": ("kelp/import/core/", ["formats", "tools/common", "tools/fields", "tools/rig"]),
    "tools/import/image": ("kelp/import/image/", IMPORT_CORE),
    "tools/import/mesh": ("kelp/import/mesh/", IMPORT_CORE + ["tools/import/image"]),
    "tools/import/gltf": ("kelp/import/gltf/", IMPORT_CORE + ["tools/import/image", "tools/import/mesh"]),
    "tools/import/voxels": ("kelp/import/voxels/", IMPORT_CORE),
    "tools/import/volume": ("kelp/import/volume/", IMPORT_CORE + ["tools/import/voxels"]),
    "tools/import": ("kelp/import/", IMPORT_CORE + ["tools/import/gltf", "tools/import/mesh",
                                                    "tools/import/voxels", "tools/import/volume"]),
    "tools/voxelize/topology": ("kelp/voxelize/topology/", IMPORT_CORE),
    "tools/voxelize/surface": ("kelp/voxelize/surface/", VOXELIZE),
    "tools/voxelize/fill": ("kelp/voxelize/fill/", VOXELIZE + ["tools/voxelize/surface"]),
    "tools/voxelize": ("kelp/voxelize/", VOXELIZE + ["tools/voxelize/surface", "tools/voxelize/fill"]),
    "tools/skin": ("kelp/skin/", VOXELIZE + ["tools/voxelize/surface"]),
    "tools/bake": ("kelp/bake/", VOXELIZE + ["tools/import", "tools/import/image", "tools/voxelize",
                                             "tools/voxelize/surface", "tools/voxelize/fill",
                                             "tools/skin"]),
    "tools/kelp-bake": (None, ["formats", "tools/common", "tools/rig", "tools/import/core", "tools/bake"]),
    "tools/kelp-dump": (None, ["formats", "tools/common", "tools/fields", "tools/rig"]),
    "tools/kelp-render": (None, ["formats", "shaders", "runtime", "runtime/gl", "tools/common",
                                 "tools/fields", "tools/rig"]),
    "tools/kelp-view": (None, ["formats", "runtime", "runtime/gl", "tools/common", "tools/rig"]),
    "samples": (None, ["formats", "runtime", "runtime/gl", "runtime/c"]),
    "samples/web/baker": (None, VOXELIZE + ["tools/import", "tools/bake", "tools/voxelize",
                                            "tools/voxelize/surface"]),
}

WHOLE = {"kelp/kelp.hpp": "runtime/gl", "kelp/kelp.h": "runtime/c"}  # all headers for games

PORTED = ("formats/", "runtime/", "samples/web/", "tools/common/", "tools/fields/",
          "tools/import/core/", "tools/import/voxels/", "tools/rig/", "tests/fields/", "tests/formats/",
          "tests/fuzz/", "tests/reference/", "tests/rig/", "tests/runtime/", "tests/shaders/",
          "tests/support/")  # to emscripten 3.1.6

CODE = (".c", ".cpp", ".h", ".hpp", ".inl")
SHADERS = (".glsl", ".frag", ".vert")
SCRIPTS = (".py", ".sh", ".cmake", ".yml", "CMakeLists.txt")
PRODUCT = ("formats/", "shaders/", "runtime/", "tools/", "samples/")


def tracked():
    """The project's files, as git lists them. In a source archive, or without git: all outside of build/."""
    listed = None
    if os.path.exists(".git") and shutil.which("git"):
        git = subprocess.run(["git", "ls-files", "-co", "--exclude-standard"], capture_output=True, text=True)
        listed = git.stdout.split("\n") if git.returncode == 0 else None
    if listed is None:
        listed = [os.path.relpath(os.path.join(folder, name))
                  for folder, _, names in os.walk(".") for name in names
                  if not folder.startswith(("./build", "./.git", "./samples/out"))]
    return sorted(name for name in listed if name and os.path.isfile(name))


def room_of(path):
    return max((room for room in ROOMS if path.startswith(room + "/")), key=len, default=None)


def room_of_include(include):
    if include in WHOLE:
        return WHOLE[include]
    prefixes = {prefix: room for room, (prefix, _) in ROOMS.items() if prefix}
    best = max((prefix for prefix in prefixes if include.startswith(prefix)), key=len, default=None)
    return prefixes.get(best)


def check_arrows(path, lines):
    room = room_of(path)
    if room is None or not path.endswith(CODE):
        return
    for number, line in enumerate(lines, 1):
        match = re.match(r'#include "([^"]+)"', line)
        if not match:
            continue
        include = match[1]
        if include.startswith("kelp/"):
            target = room_of_include(include)
            if target is None:
                yield f"{path}:{number}: {include} belongs to no room; name its room in ROOMS"
                continue
        elif "../" in include:
            target = room_of(os.path.normpath(os.path.join(os.path.dirname(path), include)))
        else:
            target = room
        if target != room and target not in ROOMS[room][1]:
            yield (f"{path}:{number}: {room} may not include {include} of {target}; "
                   "see ROOMS in tests/check_house.py")


def check_widths(path, lines):
    markdown, raw, fence = path.endswith(".md"), False, False
    if not path.endswith(CODE + SHADERS + SCRIPTS + (".md",)):
        return
    for number, line in enumerate(lines, 1):
        if markdown:
            if line.lstrip().startswith("```"):
                fence = not fence
            if line.startswith("|") or fence or "](" in line or "http" in line:
                continue
        opens = re.search(r'R"\w*\(', line) and not path.startswith(PRODUCT)
        within, raw = raw or bool(opens), (raw or bool(opens)) and not re.search(r'\)\w*"', line)
        if len(line) > WIDTH and not within and "http" not in line and "NOLINT" not in line:
            yield f"{path}:{number}: {len(line)} columns, {WIDTH} is the limit"


def check_apart(path, lines):
    if not path.startswith("runtime/draw/") or not path.endswith(CODE):
        return
    opengl = re.compile(r"\bgl[A-Z]\w*|\bGL(_|[a-z])\w*|\bgl::|\bgl_api\b|\bkelp/gl/")
    for number, line in enumerate(lines, 1):
        if found := opengl.search(line.split("//")[0]):
            yield f"{path}:{number}: {found[0]} is of OpenGL, which runtime/draw does not know"


def check_ported(path, lines):
    if not path.startswith(PORTED) or not path.endswith(CODE):
        return
    for number, line in enumerate(lines, 1):
        if "std::ranges::" in line:
            yield f"{path}:{number}: emscripten 3.1.6 has no algorithms of std::ranges; call one of std"


def check_lengths(path, lines):
    if not path.startswith(PRODUCT) or not path.endswith(CODE + SHADERS):
        return
    head = "\n".join(lines[:12])
    if len(lines) > FILE_LINES and "Long:" not in head:
        yield (f"{path}: {len(lines)} lines, {FILE_LINES} is the limit; split it, "
               "or say why not (// Long: ...)")
    # Functions, as clang-format lays them out: a head that ends in {, and } in the column where it begins.
    begin = None
    for number, line in enumerate(lines, 1):
        if begin is not None:
            if line.startswith(closing):
                above = "\n".join(lines[max(0, begin - 6):begin])
                if number - begin + 1 > FUNCTION_LINES and "Long:" not in above:
                    yield (f"{path}:{begin}: a function of {number - begin + 1} lines, "
                           f"{FUNCTION_LINES} is the limit; take it apart, or say why not (// Long: ...)")
                begin = None
        elif line.endswith("{"):
            first = number - 1
            while first > 0 and re.search(r"[\w,(&*>=]$|\)$|&&$|\|\|$", lines[first - 1]) and \
                    not re.match(r"\s*(//|#|template)", lines[first - 1]) and lines[first].startswith(" "):
                first -= 1
            head, indent = lines[first], len(lines[first]) - len(lines[first].lstrip())
            kind = re.match(r"\s*(inline )?(namespace|class|struct|enum|union|extern)\b", head)
            if indent <= 2 and not kind and "(" in " ".join(lines[first:number]):
                begin, closing = first + 1, " " * indent + "}"


def tails(files, start):
    """The names of the files and folders below start: src/scan.cpp is also scan.cpp, src/scan and scan."""
    for file in files:
        if file.startswith(start):
            parts = file[len(start):].split("/")
            for end in range(1, len(parts) + 1):
                for begin in range(end):
                    name = "/".join(parts[begin:end])
                    yield from (name, name.rsplit(".", 1)[0])


def check_names(path, lines, files, everything):
    if not path.endswith(".md") or os.path.basename(path) in ("CHANGELOG.md", "HISTORY.md"):
        return
    known, table = None, False
    for number, line in enumerate(lines, 1):
        table = line.startswith("|") and (table or bool(re.match(r"\| (file|folder|header|room)", line)))
        names = re.findall(r"`([^`]+)`", line.split("|")[1]) if table else []
        known = known or (names and set(tails(files, os.path.join(os.path.dirname(path), ""))))
        for name in names:
            if not re.search("[A-Z]{4}", name) and not fnmatch.filter(known, name.rstrip("/")):
                yield f"{path}:{number}: there is no {name} in {os.path.dirname(path)}"
        for link in re.findall(r"\]\(([^)#:]+)(?:#[^)]*)?\)", line):
            if not os.path.exists(os.path.join(os.path.dirname(path), link)):
                yield f"{path}:{number}: there is no {link}"
        for name in re.findall(r"`(?:\.\./)*([\w./-]+\.(?:h|hpp|c|cpp|glsl|inl|py|sh))`", line):
            if name not in names and not re.search("[A-Z]{4}", name) and name not in everything:
                yield f"{path}:{number}: there is no {name}"


def check_format(files):
    program = shutil.which("clang-format")
    version = program and subprocess.run([program, "--version"], capture_output=True, text=True).stdout
    if not program or " 14." not in version:  # other versions lay some things out differently
        print("clang-format 14 is not installed: not tried (tools/setup.sh tests)")
        return
    done = subprocess.run([program, "--dry-run", "--Werror", *files], capture_output=True, text=True)
    for line in done.stderr.split("\n"):
        if "clang-format-violations" in line:
            yield line + "; run clang-format -i"


def main():
    os.chdir(os.path.join(os.path.dirname(os.path.abspath(__file__)), ".."))
    faults, files = [], tracked()
    everything = set(tails(files, ""))
    for path in files:
        if not path.endswith(CODE + SHADERS + SCRIPTS + (".md",)):
            continue
        with open(path, encoding="utf-8") as file:
            lines = file.read().rstrip("\n").split("\n")
        for check in (check_arrows, check_apart, check_widths, check_ported, check_lengths):
            faults.extend(check(path, lines))
        faults.extend(check_names(path, lines, files, everything))
    doors = {room: (room, os.path.dirname(room), room.split("/src/")[0]) for room in ROOMS}
    faults.extend(f"{room}: has no README.md" for room in ROOMS
                  if not any(os.path.isfile(f"{place}/README.md") for place in doors[room]))
    faults.extend(check_format([path for path in files if path.endswith(CODE)]))
    for fault in faults:
        print(fault)
    print(f"{len(files)} files, {len(faults)} faults")
    return 1 if faults else 0


if __name__ == "__main__":
    sys.exit(main())
