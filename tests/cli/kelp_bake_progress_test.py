#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""kelp-bake's progress on a terminal and elsewhere, and Ctrl-C at any moment.

Usage: kelp_bake_progress_test.py KELP_BAKE [unittest options]
KELP_ALL_TESTS=1 interrupts more often."""
import fcntl
import json
import os
import pty
import random
import re
import signal
import struct
import subprocess
import termios
import time
import unittest

from kelp_bake_case import KELP_BAKE, SANITIZED, Case, box, lump
from terminal import read_terminal

TRIES = 60 if os.environ.get("KELP_ALL_TESTS") else 8


class Progress(Case):
    def on_terminal(self, *arguments, columns=80, kind="xterm"):
        """The text that a terminal gets."""
        primary, secondary = pty.openpty()
        fcntl.ioctl(secondary, termios.TIOCSWINSZ, struct.pack("HHHH", 24, columns, 0, 0))
        process = subprocess.Popen([KELP_BAKE, *arguments], cwd=self.folder, stdout=subprocess.PIPE,
                                   stderr=secondary, env=dict(os.environ, TERM=kind))
        os.close(secondary)
        text = read_terminal(primary)
        process.stdout.close()
        self.assertEqual(process.wait(timeout=60), 0, text)
        return text.decode().replace("\r\n", "\n")

    def bars(self, text):
        """All bars that were drawn; none stays."""
        shown = [bar for bar in re.findall(r"\r\x1b\[K([^\r\n\x1b]*)", text)
                 if bar.startswith("[") or " [" in bar[:30]]
        for line in text.split("\n"):
            self.assertNotRegex(line.split("\r\x1b[K")[-1], r"\[#*\.*\]", "a bar stays")
        return shown

    def test_a_bar_on_a_terminal(self):
        self.write("lump.obj", lump(60))
        text = self.on_terminal(
            "lump.obj", "-o", "out.kelp", "--resolution", "110" if SANITIZED else "480", "--threads", "1")
        bars = self.bars(text)
        self.assertTrue(any(re.fullmatch(r"voxelize +\[#*\.*\] +\d+ %(, [0-9.e+]+ %/s, \d+:\d\d left)?", bar)
                            for bar in bars), bars)
        self.assertTrue(any(re.search(r"%/s, \d+:\d\d left", bar) for bar in bars), bars)
        self.assertIn("kelp-bake: wrote out.kelp", text)
        for columns in (20, 1):
            for bar in self.bars(
                    self.on_terminal("1.obj", "-o", "out.kelp", "--resolution", "60", columns=columns)):
                self.assertLess(len(bar), max(columns, 2))

    def test_silence_elsewhere(self):
        for arguments, kind in ((("--progress", "none"), "xterm"), ((), "dumb")):
            self.assertNotIn(
                "\x1b",
                self.on_terminal("1.obj", "-o", "out.kelp", "--resolution", "20", *arguments, kind=kind))
        self.assertNotIn("\x1b", self.passes("1.obj", "-o", "out.kelp", "--resolution", "20"))
        self.assertIn(
            "\x1b", self.passes("1.obj", "-o", "out.kelp", "--resolution", "20", "--progress", "bar"))

    def lines(self, text):
        """Every line there is."""
        lines = [json.loads(line) for line in text.splitlines()]
        for line in lines:
            self.assertIn(line["kind"], ("progress", "note", "detail", "warning", "error"))
            self.assertEqual("text" in line, line["kind"] != "progress")
        return lines

    def test_every_line_is_json(self):

        def said(*arguments):
            result = self.bake(*arguments)
            return result.returncode, self.lines(result.stderr.decode())

        self.write("open.obj", box(1, 1, 1).replace("f 1 3 4 2\n", "") + "v 0 0 nan\nmtllib no.mtl\n")
        code, lines = said("open.obj", "-o", "out.kelp", "--resolution", "20", "--progress", "json")
        self.assertEqual(code, 0)
        self.assertEqual({line["kind"] for line in lines}, {"progress", "note", "detail", "warning"})
        self.assertTrue(
            any(line["text"].startswith("wrote out.kelp: ") for line in lines if line["kind"] == "note"),
            lines)
        self.write("bad.obj", "f 1 2 3\n")
        for code, arguments in ((3, ["bad.obj", "-o", "x.kelp"]),
                                (1, ["1.obj", "-o", "x.kelp", "--nonsense"]),
                                (1, ["1.obj"]),
                                (2, ["no\n.obj", "-o", "x.kelp"]),
                                (1, ["1.obj", "-o", "x.kelp", "--up", "q"])):
            for style in (["--progress", "json"], ["--progress=json"]):
                got, lines = said(*arguments, *style)
                self.assertEqual((got, lines[-1]["kind"], lines[-1]["exit"]), (code, "error", code), lines)

    def test_they_follow_the_schema(self):
        try:
            import jsonschema
        except ImportError:
            self.skipTest("Python's jsonschema is absent: apt install python3-jsonschema")
        with open(os.path.join(os.path.dirname(os.path.abspath(__file__)),
                               "../../tools/kelp-bake/kelp-bake-progress.schema.json")) as file:
            schema = json.load(file)
        jsonschema.Draft202012Validator.check_schema(schema)
        self.write("bad.obj", "f 1 2 3\n")
        for arguments in (["3.obj", "-o", "3.kelp"], ["bad.obj", "-o", "bad.kelp"]):
            for line in self.lines(self.bake(*arguments, "--progress", "json").stderr.decode()):
                jsonschema.Draft202012Validator(schema).validate(line)
                line.pop("done" if line["kind"] == "progress" else "text", None)
                self.assertFalse(jsonschema.Draft202012Validator(schema).is_valid(line))

    def test_lines_of_json(self):
        steps = lambda text: [line for line in self.lines(text) if line["kind"] == "progress"]
        done = {}
        for step in steps(self.passes("1.obj", "-o", "out.kelp", "--resolution", "60", "--progress", "json")):
            self.assertLessEqual(set(step), {"kind", "stage", "done", "seconds", "seconds_left"})
            self.assertGreaterEqual(step["done"], done.get(step["stage"], 0))
            done[step["stage"]] = step["done"]
        self.assertLessEqual({"import", "voxelize", "palette", "levels", "write"}, set(done))
        self.assertEqual(done["write"], 1)

    def interrupt(self, arguments, signals=(signal.SIGINT, signal.SIGTERM, signal.SIGHUP)):
        """At any moment of a bake: 130, the old output and nothing else; or all done. Returns how many were
        cut short."""
        self.write("out.kelp", b"the pack that was there")
        before = sorted(os.listdir(self.folder))
        heard = lambda: [signal.signal(each, signal.SIG_DFL) for each in signals]
        start = time.monotonic()
        self.assertEqual(self.bake(*arguments, "-o", "whole.kelp").returncode, 0)
        duration = time.monotonic() - start
        whole = self.read("whole.kelp")
        os.remove(self.path("whole.kelp"))
        chance = random.Random(11)
        cut = 0
        for turn in range(TRIES):
            process = subprocess.Popen([KELP_BAKE, *arguments, "-o", "out.kelp", "--progress", "json"],
                                       cwd=self.folder, stderr=subprocess.PIPE, preexec_fn=heard)
            process.stderr.readline()  # it listens
            time.sleep(chance.uniform(0, 1.1 * duration))
            process.send_signal(chance.choice(signals))
            rest = process.communicate(timeout=120)[1]
            self.assertIn(process.returncode, (0, 130), rest)
            if process.returncode == 130:
                self.assertEqual(
                    json.loads(rest.splitlines()[-1]), {"kind": "error", "exit": 130, "text": "interrupted"})
                self.assertEqual(self.read("out.kelp"), b"the pack that was there")
                cut += 1
            else:
                self.assertEqual(self.read("out.kelp"), whole)
                self.write("out.kelp", b"the pack that was there")
            self.assertEqual(sorted(os.listdir(self.folder)), before)
        return cut

    def test_interrupted_at_any_moment(self):
        self.write("lump.obj", lump(40))
        self.assertGreater(
            self.interrupt(["lump.obj", "--resolution", "60" if SANITIZED else "150"]), TRIES // 4)


if __name__ == "__main__":
    unittest.main()
