# SPDX-License-Identifier: MIT
"""Usage: kelp_lines.py FOLDER_OF_SAMPLES [SAMPLE]

Which lines of a one-file sample are kelp's: all lines of each statement that names kelp, or an object of
kelp's (a variable that such a statement declares as `auto` or as a type of kelp). Comments and texts in
quotes do not count. With SAMPLE, prints them. Without, checks that samples/README.md lists them as they are,
that the samples are as short as it says, and that README.md needs ten lines of C++."""

import os
import re
import sys

MOST_LINES = 119
SAMPLES = {"game_loop": 20, "sdl": None}  # the most lines that may be kelp's


def bare(line):
    """Without comments and quoted texts, except the name of an include."""
    if not line.startswith("#include"):
        line = re.sub(r'"(?:[^"\\]|\\.)*"', '""', line)
    return re.sub(r"//.*", "", line).strip()


def statements(text):
    """Lists of line numbers: a statement ends where a line ends in ; { } or : outside of parentheses."""
    text = re.sub(r'R"\((.*?)\)"', lambda raw: '""' + "\n" * raw[1].count("\n"), text, flags=re.S)
    lines, current, deep = [bare(line) for line in text.split("\n")], [], 0
    for number, line in enumerate(lines):
        if not line:
            continue
        current.append(number)
        deep += line.count("(") - line.count(")")
        if line.startswith("#") or line.endswith(("{", "}", ":")) or (line.endswith(";") and deep <= 0):
            yield current, " ".join(lines[n] for n in current)
            current, deep = [], 0


def kelp_lines(text):
    """The numbers of kelp's lines."""
    found, names = set(), {"kelp"}
    aliases = re.findall(r"namespace (\w+) = kelp", text)
    names.update(aliases)
    types = "|".join([r"kelp(?:::\w+)+"] + [name + r"::\w+" for name in aliases])
    declares = re.compile(r"(?:\bauto|\b(?:%s|std::\w+<(?:%s)>))[ &*]+(\w+)\b(?!\()" % (types, types))
    while True:
        before = len(found), len(names)
        word = re.compile(r"\b(?:%s)\b" % "|".join(names))
        for numbers, statement in statements(text):
            if not word.search(statement):
                continue
            found.update(numbers)
            names.update(declares.findall(statement))
        if (len(found), len(names)) == before:
            return sorted(found)


def lines_of(folder, sample):
    with open(os.path.join(folder, sample, "main.cpp"), encoding="utf-8") as file:
        text = file.read()
    lines = text.split("\n")
    return len(lines) - 1, [lines[number].strip() for number in kelp_lines(text)]


def blocks_of(text):
    """The lines of each block of C++ in Markdown."""
    return [[line.strip() for line in block.strip().split("\n")]
            for block in re.findall(r"```cpp\n(.*?)```", text, flags=re.S)]


def main(folder, sample=None):
    if sample:
        print("\n".join(lines_of(folder, sample)[1]))
        return
    with open(os.path.join(folder, "README.md"), encoding="utf-8") as file:
        readme = file.read()
    for name, most in SAMPLES.items():
        total, lines = lines_of(folder, name)
        print("%s: %d lines, %d of them kelp's" % (name, total, len(lines)))
        assert total <= MOST_LINES, "%s has %d lines, more than %d" % (name, total, MOST_LINES)
        assert "`%s`: %d lines, %d of them kelp's" % (name, total, len(lines)) in readme, \
            "samples/README.md does not say how many lines %s has" % name
        if most:
            assert len(lines) <= most, "%d lines of %s are kelp's, more than %d" % (len(lines), name, most)
            assert lines in blocks_of(readme), "samples/README.md does not list kelp's lines of %s:\n%s" % (
                name, "\n".join(lines))
    with open(os.path.join(folder, "..", "README.md"), encoding="utf-8") as file:
        ten = [line for line in blocks_of(file.read())[0] if not line.startswith("//")]
    assert len(ten) <= 10, "README.md needs %d lines of C++, more than ten" % len(ten)


if __name__ == "__main__":
    main(*sys.argv[1:])
