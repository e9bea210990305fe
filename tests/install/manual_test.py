#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Manual pages: all that --help says, nothing else; and what man, groff and mandoc say of them.

Usage: manual_test.py SOURCES FOLDER PROGRAM... -- [unittest options]
FOLDER: manual/ of a build, or the prefix of an installation. SOURCES: a checkout, or - without one."""

import gzip
import os
import re
import shutil
import subprocess
import sys
import unittest

from help_truth import needs, place, truths

END = sys.argv.index("--")
SOURCES, FOLDER, PROGRAMS = sys.argv[1], sys.argv[2], [os.path.abspath(path) for path in sys.argv[3:END]]
del sys.argv[1:END + 1]
SECTIONS = ["NAME", "SYNOPSIS", "DESCRIPTION", "OPTIONS", "EXIT STATUS", "ENVIRONMENT", "EXAMPLES",
            "SEE ALSO"]


def run(*command, **more):
    return subprocess.run(command, capture_output=True, text=True, **more)


def squeezed(text):
    return re.sub(r"\s+", "", text)


class Page:
    """A page as a reader sees it, by section."""

    def __init__(self, program):
        self.path = place(FOLDER, "man", program)
        with gzip.open(self.path, "rt", encoding="ascii") as file:
            self.source = file.read()
        done = run("groff", "-mandoc", "-Tascii", "-P-cbou", "-rLL=200n", "-rHY=0", input=self.source)
        self.text = done.stdout
        parts = re.split(r"(?m)^([A-Z][A-Z ]+)$", self.text)
        self.titles = parts[1::2]
        self.sections = dict(zip(parts[1::2], parts[2::2]))


def options_in(section):
    """The options that begin entries: seven columns in, bold ones first."""
    found = set()
    for head in re.findall(r"(?m)^ {7}(-\S.*)$", section):
        for word in re.split(r",? ", head):
            if not re.fullmatch(r"--?[A-Za-z][a-zA-Z-]*", word):
                break
            found.add(word)
    return found


class ManualPages(unittest.TestCase):
    def each(self):
        return [(truths([path]), Page(os.path.basename(path))) for path in PROGRAMS]

    def test_sections(self):
        for own, page in self.each():
            wanted = SECTIONS[:4] + (["COMMANDS"] if own[0].commands else []) + SECTIONS[4:]
            if "ENVIRONMENT" not in page.sections:  # of a program that reads none: see the test of that name
                wanted.remove("ENVIRONMENT")
            self.assertEqual(page.titles, wanted)
            for title, section in page.sections.items():
                self.assertTrue(section.strip(), title + " is empty")
            self.assertRegex(page.source, r"(?m)^\.TH %s 1 \d{4}-\d\d-\d\d " % own[0].program.upper())

    def test_options_are_those_of_help(self):
        for own, page in self.each():
            self.assertEqual(options_in(page.sections["OPTIONS"]), own[0].options)
            parts = re.split(r"(?m)^ {3}kelp-dump (\S+)$", page.sections.get("COMMANDS", ""))
            self.assertEqual(parts[1::2], own[0].commands)
            for truth, section in zip(own[1:], parts[2::2]):
                shown = section.split("--what occupancy\n")[0]  # its values are told of once more
                self.assertEqual(options_in(shown), truth.options)

    def test_each_word_of_help_is_there(self):
        for own, page in self.each():
            said = squeezed(page.text)
            missing = []
            for truth in own:
                before, _, after = truth.text.partition("Examples:\n")
                for line in after.partition("\n\n")[0].split("\n"):
                    missing += [piece for piece in re.split(r" {2,}", line.strip())
                                if squeezed(piece) not in said]
                for line in before.split("\n"):
                    if line in ("Positionals:", "Options:", "Subcommands:"):
                        continue
                    text = re.sub(r" (TEXT )?REQUIRED|^Usage:|\(?also -M.\)?", "", line)
                    missing += [word for word in re.findall(r"[A-Za-z0-9'.+-]{3,}", text) if word not in said]
            self.assertEqual(missing, [])

    def test_exit_codes(self):
        for own, page in self.each():
            said = " ".join(own[0].text.partition("Exit codes: ")[2].split())
            for code in re.findall(r"(?m)^ {7}(\d+) ", page.sections["EXIT STATUS"]):
                self.assertRegex(said, r"(^|, )%s " % code)
            for code in re.findall(r"(?:^|, )(\d+) [a-z]", said):
                self.assertRegex(page.sections["EXIT STATUS"], r"(?m)^ {7}%s " % code)

    @unittest.skipIf(SOURCES == "-", "no checkout")
    def test_environment_is_what_programs_read(self):
        for own, page in self.each():
            shown = set(re.findall(r"(?m)^ {7}([A-Z_]+)", page.sections.get("ENVIRONMENT", "")))
            read = set()
            for folder, _, files in os.walk(os.path.join(SOURCES, "tools", own[0].program, "src")):
                for name in files:
                    with open(os.path.join(folder, name), encoding="utf-8") as file:
                        read |= set(re.findall(r'getenv\("(\w+)"\)', file.read()))
            of_libraries = {"DISPLAY", "LIBGL_ALWAYS_SOFTWARE"}  # GLFW's, Mesa's
            self.assertEqual(shown - of_libraries, read)

    def test_dashes_can_be_copied(self):
        """A dash of prose may become a hyphen, which no program takes for a dash."""
        for _, page in self.each():
            for line in page.source.split("\n"):
                if not line.startswith("."):
                    self.assertNotRegex(line, r"(?<!\\)-")

    def test_no_warnings(self):
        for _, page in self.each():
            checks = [["groff", "-ww", "-mandoc", "-z", "-Tutf8"]]
            checks += [["mandoc", "-T", "lint"]] if shutil.which("mandoc") else []
            for check in checks:
                done = run(*check, input=page.source)
                self.assertEqual((done.stdout + done.stderr, done.returncode), ("", 0), check)
            if shutil.which("man"):
                done = run("man", "--warnings", "-l", page.path,
                           env={**os.environ, "LC_ALL": "C.UTF-8", "MANPAGER": "cat"})
                self.assertEqual((done.stderr, done.returncode), ("", 0))


if __name__ == "__main__":
    needs("groff")
    unittest.main()
