# SPDX-License-Identifier: MIT
"""Real shells that are asked what they would complete."""

import os
import pty
import re
import select
import signal
import subprocess
import time

QUIET = {**os.environ, "TERM": "vt100", "LC_ALL": "C.UTF-8", "HISTFILE": ""}


def until(condition, what):
    deadline = time.monotonic() + 60
    while not condition():
        if time.monotonic() > deadline:
            raise TimeoutError(what)
        time.sleep(0.005)


class Terminal:
    """A shell that believes to have a user."""

    def __init__(self, command, folder, environment):
        self.pid, self.file = pty.fork()
        if self.pid == 0:
            os.chdir(folder)
            os.execvpe(command[0], command, environment)
        self.said = b""

    def type(self, text):
        os.write(self.file, text.encode())

    def listen(self):
        while select.select([self.file], [], [], 0)[0]:
            try:
                self.said += os.read(self.file, 65536)
            except OSError:
                return

    def close(self):
        os.close(self.file)
        os.kill(self.pid, signal.SIGKILL)
        os.waitpid(self.pid, 0)


class Bash:
    # Asks the function that `complete` has set, as bash does.
    ASK = r'''script=$1; shift; . "$script"; COMP_WORDS=("$@"); COMP_CWORD=$(($# - 1))
set -- $(complete -p "$1"); while [ "$1" != -F ]; do shift; done
"$2"; printf '%s\n' "${COMPREPLY[@]}"'''

    def __init__(self, scripts, folder):
        self.scripts, self.folder = scripts, folder

    def ask(self, *words):
        split = []  # as bash splits at the = of --effort=
        for word in words:
            split += [part for part in word.partition("=") if part] if word.startswith("--") else [word]
        done = subprocess.run(["bash", "--norc", "-c", self.ASK, "-", self.scripts[words[0]], *split],
                              cwd=self.folder, capture_output=True, text=True, check=True)
        assert done.stderr == "", done.stderr
        return {word: "" for word in done.stdout.split("\n") if word}

    def types(self, text):
        """The command line after TAB."""
        shell = Terminal(["bash", "--norc", "--noprofile", "-i"], self.folder, {**QUIET, "PS1": "> "})
        for script in self.scripts.values():
            shell.type(". %s\n" % script)
        shell.type(text + "\t\x01echo +\x05+; exit\n")
        answer = rb"\r\+(.*?) ?\+\r"
        until(lambda: shell.listen() or re.search(answer, shell.said), "bash does not answer")
        shell.close()
        return re.search(answer, shell.said)[1].decode()


class Fish:
    def __init__(self, scripts, folder):
        self.folder = folder
        self.sources = "".join("source %s; " % script for script in scripts.values())

    def ask(self, *words):
        line = " ".join(words)
        done = subprocess.run(["fish", "--no-config", "-c", self.sources + "complete -C '%s'" % line],
                              cwd=self.folder, capture_output=True, text=True, check=True,
                              env={**QUIET, "HOME": self.folder})
        assert done.stderr == "", done.stderr
        found = dict(line.partition("\t")[::2] for line in done.stdout.split("\n") if line)
        begin = words[-1] if words[-1].endswith("=") else ""  # --effort=fast
        return {word.removeprefix(begin): about for word, about in found.items()}


class Zsh:
    # Writes what the completion system adds, in place of showing it.
    SETUP = r'''
stty cols 200 rows 100; fpath=(%(fpath)s $fpath); autoload -Uz compinit; compinit -u -D; LISTMAX=100000
compadd() {
  local -a words texts
  if [[ -n ${argv[(r)-[OAD]]} ]]; then builtin compadd "$@"; return; fi
  builtin compadd -A words "$@"
  local at=${argv[(i)-[a-zA-Z]#d]}
  (( at < $# )) && texts=("${(@P)argv[at + 1]}")
  local i last=$(( $#words > $#texts ? $#words : $#texts ))
  for (( i = 1; i <= last; ++i )); print -r -- "$words[i]"$'\t'"${texts[i]}" >>$KELP_OUT
  builtin compadd "$@"
}
answer() { : >$KELP_OUT; _main_complete; compstate[list]=; compstate[insert]=; : >$KELP_OUT.done }
zle -C answer list-choices answer; bindkey '^I' answer; : >$KELP_OUT.done
'''

    def __init__(self, scripts, folder, setup):
        self.out = os.path.join(setup, "out")
        fpath = " ".join({os.path.dirname(script) for script in scripts.values()})
        with open(os.path.join(setup, "setup"), "w", encoding="utf-8") as file:
            file.write(self.SETUP % {"fpath": fpath})
        self.shell = Terminal(["zsh", "-f", "-i"], folder, {**QUIET, "KELP_OUT": self.out, "HOME": setup})
        self.shell.type(". %s/setup\n" % setup)
        self.wait()

    def wait(self):
        done = self.out + ".done"
        until(lambda: self.shell.listen() or os.path.exists(done), "zsh does not answer")
        os.unlink(done)

    def ask(self, *words):
        self.shell.type(" ".join(words) + "\t")
        self.wait()
        self.shell.type("\x15")
        with open(self.out, encoding="utf-8") as file:
            lines = file.read().split("\n")
        found = dict(line.partition("\t")[::2] for line in lines)
        self.texts = [line.partition("\t")[2] for line in lines]  # also of lines that belong to several words
        return {word.rstrip("="): about for word, about in found.items() if word}

    def close(self):
        self.shell.close()
