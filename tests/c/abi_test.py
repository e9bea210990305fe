# SPDX-License-Identifier: MIT
"""Usage: abi_test.py SOURCE_FOLDER LIBKELP_SO CC CXX NM READELF [--write]
       abi_test.py --dll SOURCE_FOLDER IMPORT_LIBRARY NM    the exports of kelp.dll alone

- kelp/kelp.h compiles alone as C99 and as C++11, with -Wall -Wextra -pedantic and without a warning.
- libkelp.so exports the functions that the headers declare, and nothing else; its SONAME is right.
- Functions, structs (sizes, offsets) and constants are those of tests/c/kelp.abi. --write writes that file:
  what may change is said in runtime/c/README.md, "ABI".
- tests/c calls every function.
- kelp.py has the same functions, structs and constants. Skipped, and said so, where NumPy is absent."""

import ctypes
import difflib
import glob
import importlib
import os
import re
import subprocess
import sys
import tempfile

STRICT = ["-Wall", "-Wextra", "-pedantic", "-Werror"]


def run(*command):
    done = subprocess.run(command, capture_output=True, text=True)
    assert done.returncode == 0, "%s\n%s%s" % (" ".join(command), done.stdout, done.stderr)
    return done.stdout


def read(path):
    with open(path, encoding="utf-8") as file:
        return file.read()


def header_text(folder):
    """All headers in one, without comments and preprocessor."""
    text = "".join(read(path) for path in sorted(glob.glob(folder + "/kelp/c/*.h")))
    text = re.sub(r"//.*", "", text)
    return re.sub(r"^#.*(?:\\\n.*)*", "", text, flags=re.M)


def functions_of(text):
    """Name: declaration."""
    found = re.findall(r"KELP_API\s+([^;]*?\b(kelp_\w+)\([^;]*\));", text)
    return {name: re.sub(r"\s+", " ", declaration) for declaration, name in found}


def structs_of(text):
    """Name: names of fields."""
    structs = {}
    for name, body in re.findall(r"typedef struct (kelp_\w+) \{(.*?)\} \1;", text, flags=re.S):
        fields = [re.search(r"\(\*(\w+)\)|(\w+)(?:\[\w+\])*$", field.strip()) for field in body.split(";")
                  if field.strip()]
        structs[name] = [match[1] or match[2] for match in fields]
    return structs


def constants_of(text):
    return [name for body in re.findall(r"enum \{(.*?)\};", text, flags=re.S)
            for name in re.findall(r"\b(KELP_\w+)\s*=", body)]


def layout(include, structs, constants, cc):
    """The sizes and offsets that a C program prints."""
    lines = ["#include <kelp/kelp.h>", "#include <stdio.h>", "int main(void) {"]
    for name, fields in structs.items():
        lines.append('printf("struct %s: %%d bytes\\n", (int)sizeof(%s));' % (name, name))
        for field in fields:
            lines.append('printf("  %s: %%d bytes at %%d\\n", (int)sizeof(((%s*)0)->%s), '
                         '(int)offsetof(%s, %s));' % (field, name, field, name, field))
    lines += ['printf("%s = %%d\\n", (int)%s);' % (name, name) for name in constants]
    lines.append("return 0; }")
    with tempfile.TemporaryDirectory() as folder:
        source, program = os.path.join(folder, "layout.c"), os.path.join(folder, "layout")
        with open(source, "w", encoding="utf-8") as file:
            file.write("\n".join(lines) + "\n")
        run(cc, "-std=c99", "-I", include, source, "-o", program)
        return run(program)


def check_header(include, cc, cxx):
    with tempfile.TemporaryDirectory() as folder:
        for compiler, standard, name in ((cc, "c99", "alone.c"), (cxx, "c++11", "alone.cpp")):
            source = os.path.join(folder, name)
            with open(source, "w", encoding="utf-8") as file:
                file.write("#include <kelp/kelp.h>\n#include <kelp/kelp.h>\nint alone;\n")
            run(compiler, "-std=" + standard, *STRICT, "-I", include, "-c", source, "-o", os.devnull)


