# SPDX-License-Identifier: MIT
"""Usage: literals_test.py EMBEDDED_CPP FOLDER

The texts that shaders/embed.cmake embeds: those of the files in FOLDER, in literals that MSVC takes, and in
the order in which the main files include them. Each line has the number that it has in its file, and its
text the one that runtime/HOST_GUIDE.md tells."""

import os
import re
import sys

HOST = "kelp_surface.glsl"  # the host's


def read(folder, name):
    with open(os.path.join(folder, name), encoding="utf-8", newline="") as file:
        return file.read()


def included(folder, name):
    """The lines behind the first #include of a file, with those of the files that it includes: (file, line
    number, line). A file without an #include: all."""
    if name == HOST:
        yield (HOST, 1, "")
        return
    lines = read(folder, name).split("\n")
    starts = [i for i, line in enumerate(lines) if line.startswith("#include")]
    for i in range(starts[0] if starts else 0, len(lines)):
        found = re.match(r'#include "(.*)"', lines[i])
        if found:
            yield from included(folder, found[1])
        elif lines[i].strip():
            yield (name, i + 1, lines[i])


def text_of(literals):
    pieces = re.findall(r'R"GLSL\((.*?)\)GLSL"', literals, re.S)
    sizes = [len(piece.encode()) for piece in pieces]
    assert max(sizes) <= 16380, "a literal of %d bytes: %s ..." % (max(sizes), pieces[0][:100])
    assert sum(sizes) <= 65535, "%d bytes in all: %s ..." % (sum(sizes), pieces[0][:100])
    return "".join(pieces)


def main(embedded, folder):
    code = read("", embedded)
    literal = r'(?:\s*R"GLSL\(.*?\)GLSL")+'
    texts = {name: text_of(literals) for name, literals in
             re.findall(r"^constexpr const char\* (k\w+) =(%s);" % literal, code, re.S | re.M)}
    files = {name for name in os.listdir(folder) if re.search(r"\.(glsl|vert|frag)$", name)}
    contents = {read(folder, name): name for name in files}
    numbers, used = {}, set()
    mains = {"kVertex": "draw.vert", "kFragment": "draw.frag", "kFogFragment": "fog.frag",
             "kLineVertex": "lines.vert", "kLineFragment": "lines.frag", "kScene": "scene.glsl"}
    for main_name, main_file in mains.items():
        pieces = re.search(r"Piece %sPieces\[\] = \{(.*?)\n\};\nconstexpr" % main_name, code, re.S)[1]
        found = []
        for line, string, name, literals in re.findall(
                r'\{"\\n#line (\d+) (\d+)\\n",(?: (k\w+|nullptr)|(%s))\}' % literal, pieces, re.S):
            text = texts[name] if name in texts else "" if name else text_of(literals)
            file = contents[text] if name in texts else HOST if name else None
            for i, part in enumerate(text.split("\n")):
                if part.strip() or file == HOST:
                    found.append((string, int(line) + i, part))
        expected = list(included(folder, main_file))
        assert [line[1:] for line in found] == [line[1:] for line in expected], main_file
        for (string, *_), (file, *_) in zip(found, expected):
            assert numbers.setdefault(file, string) == string, "%s has two numbers" % file
            used.add(file)
        used.add(main_file)
    guide = read(folder, "../runtime/HOST_GUIDE.md")
    said = {file: number for number, file in re.findall(r"(\d+)\s`(\w+\.glsl)`", guide)}
    assert len(said) > 10
    for file, number in said.items():
        assert numbers[file] == number, "%s is string %s" % (file, numbers[file])
    assert files | {HOST} == used, "not embedded: %s" % sorted(files - used)
    print("%d texts in %d orders" % (len(texts), len(mains)))


if __name__ == "__main__":
    main(*sys.argv[1:])
