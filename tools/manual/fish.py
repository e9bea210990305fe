# SPDX-License-Identifier: MIT
"""Completion for fish."""

from values import argument_values, options_by_flags

HEAD = r"""# fish completion of %(program)s. SPDX-License-Identifier: MIT
# Made by tools/manual from %(program)s --help.

# Folders, and files with these extensions.
function __%(name)s_files
    set -l word (commandline -ct | string replace -r '^-[^=]*=' '')
    complete -C "'' $word" | string match -rei '(?:/|\.(?:'(string join '|' $argv)'))(?:\t|$)'
end

"""
# Which command of kelp-dump; "" before there is one.
COMMANDS = """function __%(name)s_in
    set -l words (commandline -opc)
    test "$words[2]" = "$argv[1]"
end

"""
BAKES = """function __%(name)s_bakes
    set -l words (commandline -opc)
    set -l at (contains -i -- --watch $words)
    and test (count $words) -gt $at
    and not string match -q '*.kelp' -- $words[(math $at + 1)]
end

function __%(name)s_shows
    not contains -- --watch (commandline -opc)[1..-2]
end

"""


def _quoted(text):
    return "'%s'" % text.replace("\\", "\\\\").replace("'", "\\'")


def _offer(name, values):
    """The arguments of `complete` that offer these values."""
    words = values.words + []
    if values.kinds == ["/"]:
        words.append("(__fish_complete_directories)")
    elif values.kinds and "*" not in values.kinds:
        words.append("(__%s_files %s)" % (name, " ".join(dict.fromkeys(values.kinds))))
    return (" -F" if "*" in values.kinds else "") + (" -a " + _quoted(" ".join(words)) if words else "")


def _lines(name, text, condition):
    start = "complete -c %s%s" % (name.replace("_", "-"), " -n " + _quoted(condition) if condition else "")
    out = ""
    for option, values in options_by_flags(text):
        flags = "".join(" -l " + flag[2:] if flag.startswith("--") else
                        (" -s " if len(flag) == 2 else " -o ") + flag[1:] for flag in option.flags)
        value = ""
        if option.value:
            value = (" -r" if "*" in values.kinds else " -x") + _offer(name, values)
        out += "%s%s%s -d %s\n" % (start, flags, value, _quoted(option.help))
    argument = argument_values(text)
    if argument.words or argument.kinds:
        out += start + _offer(name, argument) + "\n"
    return out


def script(text, bakes=None):
    """bakes: what follows --watch MODEL"""
    name = text.program.replace("-", "_")
    out = HEAD % {"name": name, "program": text.program}
    if text.commands:
        out += COMMANDS % {"name": name}
    if bakes:
        out += BAKES % {"name": name}
    out += "complete -c %s -f\n" % text.program
    first = "__%s_in ''" % name if text.commands else "__%s_shows" % name if bakes else ""
    out += _lines(name, text, first)
    for command in text.commands.values():
        out += "complete -c %s -n %s -a %s -d %s\n" % (text.program, _quoted(first), command.command,
                                                     _quoted(command.about))
    for command in text.commands.values():
        out += _lines(name, command, "__%s_in %s" % (name, command.command))
    if bakes:
        out += _lines(name, bakes, "__%s_bakes" % name)
    return out
