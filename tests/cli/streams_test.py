#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Standard streams, terminals, pipes and signals, as a shell hands them to kelp's programs.

Usage: streams_test.py SOURCE_FOLDER PROGRAM... -- [unittest options]"""
import os
import pty
import resource
import shutil
import subprocess
import sys
import tempfile
import unittest

from terminal import read_terminal

SOURCES = sys.argv.pop(1)
PROGRAMS = {}
while len(sys.argv) > 1:
    word = sys.argv.pop(1)
    if word == "--":
        break
    PROGRAMS[os.path.basename(word)] = os.path.abspath(word)
GOLDEN = os.path.join(SOURCES, "tests/formats/golden/solid.kelp")
TRIANGLE = "v 0 0 0\nv 1 0 0\nv 0 2 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 1 4 3\n"


class Case(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = folder.name
        shutil.copy(GOLDEN, self.path("tiny.kelp"))
        self.write("model.obj", TRIANGLE)

    def path(self, name):
        return os.path.join(self.folder, name)

    def write(self, name, text):
        with open(self.path(name), "w") as file:
            file.write(text)

    def read(self, name):
        with open(self.path(name), "rb") as file:
            return file.read()

    def sh(self, command, **more):
        """A command line of bash, as it is written; each program is $kelp_dump and so on."""
        names = {name.replace("-", "_"): program for name, program in PROGRAMS.items()}
        return subprocess.run(["bash", "-c", command], cwd=self.folder, capture_output=True, timeout=60,
                              env=dict(os.environ, **names), **more)

    def tells(self, result, code, *words):
        """One line on stderr that helps."""
        text = result.stderr.decode()
        self.assertEqual(result.returncode, code, text)
        self.assertEqual(text.count("\n"), 1, text)
        self.assertIn(";", text, "names no remedy")
        for word in words:
            self.assertIn(word, text)


class EveryProgram(Case):
    def outputs(self):
        """Standard output of each program."""
        commands = ["%s %s" % (program, option) for program in PROGRAMS.values()
                    for option in ("--help", "--version")]
        if "kelp-dump" in PROGRAMS:
            commands += ["$kelp_dump " + words for words in
                         ("info --help", "schema", "info tiny.kelp", "verify tiny.kelp",
                          "diff tiny.kelp tiny.kelp", "rig tiny.kelp --part 0",
                          "extract tiny.kelp --vox -")]
        return commands

    def test_a_full_disk_and_a_closed_stream_are_told(self):
        for command in self.outputs():
            for where, why in ((">/dev/full", "No space left"), (">&-", "Bad file descriptor")):
                with self.subTest(command + where):
                    result = self.sh(command + " " + where)
                    self.assertEqual(result.returncode, 2, result.stderr.decode())
                    self.assertIn(why, result.stderr.decode())

    def test_a_reader_that_has_enough_is_no_error(self):
        for command in self.outputs():
            with self.subTest(command):
                said = self.sh(command + " >/dev/null").stderr
                self.assertEqual(self.sh(command + " | head -c 1 >/dev/null").stderr, said)

    @unittest.skipUnless("kelp-bake" in PROGRAMS, "no kelp-bake")
    def test_what_is_said_to_a_closed_stream_does_not_go_into_files(self):
        self.assertEqual(
            self.sh(
                "$kelp_bake model.obj -o a.kelp --resolution 8 --progress json --report a.json").returncode,
            0)
        self.assertEqual(self.sh("exec <&- >&- 2>&-; $kelp_bake model.obj -o b.kelp --resolution 8 "
                                 "--progress json --report b.json").returncode, 0)
        self.assertEqual(self.read("a.kelp"), self.read("b.kelp"))

    @unittest.skipUnless("kelp-dump" in PROGRAMS, "no kelp-dump")
    def test_nor_into_those_of_kelp_dump(self):
        for closed in ("", "exec <&- >&- 2>&-; "):
            command = "$kelp_dump extract tiny.kelp --vox %d.vox" % bool(closed)
            self.assertEqual(self.sh(closed + command).returncode, 0)
        self.assertEqual(self.read("0.vox"), self.read("1.vox"))

    @unittest.skipUnless("kelp-bake" in PROGRAMS, "no kelp-bake")
    def test_reports_and_rules_go_onto_open_streams(self):
        """Text that others write there, before and after, stays."""
        self.assertEqual(self.sh("(echo one; $kelp_bake model.obj -o a.kelp --resolution 8 -MF /dev/stdout; "
                                 "echo three) >log").returncode, 0)
        self.assertRegex(self.read("log").decode(), r"^one\na\.kelp: (.|\n)*model\.obj(.|\n)*\nthree\n$")
        self.assertEqual(self.sh("echo one >log2; $kelp_bake model.obj -o a.kelp --resolution 8 --report "
                                 "/dev/stderr 2>>log2").returncode, 0)
        self.assertRegex(self.read("log2").decode(), r'^one\n(.|\n)*"kelp-bake"')
        self.assertEqual(self.sh("$kelp_bake model.obj -o a.kelp --resolution 8 --report /dev/stdout | "
                                 "python3 -c 'import json, sys; json.load(sys.stdin)'").returncode, 0)
        for command in ("$kelp_bake model.obj -o /dev/stdout --resolution 8 >>log",
                        "$kelp_bake model.obj -o /dev/fd/1 --resolution 8 | cat; exit ${PIPESTATUS[0]}"):
            self.tells(self.sh(command), 2, "open stream")
        self.tells(self.sh("$kelp_bake model.obj -o a.kelp --resolution 8 --report -"), 1, "--report -")

    @unittest.skipUnless("kelp-dump" in PROGRAMS, "no kelp-dump")
    def test_no_open_stream_is_replaced(self):
        self.tells(
            self.sh("echo one >log; $kelp_dump extract tiny.kelp --vox /dev/stdout >>log"), 2, "open stream")
        self.assertEqual(self.read("log"), b"one\n")

    @unittest.skipUnless("kelp-dump" in PROGRAMS, "no kelp-dump")
    def test_notes_that_nobody_can_read_change_nothing(self):
        for command in ("rig tiny.kelp", "slice tiny.kelp -o a.png", "extract tiny.kelp --vox a.vox"):
            with self.subTest(command):
                self.assertEqual(self.sh("$kelp_dump %s 2>/dev/full >/dev/null" % command).returncode,
                                 self.sh("$kelp_dump %s >/dev/null" % command).returncode)

@unittest.skipUnless("kelp-dump" in PROGRAMS, "no kelp-dump")
class Dump(Case):
    def on_terminal(self, command):
        """The exit code, and what a terminal that is standard output and error gets."""
        primary, secondary = pty.openpty()
        process = subprocess.Popen([PROGRAMS["kelp-dump"], *command], cwd=self.folder,
                                   stdin=subprocess.DEVNULL, stdout=secondary, stderr=secondary)
        os.close(secondary)
        text = read_terminal(primary)
        return process.wait(timeout=60), text

    def test_bytes_do_not_go_to_a_terminal(self):
        commands = [["extract", "tiny.kelp", "--vox", "-"]]
        if self.sh("$kelp_dump slice none.kelp -o -").returncode != 5:
            commands.append(["slice", "tiny.kelp", "--part", "0", "-o", "-"])
        for command in commands:
            with self.subTest(command):
                code, text = self.on_terminal(command)
                self.assertEqual(code, 1, text)
                self.assertRegex(text.decode(), r"^kelp-dump: -: .* terminal .*; redirect it .*\r\n$")
                self.assertEqual(self.sh("$kelp_dump %s | wc -c" % " ".join(command)).returncode, 0)
        self.assertEqual(self.on_terminal(["info", "tiny.kelp"])[0], 0)
        self.assertEqual(self.on_terminal(["rig", "tiny.kelp", "--part", "0"])[0], 0)

    def test_packs_are_files(self):
        for command in ("cat tiny.kelp | $kelp_dump info -", "$kelp_dump info <(cat tiny.kelp)",
                        "mkfifo p; $kelp_dump info p"):
            self.tells(self.sh(command), 1, "pipe")
        for device in ("/dev/null", "/dev/zero"):
            self.tells(self.sh("$kelp_dump info " + device), 2, "is a device")

    def test_odd_arguments(self):
        for code, words, says in ((1, "info ''", "PACK: is empty"),
                                  (1, "diff tiny.kelp tiny.kelp --tolerance ''", "--tolerance: is empty"),
                                  (1, "extract tiny.kelp --vox ''", "--vox: is empty"),
                                  (1, "--nonsense", "--nonsense: "),
                                  (1, "-", "-: "),
                                  (1, "info -x", "-x: is not expected"),
                                  (1, "slice tiny.kelp -o o.png --at 99999999999", "--at"),
                                  (2, "info $'no\\n.kelp'", "no .kelp: "),
                                  (1, "$'in\\nfo'", "in?fo"),
                                  (2, "info " + "x" * 5000, "too long"),
                                  (2, "extract tiny.kelp --vox " + "x" * 256, "too long")):
            with self.subTest(words):
                self.tells(self.sh("$kelp_dump " + words), code, says)
        before = sorted(os.listdir(self.folder))
        self.assertEqual(self.sh("$kelp_dump extract tiny.kelp --vox " + "x" * 255).returncode, 0)
        self.assertEqual(
            self.sh("cp tiny.kelp $'\\xff.kelp'; $kelp_dump info $'\\xff.kelp' --format json >/dev/null"
                    ).returncode, 0)
        self.assertEqual(len(os.listdir(self.folder)), len(before) + 2)

    @unittest.skipUnless(os.path.isdir("/dev/shm") and os.geteuid() == 0, "needs root, to make a small disk")
    def test_a_small_disk(self):
        """Full, or read-only: told, and what was there stays."""
        os.mkdir(self.path("disk"))
        if self.sh("mount -t tmpfs -o size=16k tmpfs disk").returncode != 0:
            self.skipTest("this machine may not mount")
        try:
            self.assertEqual(self.sh("head -c 12000 /dev/zero >disk/there; cp tiny.kelp disk/old.kelp; cp "
                                     "disk/old.kelp old").returncode, 0)
            for command in ("$kelp_dump extract tiny.kelp --vox disk/o.vox",
                            "$kelp_bake model.obj -o disk/new.kelp --resolution 64"):
                if "bake" in command and "kelp-bake" not in PROGRAMS:
                    continue
                for state in ("", "mount -o remount,ro disk; "):
                    result = self.sh("%s (yes >disk/fill) 2>/dev/null; %s; code=$?; mount -o remount,rw "
                                     "disk; rm -f disk/fill; exit $code" % (state, command))
                    self.assertEqual(result.returncode, 2, (command, result.stderr))
                    self.assertIn(b"Read-only" if state else b"No space left", result.stderr)
                    self.assertEqual(sorted(os.listdir(self.path("disk"))), ["old.kelp", "there"])
                    self.assertEqual(self.read("disk/old.kelp"), self.read("old"))
        finally:
            self.sh("umount disk")

    def test_the_vdb_program_is_named_where_it_is(self):
        os.mkdir(self.path("bin"))
        shutil.copy(PROGRAMS["kelp-dump"], self.path("bin/kelp-dump"))
        self.assertNotIn(b"vdb", self.sh("bin/kelp-dump --version").stdout)
        self.tells(self.sh("bin/kelp-dump extract tiny.kelp --vdb o.vdb"), 5, "kelp-dump-vdb")
        if os.path.exists(PROGRAMS["kelp-dump"] + "-vdb"):
            os.makedirs(self.path("libexec/kelp"))
            os.symlink(PROGRAMS["kelp-dump"] + "-vdb", self.path("libexec/kelp/kelp-dump-vdb"))
            self.assertIn(b", vdb, nvdb)", self.sh("bin/kelp-dump --version").stdout)
            self.assertEqual(self.sh("bin/kelp-dump extract tiny.kelp --vdb o.vdb").returncode, 0)

    def test_what_is_half_written_replaces_nothing(self):
        self.write("keep.vox", "what was there")
        limited = lambda: resource.setrlimit(resource.RLIMIT_FSIZE, (100, 100))
        result = subprocess.run([PROGRAMS["kelp-dump"], "extract", "tiny.kelp", "--vox", "keep.vox"],
                                cwd=self.folder, capture_output=True, preexec_fn=limited)
        self.tells(result, 2, "keep.vox", "too large")
        self.assertEqual(self.read("keep.vox"), b"what was there")
        self.assertEqual(sorted(os.listdir(self.folder)), ["keep.vox", "model.obj", "tiny.kelp"])


if __name__ == "__main__":
    unittest.main()
