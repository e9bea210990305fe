# SPDX-License-Identifier: MIT
"""Completion for zsh, by its own _arguments."""

from values import argument_values, options_by_flags


def _quoted(text):
    return "'%s'" % text.replace("'", "'\\''")


def _escaped(text, characters):
    for character in "\\" + characters:
        text = text.replace(character, "\\" + character)
    return text


def _files(kinds):
    if kinds == ["/"]:
        return "_files -/"
    return "_files" if "*" in kinds else '_files -g "(#i)*.(%s)(-.)"' % "|".join(dict.fromkeys(kinds))


def _action(values):
    words = "(%s)" % " ".join(values.words)
    if values.words and values.kinds:
        return '{_alternative "words\\:word\\:%s" "files\\:file\\:%s"}' % (
            words, _files(values.kinds).replace('"', '\\"'))
    return words if values.words else _files(values.kinds) if values.kinds else " "


def _option(option, values, repeats, equals):
    spec = "[%s]" % _escaped(option.help, "[]")
    if option.value:
        spec += ":%s:%s" % (_escaped(option.value, ":"), _action(values))
    if option.flags[-1] in ("--help", "--version"):
        before = "(- *)"
    elif repeats:
        before = "*"
    else:
        before = "(%s)" % " ".join(option.flags)
    return [_quoted(before + flag + ("=" if equals and option.value and flag.startswith("--") else "") + spec)
            for flag in option.flags]


def _arguments(text, equals, rest=()):
    repeats = "--and" in [flag for option in text.options() for flag in option.flags]
    lines = []
    for option, values in options_by_flags(text):
        specs = _option(option, values, repeats, equals)
        if rest and option.flags == ["--watch"]:
            specs = [specs[0][:-1] + rest[0] + "'"]
        lines += specs
    argument = argument_values(text)
    lines += [_quoted(":%s:%s" % (_escaped(word.name, ":"), _action(argument))) for word in text.arguments]
    return " \\\n".join("    " + line for line in lines + list(rest[1:]))


def script(text, bakes=None):
    """bakes: what follows --watch MODEL"""
    name = text.program.replace("-", "_")
    equals = not bakes
    out = "#compdef %s\n# SPDX-License-Identifier: MIT\n" % text.program
    out += "# Made by tools/manual from %s --help.\n\n" % text.program
    for command in text.commands.values():
        out += "_%s_%s() {\n  _arguments \\\n%s\n}\n\n" % (name, command.command, _arguments(command, equals))
    if bakes:
        out += "_%s_bakes() {\n  _arguments \\\n%s\n}\n\n" % (name, _arguments(bakes, True))
    if text.commands:
        out += "_%s_commands() {\n  local -a commands=(\n" % name
        out += "".join("    %s\n" % _quoted(command.command + ":" + _escaped(command.about, ""))
                       for command in text.commands.values())
        out += "  )\n  _describe command commands\n}\n\n"
    out += "local context state state_descr line\ntypeset -A opt_args\n"
    if text.commands:
        rest = ("", "'1:command:_%s_commands'" % name, "'*::argument:->arguments'")
        out += "_arguments -C \\\n%s && return\n" % _arguments(text, equals, rest)
        out += '(( $+functions[_%s_$words[1]] )) && "_%s_$words[1]"\n' % (name, name)
    elif bakes:
        rest = (":*::option of kelp-bake:->bakes",)
        out += "_arguments -C \\\n%s && return\n" % _arguments(text, equals, rest)
        out += 'if [[ $state == bakes && $words[1] != *.kelp ]]; then\n'
        out += '  _%s_bakes  # words: the model, as if it were the command, and what follows\nfi\n' % name
    else:
        out += "_arguments \\\n%s\n" % _arguments(text, equals)
    return out
