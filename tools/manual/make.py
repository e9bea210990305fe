#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Writes manual pages and completions of kelp's programs, from what their --help says.

Usage: make.py VERSION FOLDER PROGRAM..."""

import gzip
import os
import sys
import time

import bash
import fish
import help_text
import man_page
import zsh

# Options that kelp-view sets itself when it bakes.
NOT_OF_VIEW = {"--progress", "--write-deps", "--deps-phony", "--deps-target", "--deps-file", "--help",
               "--version"}


def write(folder, place, content):
    path = os.path.join(folder, place)
    os.makedirs(os.path.dirname(path), exist_ok=True)
    with open(path, "wb") as file:
        file.write(content)


def main(version, folder, *paths):
    texts = {os.path.basename(path): path for path in paths}
    texts = {program: help_text.ask(path, program) for program, path in texts.items()}
    day = time.strftime("%Y-%m-%d", time.gmtime(int(os.environ.get("SOURCE_DATE_EPOCH", time.time()))))
    for program, text in texts.items():
        bakes = texts.get("kelp-bake") if program == "kelp-view" else None
        if bakes:
            bakes = help_text.Help("kelp-bake", groups={
                heading: [option for option in group if not NOT_OF_VIEW & set(option.flags)]
                for heading, group in bakes.groups.items()})
        page = man_page.page(text, version, day).encode()
        write(folder, "man/%s.1.gz" % program, gzip.compress(page, 9, mtime=0))
        write(folder, "bash/" + program, bash.script(text, bakes).encode())
        write(folder, "zsh/_" + program, zsh.script(text, bakes).encode())
        write(folder, "fish/%s.fish" % program, fish.script(text, bakes).encode())


if __name__ == "__main__":
    main(*sys.argv[1:])
