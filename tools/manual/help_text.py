# SPDX-License-Identifier: MIT
"""Takes the --help of kelp's programs apart."""

import re
import subprocess
from dataclasses import dataclass, field


@dataclass
class Option:
    """An option, or without flags an argument by its place."""
    flags: list  # "-o", "--output"
    name: str  # of an argument by its place: "PACK"
    value: str  # "FILE", "fast|best"; empty: takes none
    second: str  # a value that may follow: "PICTURE.ppm"
    default: str
    required: bool
    help: str

    def choices(self):
        """(what is typed as it is, what stands for something)"""
        values = self.value.split("|")
        fixed = [value for value in values if len(values) > 1 and re.fullmatch(r"[+-]?[a-z0-9-]+", value)]
        return fixed, [value for value in values if value and value not in fixed]


@dataclass
class Help:
    program: str
    command: str = ""  # of kelp-dump: "info"
    about: str = ""
    usage: list = field(default_factory=list)
    arguments: list = field(default_factory=list)
    groups: dict = field(default_factory=dict)  # heading: options
    commands: dict = field(default_factory=dict)  # name: Help
    examples: list = field(default_factory=list)  # (command, remark)
    notes: list = field(default_factory=list)  # paragraphs: (term or "", text)
    exit_codes: list = field(default_factory=list)  # (number, meaning)
    exit_note: str = ""

    def options(self):
        return [option for group in self.groups.values() for option in group]


def _option(head, text):
    """head: "-o,--output OUT.png REQUIRED", "--yaw DEGREES [30]", "PACK TEXT REQUIRED" """
    bracket = re.search(r" \[([^\]]*)\]$", head)
    words = (head[:bracket.start()] if bracket else head).split()
    inside = bracket[1] if bracket else ""
    second = inside if re.fullmatch(r"[A-Z]+\.[a-z]+", inside) else ""
    required = words[-1] == "REQUIRED"
    words = words[:-1] if required else words
    is_flag = head.startswith("-")
    flags = words[0].split(",") + re.findall(r"also (-\w+)\)", text) if is_flag else []
    value = words[1] if len(words) > 1 else ""
    text = re.sub(r" \(also -\w+\)|; also -\w+(?=\))", "", text)
    return Option(flags, "" if is_flag else words[0], "" if value == "TEXT" else value, second,
                  "" if second else inside, required, text)


def _entries(block, column):
    """(heading, head, text) of each option, argument and command; texts begin at this column."""
    heading, found = "Options", []
    for line in block:
        if re.fullmatch(r"[A-Z][A-Za-z ]*:", line):
            heading = line[:-1]
        elif re.match(r"  \S", line):
            head = line[:column]  # one that has no room beside its text stands alone
            split = len(line) > column and head.endswith(" ") and head.count("[") == head.count("]")
            found.append([heading, (head if split else line).strip(), line[column:] if split else ""])
        else:
            found[-1][2] = (found[-1][2] + " " + line.strip()).strip()
    return found


def _examples(lines):
    found = []
    for line in lines:
        command, _, remark = line.strip().partition("  ")
        if line.startswith(" " * 10):  # a remark that had no room beside its command
            found[-1] = (found[-1][0], line.strip())
        else:
            found.append((command, remark.strip()))
    return found


def _take_exit_codes(text, result):
    """Returns what of a paragraph is not about exit codes."""
    before, found, after = text.partition("Exit codes: ")
    if found:
        listed = re.match(r"(?:\d+ (?:\([^)]*\)|[^.(])*)", after)[0]
        result.exit_codes = re.findall(r"(\d+) ((?:\([^)]*\)|[^,(])+)", listed)
        result.exit_note = after[len(listed):].lstrip(". ")
    return before.strip()


def _take_notes(block, result):
    paragraphs = [""]
    for line in block:
        term = re.match(r"\s*(\S.*?) {2,}(.*)", line)
        if term:
            result.notes.append((term[1], term[2]))
            continue
        paragraphs[-1] = (paragraphs[-1] + " " + line).strip()
        if line.endswith(".") and "Exit codes:" not in paragraphs[-1]:
            paragraphs.append("")
    texts = [_take_exit_codes(paragraph, result) for paragraph in paragraphs]
    result.notes.extend(("", text) for text in texts if text)


def parse(text, program, command=""):
    blocks = [block.split("\n") for block in re.split(r"\n\n+", text.strip("\n"))]
    column = len(re.search(r"^  -h,--help +", text, re.M)[0])
    result = Help(program, command)
    head = blocks.pop(0)
    start = next(i for i, line in enumerate(head) if line.startswith("Usage: "))
    result.about = " ".join(head[:start])
    result.usage = [line.removeprefix("Usage:").strip() for line in head[start:]]
    for block in blocks:
        if block[0] == "Examples:":
            result.examples = _examples(block[1:])
        elif any(re.match(r"  \S", line) for line in block):
            for heading, name, about in _entries(block, column):
                _add(result, heading, name, about)
        else:
            _take_notes(block, result)
    return result


def _add(result, heading, name, about):
    if heading == "Subcommands":
        result.commands[name] = Help(result.program, name, about)
        return
    option = _option(name, about)
    if option.flags:
        result.groups.setdefault(heading, []).append(option)
    else:
        result.arguments.append(option)


def ask(path, program):
    """Runs PROGRAM --help, and of each of its commands."""
    def said(*words):
        return subprocess.run([path, *words, "--help"], check=True, capture_output=True, text=True).stdout
    result = parse(said(), program)
    for name in result.commands:
        result.commands[name] = parse(said(name), program, name)
    return result
