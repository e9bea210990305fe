# SPDX-License-Identifier: MIT
"""The text of --help, for tests of what is made from it: read in a simpler way than tools/manual does."""

import os
import re
import shutil
import subprocess
import sys

# Where a build and an installation have them.
FOLDERS = {
    "man": ["man", "share/man/man1"],
    "bash": ["bash", "share/bash-completion/completions"],
    "zsh": ["zsh", "share/zsh/vendor-completions", "share/zsh/site-functions"],
    "fish": ["fish", "share/fish/vendor_completions.d"],
}
NAMES = {"man": "%s.1.gz", "bash": "%s", "zsh": "_%s", "fish": "%s.fish"}


def needs(*programs):
    """Ends the test, as ctest's SKIP_RETURN_CODE has it, unless these are installed."""
    absent = [program for program in programs if not shutil.which(program)]
    if absent:
        print("SKIPPED (opt-in): %s not installed; tools/setup.sh tests installs it" % ", ".join(absent))
        sys.exit(77)


def place(root, kind, program):
    paths = [os.path.join(root, folder, NAMES[kind] % program) for folder in FOLDERS[kind]]
    return next((path for path in paths if os.path.isfile(path)), paths[0])


class Truth:
    def __init__(self, path, command=""):
        self.path, self.command = path, command
        self.program = os.path.basename(path)
        self.words = [self.program] + ([command] if command else [])
        self.text = subprocess.run([path] + self.words[1:] + ["--help"], check=True, capture_output=True,
                                   text=True).stdout
        listed = self.text.partition("Subcommands:\n")[2].partition("\n\n")[0]
        self.commands = re.findall(r"^  (\S+)", listed, re.M)
        # "  -o,--output FILE", and "(also -MD)" in its text
        heads = re.findall(r"^  (-\S+)(?: (\S+))?", self.text, re.M)
        self.options = {flag for flags, _ in heads for flag in flags.split(",")}
        self.options |= set(re.findall(r"also (-[A-Z]+)\)", self.text))
        # Texts that begin beside the option, or below it.
        entry = r"(?m)^  (-[^ \n]+)(?: [^\n]*?)?(?:  +|\n {20,})(\S.*)$"
        self.descriptions = dict(re.findall(entry, self.text))
        # "--effort fast|best": what is in small letters is typed as it is
        self.choices = {}
        for flags, value in heads:
            words = [word for word in value.split("|") if re.fullmatch(r"[+-]?[a-z0-9-]+", word)]
            if "|" in value and words:
                self.choices[flags.split(",")[-1]] = set(words)


def truths(paths):
    """Of each program, and of each command of kelp-dump."""
    found = []
    for path in paths:
        found.append(Truth(path))
        found += [Truth(path, command) for command in found[-1].commands]
    return found
