# SPDX-License-Identifier: MIT
"""Usage: literals_test.py EMBEDDED_CPP FOLDER

The texts that shaders/embed.cmake embeds: those of the files in FOLDER, in literals that MSVC takes."""

import glob
import re
import sys


def main(embedded, folder):
    with open(embedded, encoding="utf-8", newline="") as file:
        text = file.read()
    constants = re.findall(r'^const char\* const (k\w+) =((?:\s*R"GLSL\(.*?\)GLSL")+);', text, re.S | re.M)
    files = {}
    for path in glob.glob(folder + "/*"):
        if re.search(r"\.(glsl|vert|frag)$", path):
            with open(path, encoding="utf-8", newline="") as file:
                files[file.read()] = path
    longest = 0
    for name, literals in constants:
        pieces = re.findall(r'R"GLSL\((.*?)\)GLSL"', literals, re.S)
        sizes = [len(piece.encode()) for piece in pieces]
        assert max(sizes) <= 16380, "%s: a literal of %d bytes" % (name, max(sizes))
        assert sum(sizes) <= 65535, "%s: %d bytes in all" % (name, sum(sizes))
        assert files.pop("".join(pieces), None), name + " is not the text of a file in " + folder
        longest = max(longest, *sizes)
    assert not files, "not embedded: %s" % sorted(files.values())
    print("%d texts, the longest literal has %d bytes" % (len(constants), longest))


if __name__ == "__main__":
    main(*sys.argv[1:])