def ctypes_of(declaration, module, aliases):
    """The types of a function's parameters, as ctypes has them."""
    simple = {"int32_t": ctypes.c_int32, "uint32_t": ctypes.c_uint32, "uint64_t": ctypes.c_uint64,
              "float": ctypes.c_float, "double": ctypes.c_double, "char": ctypes.c_char}
    pointers = {"char": ctypes.c_char_p, "void": ctypes.c_void_p, "kelp_allocator": ctypes.c_void_p}
    kinds = []
    for parameter in re.search(r"\((.*)\)", declaration)[1].split(","):
        name, stars, array = re.match(r"(?:const )?(\w+)\s*([* const]*?)\s*\w+(\[\d+\])?$",
                                      parameter.strip()).groups()
        name = aliases.get(name, name)
        depth = stars.count("*") + bool(array)
        kind = simple.get(name, module._STRUCTS.get(name))
        if depth and (name in pointers or not isinstance(kind, type)):  # structs of NumPy: any pointer
            kind, depth = pointers.get(name, ctypes.c_void_p), depth - 1
        for _ in range(depth):
            kind = ctypes.POINTER(kind)
        kinds.append(kind)
    return tuple(kinds)


def layout_of(structs):
    """As layout(), of the structs of kelp.py."""
    for name, kind in structs.items():
        if isinstance(kind, type):
            yield "struct %s: %d bytes" % (name, ctypes.sizeof(kind))
            fields = [(field, getattr(kind, field)) for field, _ in kind._fields_]
            yield from ("  %s: %d bytes at %d" % (field, at.size, at.offset) for field, at in fields)
        else:
            yield "struct %s: %d bytes" % (name, kind.itemsize)
            yield from ("  %s: %d bytes at %d" % (field, at[0].itemsize, at[1])
                        for field, at in kind.fields.items())


def check_python(folder, library, text, functions, laid_out):
    os.environ["KELP_LIBRARY"] = library
    sys.path.insert(0, folder + "/runtime/python")
    try:
        module = importlib.import_module("kelp")
    except ImportError as absent:
        print("SKIPPED: kelp.py: %s" % absent)
        return
    aliases = dict((name, kind) for kind, name in re.findall(r"typedef (\w+) (kelp_\w+);", text))
    # Without the two that return no result, and the allocator, which cannot be one of Python's.
    ours = {"kelp_" + name: kinds for name, kinds in module._FUNCTIONS.items()}
    theirs = {name: ctypes_of(declaration, module, aliases) for name, declaration in functions.items()
              if name not in ("kelp_version", "kelp_result_text")}
    for name in sorted(set(ours) | set(theirs)):
        assert ours.get(name) == theirs.get(name), "kelp.py: %s takes %s, and in the header %s" % (
            name, ours.get(name), theirs.get(name))

    wanted = re.sub(r"struct kelp_allocator.*\n(?:  .*\n)*", "", laid_out)
    structs = sorted(re.findall(r"struct .*\n(?:  .*\n)*", wanted))
    found = sorted(re.findall(r"struct .*\n(?:  .*\n)*", "\n".join(layout_of(module._STRUCTS)) + "\n"))
    assert structs == found, "kelp.py: a struct differs from the header's:\n" + "\n".join(
        difflib.unified_diff("".join(structs).splitlines(), "".join(found).splitlines(), "header", "kelp.py",
                             lineterm=""))

    # What a program sees has all fields, but for sizes and counts that arrays and lists have.
    hidden = {"struct_size", "palette_count", "knot_count", "key_count", "fog_ramp_count", "code_count",
              "grid", "found", "bind_user", "records_size", "lines_size", "call_count"}
    for name, public in {
            "asset_info": module.AssetInfo, "part": module.Part, "clip": module.Clip, "wave": module.Wave,
            "track": module.Track, "socket": module.Socket, "level": module.Level,
            "distance_level": module.DistanceLevel, "instance": module.Instance,
            "raycast_answer": module.Hit, "distance_answer": module.Distance,
            "closest_point_answer": module.ClosestPoint, "sphere_cast_answer": module.SphereCast,
            "view": module.View, "stats": module.Stats, "draw_data": module.DrawData}.items():
        fields = {field for field, _ in module._STRUCTS["kelp_" + name]._fields_} - hidden
        shown = set(public.__annotations__) - ({"stats"} if name == "draw_data" else set())
        assert fields == shown, "kelp.py: %s and kelp_%s: %s" % (public.__name__, name, fields ^ shown)

    enums = {"ERROR": module.Result, "OK": module.Result, "UNIT": module.Unit, "PART": module.PartKind,
             "BEND": module.Bend, "TARGET": module.Target, "INTERPOLATION": module.Interpolation,
             "PLAY": module.Play, "STATE": module.State, "UNSOUND": module.Unsound,
             "FEATURE": module.Feature, "PROGRAM": module.Program, "DEPTH": module.Depth,
             "DIALECT": module.Dialect, "STAGE": module.Stage,
             "CLIP_RANGE": module.ClipRange, "SHADING": module.Shading, "OUTPUT": module.Output,
             "DEBUG_VIEW": module.DebugView, "PASS": module.Pass, "READ": module._Read}
    wanted = {}
    for name, value in re.findall(r"^KELP_(\w+) = (-?\d+)$", laid_out, flags=re.M):
        prefix = next((prefix for prefix in enums if re.match(prefix + "(_|$)", name)), None)
        if prefix is None:
            assert getattr(module, name) == int(value), "kelp.py: " + name
        else:
            wanted[(enums[prefix], name if name == "OK" else name[len(prefix) + 1:])] = int(value)
    found = {(enum, name): member.value for enum in enums.values()
             for name, member in enum.__members__.items()}
    assert wanted == found, "kelp.py: constants differ: %s" % sorted(
        str(item) for item in set(wanted.items()) ^ set(found.items()))


