# SPDX-License-Identifier: MIT
"""Manual pages from what --help says."""

import re
import textwrap

ENVIRONMENT = {
    "kelp-bake": [("TERM", "If it is dumb, there is no bar of progress.")],
    "kelp-dump": [],
    "kelp-render": [("LIBGL_ALWAYS_SOFTWARE", "Mesa's: if it is 1, the processor draws, not the GPU.")],
    "kelp-view": [("DISPLAY", "The X server that shows the window."),
                  ("PATH", "Where kelp-bake is looked for, unless it is beside kelp-view.")],
}
PROGRAMS = tuple(ENVIRONMENT)


def plain(text):
    text = text.replace("\\", "\\e").replace("-", "\\-").replace("^", "\\(ha").replace("~", "\\(ti")
    return re.sub(r"^(?=[.'])", r"\\&", text)


def bold(text):
    return "\\fB%s\\fP" % plain(text)


def italic(text):
    return "\\fI%s\\fP" % plain(text)


def prose(text, placeholders=()):
    """Options and programs are bold, the words that stand for a value italic."""
    pattern = r"(?<![\w-])--[a-z][a-z-]*|\bkelp-(?:%s)\b" % "|".join(name[5:] for name in PROGRAMS)
    if placeholders:
        pattern += r"|\b(?:%s)\b" % "|".join(map(re.escape, placeholders))
    out, at = "", 0
    for match in re.finditer(pattern, text):
        word = match[0]
        out += plain(text[at:match.start()]) + (italic(word) if word in placeholders else bold(word))
        at = match.end()
    return re.sub(r"^(?=[.'])", r"\\&", out + plain(text[at:]))


def value_text(option):
    if not option.value:
        return ""
    fixed, _ = option.choices()
    return "|".join(bold(value) if value in fixed else italic(value) for value in option.value.split("|"))


def entry(option):
    if option.flags:
        head = ", ".join(map(bold, option.flags)) + (" " + value_text(option) if option.value else "")
        head += " [%s]" % italic(option.second) if option.second else ""
    else:
        head = italic(option.name)
        if option.choices()[0]:
            head += " (%s)" % value_text(option)
    names = [value for value in option.choices()[1] if re.fullmatch(r"[A-Z]+", value)]
    text = prose(option.help, names + ([option.second] if option.second else []))
    remarks = ["default: " + prose(option.default)] if option.default else []
    remarks += ["required"] if option.required and option.flags else []
    return ".TP\n%s\n%s\n" % (head, text + (" (%s)" % "; ".join(remarks) if remarks else ""))


def usage_line(line, commands):
    def word(match):
        text = match[0]
        if text.startswith(("kelp-", "--")) or text in commands:
            return bold(text)
        return plain(text) if text == "of" else italic(text)
    return re.sub(r"[\w.-]+", word, line)


def synopsis(usage, commands):
    return "\n.br\n".join(usage_line(line, commands) for line in usage) + "\n"


def examples(pairs):
    out, seen = "", set()
    for command, remark in pairs:
        if command in seen and not remark:
            continue
        seen.add(command)
        out += ".TP\n%s\n%s\n" % (bold(command).replace("'", "\\(aq"), prose(remark) if remark else "\\&")
    return out


def notes(pairs):
    return "".join(".TP\n%s\n%s\n" % (bold(term), prose(text)) if term else ".PP\n%s\n" % prose(text)
                   for term, text in pairs)


def command_section(command):
    out = ".SS %s\n%s.PP\n%s.\n" % (plain(command.program + " " + command.command),
                                    synopsis(command.usage, [command.command]),
                                    prose(command.about))
    out += "".join(map(entry, command.arguments + command.options()))
    out += notes(command.notes)
    return out


def wrapped(text):
    """Lines of at most 80 bytes, except the terms of lists, which must be one."""
    out = []
    for line in text.split("\n"):
        if line.startswith((".", "\\&")) or out[-1:] == [".TP"]:
            out.append(line)
        else:
            lines = textwrap.wrap(line, 80, break_long_words=False, break_on_hyphens=False)
            out += [re.sub(r"^(?=[.'])", r"\\&", part) for part in lines]
    return "\n".join(out) + "\n"


def page(text, version, date):
    """text: a help_text.Help"""
    first, _, more = text.about.partition(". ")
    first = first[0].lower() + first[1:].rstrip(".")
    out = ".\\\" SPDX-License-Identifier: MIT\n.\\\" Made by tools/manual from %s --help.\n" % text.program
    out += '.TH %s 1 %s "kelp %s" "User Commands"\n' % (text.program.upper(), date, version)
    out += ".SH NAME\n%s \\- %s\n" % (plain(text.program), plain(first))
    out += ".SH SYNOPSIS\n" + synopsis(text.usage, text.commands)
    out += ".SH DESCRIPTION\n%s\n" % prose(text.about) + notes(text.notes)
    out += ".SH OPTIONS\n" + "".join(map(entry, text.arguments))
    for heading, options in text.groups.items():
        out += "" if heading == "Options" else ".SS %s\n" % plain(heading)
        out += "".join(map(entry, options))
    if text.commands:
        out += ".SH COMMANDS\n" + "".join(map(command_section, text.commands.values()))
    out += ".SH EXIT STATUS\n"
    out += "".join(".TP\n%s\n%s\n" % (bold(code), prose(meaning)) for code, meaning in text.exit_codes)
    out += ".PP\n%s\n" % prose(text.exit_note) if text.exit_note else ""
    out += ".SH ENVIRONMENT\n" if ENVIRONMENT[text.program] else ""
    out += "".join(".TP\n%s\n%s\n" % (bold(name), prose(about)) for name, about in ENVIRONMENT[text.program])
    of_commands = [pair for command in text.commands.values() for pair in command.examples]
    out += ".SH EXAMPLES\n" + examples(text.examples + of_commands)
    others = ["%s(1)" % bold(name) for name in PROGRAMS if name != text.program]
    return wrapped(out + ".SH SEE ALSO\n" + ",\n".join(others))
