# SPDX-License-Identifier: MIT
"""Usage: abi_test.py SOURCE_FOLDER LIBKELP_SO CC CXX NM READELF [--write]
       abi_test.py --dll SOURCE_FOLDER IMPORT_LIBRARY NM    the exports of kelp.dll alone

- kelp/kelp.h compiles alone as C99 and as C++11, with -Wall -Wextra -pedantic and without a warning.
- libkelp.so exports the functions that the headers declare, and nothing else; its SONAME is right.
- Functions, structs (sizes, offsets) and constants are those of tests/c/kelp.abi. --write writes that file:
  what may change is said in runtime/c/README.md, "ABI".
- tests/c calls every function."""

import difflib
import glob
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
    abi = soname + "\n" + abi + layout(include, structs, constants, cc)
    if "--write" in options:
        with open(tests + "/kelp.abi", "w", encoding="utf-8") as file:
            file.write(abi)
    difference = "\n".join(difflib.unified_diff(read(tests + "/kelp.abi").splitlines(), abi.splitlines(),
                                                "kelp.abi", "now", lineterm=""))
    assert not difference, "the ABI is not that of tests/c/kelp.abi:\n" + difference

    calls = "".join(read(path) for path in glob.glob(tests + "/*_test.cpp"))
    uncalled = [name for name in functions if not re.search(r"\b%s\(" % name, calls)]
    assert not uncalled, "no test calls " + ", ".join(uncalled)
    print("%d functions, %d structs, %d constants" % (len(functions), len(structs), len(constants)))


if __name__ == "__main__":
    if sys.argv[1] == "--dll":
        check_dll(*sys.argv[2:])
    else:
        main(*sys.argv[1:])