def check_exports(exported, functions):
    odd = set(exported) ^ set(functions)
    assert not odd, "declared and not exported, or the other way round: %s" % sorted(odd)


def check_dll(folder, import_library, nm):
    functions = functions_of(header_text(folder + "/runtime/c/include"))
    listed = [line.split() for line in run(nm, "--defined-only", import_library).splitlines()]
    check_exports({words[2] for words in listed if len(words) == 3 and words[1] == "T"}, functions)
    print("%d functions" % len(functions))


def main(folder, library, cc, cxx, nm, readelf, *options):
    include, tests = folder + "/runtime/c/include", folder + "/tests/c"
    check_header(include, cc, cxx)
    text = header_text(include)
    functions, structs, constants = functions_of(text), structs_of(text), constants_of(text)
    assert len(re.findall(r"\bKELP_API\b", text)) == len(functions), "a declaration is not understood"
    assert len(re.findall(r"\btypedef struct\b", text)) == len(structs), "a struct is not understood"

    exported = {line.split()[-1].split("@")[0]: line.split()[-2]
                for line in run(nm, "-D", "--defined-only", library).splitlines()}
    exported.pop("KELP_0")  # the version itself
    check_exports(exported, functions)
    assert set(exported.values()) == {"T"}, exported
    soname = "libkelp.so." + re.search(r"project\(kelp VERSION (\d+)\.", read(folder + "/CMakeLists.txt"))[1]
    assert "[%s]" % soname in run(readelf, "--dynamic", library), "the SONAME is not " + soname

    abi = "".join("%s\n" % functions[name] for name in sorted(functions))
    laid_out = layout(include, structs, constants, cc)
    abi = soname + "\n" + abi + laid_out
    if "--write" in options:
        with open(tests + "/kelp.abi", "w", encoding="utf-8") as file:
            file.write(abi)
    difference = "\n".join(difflib.unified_diff(read(tests + "/kelp.abi").splitlines(), abi.splitlines(),
                                                "kelp.abi", "now", lineterm=""))
    assert not difference, "the ABI is not that of tests/c/kelp.abi:\n" + difference

    calls = "".join(read(path) for path in glob.glob(tests + "/*_test.cpp"))
    uncalled = [name for name in functions if not re.search(r"\b%s\(" % name, calls)]
    assert not uncalled, "no test calls " + ", ".join(uncalled)
    check_python(folder, library, text, functions, laid_out)
    print("%d functions, %d structs, %d constants" % (len(functions), len(structs), len(constants)))


if __name__ == "__main__":
    if sys.argv[1] == "--dll":
        check_dll(*sys.argv[2:])
    else:
        main(*sys.argv[1:])
