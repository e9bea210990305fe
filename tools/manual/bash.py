# SPDX-License-Identifier: MIT
"""Completion for bash, which needs nothing of the package bash-completion."""

from values import argument_values, options_by_flags

HEAD = r"""# bash completion of %(program)s. SPDX-License-Identifier: MIT
# Made by tools/manual from %(program)s --help.

# Offers these words, and files: with these extensions, all for "*", folders alone for "/".
_%(name)s_offer() {
  local words=$1 file extension
  shift
  COMPREPLY=($(compgen -W "$words" -- "$word"))
  (($# > 0)) || return
  compopt -o filenames 2>/dev/null
  while IFS= read -r file; do
    if [[ -d ${file/#\~/$HOME} ]]; then
      COMPREPLY+=("$file")
      continue
    fi
    for extension in "$@"; do
      [[ $extension != '*' && ${file,,} != *."$extension" ]] || { COMPREPLY+=("$file"); break; }
    done
  done < <(compgen -f -- "$word")
}

# word: what is completed; before: the option whose value it may be
_%(name)s() {
  local word=${COMP_WORDS[COMP_CWORD]} before=${COMP_WORDS[COMP_CWORD - 1]}
  if [[ $word == '=' ]]; then
    word=
  elif [[ $before == '=' ]]; then
    before=${COMP_WORDS[COMP_CWORD - 2]}
  fi
  COMPREPLY=()
"""


def _offer(name, values):
    return "_%s_offer " % name + " ".join("'%s'" % word for word in [" ".join(values.words), *values.kinds])


def _cases(name, text, indent="  "):
    """Completes the options and arguments of a program or a command."""
    lines = ["case $before in"]
    for option, values in options_by_flags(text):
        if not option.value:
            continue
        offer = _offer(name, values) if values.words or values.kinds else ":"
        lines.append("  %s) %s ;;" % (" | ".join(option.flags), offer))
    flags = [flag for option in text.options() for flag in option.flags]
    argument = argument_values(text)
    lines += ["  *)",
              "    if [[ $word == -* ]]; then",
              "      _%s_offer '%s'" % (name, " ".join(dict.fromkeys(flags))),
              "    else",
              "      " + _offer(name, argument),
              "    fi ;;",
              "esac"]
    return "".join(indent + line + "\n" for line in lines)


def script(text, bakes=None):
    """bakes: what follows --watch MODEL"""
    name = text.program.replace("-", "_")
    out = HEAD % {"program": text.program, "name": name}
    if text.commands:
        flags = [flag for option in text.options() for flag in option.flags]
        out += "  if ((COMP_CWORD == 1)); then\n"
        out += "    if [[ $word == -* ]]; then\n      _%s_offer '%s'\n" % (name, " ".join(flags))
        out += "    else\n      _%s_offer '%s'\n    fi\n    return\n  fi\n" % (name, " ".join(text.commands))
        out += "  case ${COMP_WORDS[1]} in\n"
        for command in text.commands.values():
            out += "    %s)\n%s      ;;\n" % (command.command, _cases(name, command, "      "))
        out += "  esac\n"
    else:
        if bakes:
            out += "  local i\n  for ((i = 2; i < COMP_CWORD; ++i)); do\n"
            out += "    [[ ${COMP_WORDS[i - 1]} == --watch ]] || continue\n"
            out += "    [[ ${COMP_WORDS[i]} == *.kelp ]] || _%s_bakes\n    return\n  done\n" % name
        out += _cases(name, text)
    out += "}\n"
    if bakes:
        out += "\n# The options of kelp-bake after --watch MODEL.\n_%s_bakes() {\n%s}\n" % (
            name, _cases(name, bakes))
    return out + "\ncomplete -F _%s %s\n" % (name, text.program)
