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
        """What a terminal gets."""
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

    def test_a_bar_of_a_batch(self):
        self.write("m.json", {"defaults": {"resolution": 40}, "assets": ["1.obj", "2.obj", "3.obj"]})
        bars = self.bars(self.on_terminal("--manifest", "m.json"))
        for start in ("[1/3] ", "[3/3] "):
            self.assertTrue(any(bar.startswith(start) for bar in bars), bars)
        self.assertTrue(any(re.search(r"; \d+:\d\d left of all$", bar) for bar in bars), bars)

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
            self.assertIn(line["kind"], ("progress", "note", "detail", "warning", "error", "asset"))
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
        self.write("m.json",
                   {"defaults": {"resolution": 20},
                    "assets": ["1.obj", "open.obj", "bad.obj", {"input": "bad.obj", "output": "other.kelp"}]})
        self.write("c.toml", 'progress = "json"')
        code, lines = said("--manifest", "m.json", "--config", "c.toml")
        self.assertEqual(code, 3)
        assets = [(line["asset"], line["assets"], line["output"], line["status"], line["exit"])
                  for line in lines if line["kind"] == "asset"]
        self.assertEqual(assets, [(1, 4, "1.kelp", "baked", 0),
                                  (2, 4, "open.kelp", "baked", 0),
                                  (3, 4, "bad.kelp", "failed", 3),
                                  (4, 4, "other.kelp", "failed", 3)])
        self.assertEqual({line["asset"] for line in lines if line["kind"] == "warning"}, {2})
        for code, arguments in ((3, ["bad.obj", "-o", "x.kelp"]),
                                (1, ["1.obj", "-o", "x.kelp", "--nonsense"]),
                                (1, ["1.obj"]),
                                (2, ["no\n.obj", "-o", "x.kelp"]),
                                (2, ["--manifest", "no.json"]),
                                (1, ["1.obj", "-o", "x.kelp", "--up", "q", "--pad", "-1"])):
            for style in (["--progress", "json"], ["--progress=json"]):
                got, lines = said(*arguments, *style)
                self.assertEqual((got, lines[-1]["kind"], lines[-1]["exit"]), (code, "error", code), lines)
        self.assertEqual(lines[-1]["text"], "2 faults, and nothing was baked")

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
        self.write("m.json", {"defaults": {"resolution": 20}, "assets": ["1.obj", "2.obj", "bad.obj"]})
        for arguments in (["--manifest", "m.json"],
                          ["3.obj", "-o", "3.kelp"],
                          ["bad.obj", "-o", "bad.kelp"],
                          ["--manifest", "m.json"]):
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
        self.write(
            "m.json",
            {"defaults": {"resolution": 20}, "assets": [{"input": "1.obj", "output": 'a "b".kelp'}, "2.obj"]})
        of_batch = steps(self.passes("--manifest", "m.json", "--progress", "json"))
        self.assertEqual({(step["asset"], step["assets"], step["output"]) for step in of_batch},
                         {(1, 2, 'a "b".kelp'), (2, 2, "2.kelp")})
        self.assertTrue(all(("batch_seconds_left" in step) == (step["asset"] == 2) for step in of_batch))

    def test_the_time_left_where_sizes_are_not_known_before(self):
        """The time left comes from the assets that are done. It scales with the surface and with reading for
        assets that give a resolution, and is the mean for the others. There is no figure until an asset of
        each kind is done. It counts down while an asset is baked."""
        kinds = [("resolution", 60), ("voxel-size", 0.5), ("voxel-size", 0.25), None, ("resolution", 30)]
        assets = [{"input": "1.obj", "output": "%d.kelp" % i, **dict([kind] if kind else [])}
                  for i, kind in enumerate(kinds)]
        self.write("m.json", {"assets": assets})
        text = self.passes("--manifest", "m.json", "--progress", "json", "--report", "report.json")
        seconds = [asset["seconds"] for asset in json.loads(self.read("report.json"))["assets"]]
        last = seconds[0] * (30 ** 2 + 64 ** 2) / (60 ** 2 + 64 ** 2)
        known = [None, None, last + 2 * seconds[1], last + (seconds[1] + seconds[2]) / 2, last]
        for step in (line for line in self.lines(text) if line["kind"] == "progress"):
            expected = known[step["asset"] - 1]
            if expected is None:
                self.assertNotIn("batch_seconds_left", step)
            else:
                self.assertLessEqual(step["batch_seconds_left"], expected + 1e-6)
                self.assertGreaterEqual(
                    step["batch_seconds_left"], max(expected - seconds[step["asset"] - 1], 0) - 1e-6)

    def interrupt(self, arguments, signals=(signal.SIGINT, signal.SIGTERM, signal.SIGHUP)):
        """At any moment of a bake: 130, the old output and nothing else; or all done. Returns how many were
        cut short."""
        self.write("out.kelp", b"the pack that was there")
        before = sorted(os.walk(self.folder))
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
            self.assertEqual(
                [(where, sorted(folders),
                  sorted(name for name in names if not name.endswith((".kelp-pack", ".kelp-names"))))
                 for where, folders, names in sorted(os.walk(self.folder)) if "/cache" not in where],
                [(where, sorted(folders), sorted(names)) for where, folders, names in before
                 if "/cache" not in where])
            self.assertEqual([name for where, _, names in os.walk(self.path("cache")) for name in names
                              if name.endswith(".tmp")], [])
        return cut

    def test_interrupted_at_any_moment(self):
        self.write("lump.obj", lump(40))
        self.assertGreater(
            self.interrupt(["lump.obj", "--resolution", "60" if SANITIZED else "150"]), TRIES // 4)

    def test_interrupted_with_a_cache(self):
        self.write("lump.obj", lump(20))
        os.makedirs(self.path("cache"))
        self.interrupt(["lump.obj", "--resolution", "40" if SANITIZED else "100", "--cache", "cache",
                        "--cache-size", "1"])


if __name__ == "__main__":
    unittest.main()
