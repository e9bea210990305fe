#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""kelp-bake --config and --print-config as a shell sees them.

Usage: kelp_bake_config_test.py KELP_BAKE [unittest options]"""
import json
import os
import re
import tomllib
import unittest

from kelp_bake_case import Case, box

# Every option of --print-config, with a value that is not the default and agrees with the others.
GIVEN = [
    ("resolution", 24), ("rig", "r/own.rig.json"), ("axis", "-x"), ("bend", "sweep"), ("up", "+z"),
    ("unit", "mm"), ("pad", 2), ("scene", "1"), ("fill", "solid"), ("parts", "nodes"),
    ("at", "Wal\"k\\\\#:0.3"), ("frame", 3),
    ("palette", "r/colors.gpl"), ("grid", "den sity"), ("volume", "fog"), ("isovalue", -0.25),
    ("color-grid", "Cd"), ("heat-grid", "none"), ("density", 0.5), ("ramp", "r/fire.gpl"), ("levels", 2),
    ("no-distance", True), ("effort", "best"), ("threads", 1), ("max-memory", "1.5 GiB"),
    ("max-import-time", 60), ("progress", "none"), ("cache", "r/cache"),
    ("cache-size", "1G"), ("report", "out.json"), ("write-deps", True),
    ("deps-phony", True), ("deps-target", "a b"), ("deps-file", "x.d")]


class Configurations(Case):
    def printed(self, *arguments):
        result = self.bake("--print-config", *arguments)
        self.assertEqual((result.returncode, result.stderr), (0, b""))
        return result.stdout.decode()

    def wrong(self, content, *says, code=3):
        self.write("c.toml", content)
        self.fails(code, "--config", "c.toml", "1.obj", "-o", "x.kelp", says=says)

    def test_the_reference_changes_nothing(self):
        reference = self.printed()
        self.assertEqual(tomllib.loads(reference), {})
        self.write("c.toml", reference)
        self.write("rod.obj", box(64, 1, 1))  # of few voxels at any resolution
        self.passes("rod.obj", "-o", "with.kelp", "--config", "c.toml")
        self.passes("rod.obj", "-o", "without.kelp")
        self.assertEqual(self.read("with.kelp"), self.read("without.kelp"))
        self.assertEqual(self.printed("--config", "c.toml"), reference)

    def test_the_reference_names_every_option(self):
        shown = tomllib.loads(re.sub(r"(?m)^#([a-z-]+ = )", r"\1", self.printed()))
        self.assertEqual(set(shown) - {"voxel-size", "keep-materials"}, {name for name, _ in GIVEN})
        help_text = self.bake("--help").stdout.decode()
        of_the_program = {
            "help", "version", "output", "manifest", "shard", "plan", "force", "config", "print-config"}
        options = help_text[help_text.index("Options:"):help_text.index("Examples:")]
        self.assertEqual(set(re.findall(r"--([a-z-]+)", options)) & set(shown), set(shown))
        self.assertLessEqual(
            set(re.findall(r"(?m)^  (?:-.,)?--([a-z-]+)", help_text)), set(shown) | of_the_program)
        # What stands there as a default is one.
        self.write("rod.obj", box(64, 1, 1))
        self.passes("rod.obj", "-o", "without.kelp")
        for line in re.findall(r"(?m)(?<!# For example:\n)^#([a-z-]+ = .*)$", self.printed()):
            self.write("c.toml", line)
            self.passes("rod.obj", "-o", "with.kelp", "--config", "c.toml")
            self.assertEqual(self.read("with.kelp"), self.read("without.kelp"), line)

    def test_what_is_given_comes_back(self):
        arguments = []
        for name, value in GIVEN:
            arguments += ["--" + name] + ([] if value is True else [str(value)])
        reference = self.printed(*arguments)
        read = tomllib.loads(reference)
        for name in ("rig", "palette", "ramp", "cache", "report", "deps-file"):
            read[name] = os.path.relpath(read[name], os.path.realpath(self.folder))
        self.assertEqual(read, dict(GIVEN))
        self.write("sub/c.toml", reference)
        self.assertEqual(self.printed("--config", "sub/c.toml"), reference)
        self.assertEqual(tomllib.loads(self.printed("--voxel-size", ".5", "--keep-materials")),
                         {"voxel-size": 0.5, "keep-materials": True})

    def test_the_order_of_precedence(self):
        self.write("sub/c.toml",
                   'resolution = 8  # coarse\r\nrig = "r.rig.json"\n\n  up=\'+z\'\nreport = "report.json"')
        self.write("sub/r.rig.json", {"kelp": 1})
        self.write(
            "m.json", {"defaults": {"up": "+x"}, "assets": ["1.obj", {"input": "2.obj", "voxel-size": 0.5}]})
        self.passes("--config", "sub/c.toml", "--manifest", "m.json", "--rig", "none")
        self.assertEqual(json.loads(self.read("sub/report.json"))["schema"], "kelp-bake-batch/1")
        for name, options in (("1", ["--resolution", "8"]), ("2", ["--voxel-size", "0.5"])):
            self.passes(name + ".obj", "-o", "single.kelp", "--up", "+x", "--rig", "none", *options)
            self.assertEqual(self.read("single.kelp"), self.read(name + ".kelp"))
        self.passes("--config", "sub/c.toml", "1.obj", "-o", "x.kelp", "--voxel-size", "0.1", "-MF", "x.d")
        self.passes(
            "1.obj", "-o", "single.kelp", "--up", "+z", "--rig", "sub/r.rig.json", "--voxel-size", "0.1")
        self.assertEqual(self.read("single.kelp"), self.read("x.kelp"))
        self.assertIn("sub/c.toml", self.read("x.d").decode())
        self.assertIn("sub/r.rig.json", self.read("x.d").decode())

    def test_faults_have_line_and_column(self):
        for content, *says in (
            ("resolution = 8\n\n  resolutoin = 3\n", "c.toml:3:3: ", "resolutoin"),
            ("resolution = many", "c.toml:1:14: ", "quotes"),
            ("resolution = inf", "c.toml:1:14: ", "quotes"),
            ('resolution = "8"', "c.toml:1:14: ", "give a number"),
            ("resolution = 9999", "c.toml:1:14: ", "8192"),
            ("up = +z", "c.toml:1:6: ", "quotes"),
            ("up = 3", "c.toml:1:6: ", "give a text"),
            ('up = ""', "c.toml:1:6: ", "empty"),
            ('up = "\u00fc', "c.toml:1:8: ", "quote"),
            ('up = "+z" "+x"', "c.toml:1:11: "),
            ('grid = "\\n"', "c.toml:1:10: ", "backslash"),
            ('grid = "\t"', "c.toml:1:9: ", "control"),
            ("keep-materials = 1", "c.toml:1:18: ", "true or false"),
            ("pad = 1\npad = 1", "c.toml:2:1: ", "line 1"),
            ("resolution = 8\nvoxel-size = 1", "c.toml:2:14: ", "excludes"),
            ("[table]", "c.toml:1:1: ", "tables"),
            ("pad 3", "c.toml:1:5: ", "="),
            ("pad =", "c.toml:1:6: "),
            ("= 3", "c.toml:1:1: "),
            ('input = "1.obj"', "c.toml:1:1: "),
            (b"\xff\xfe\0", "c.toml:1:1:"),
            (" " * 17000000, "16 MiB"),
        ):
            self.wrong(content, *says)
        # All of them at once.
        self.wrong('up = 3\nresolution = "8"\n[table]\n\npad =', "c.toml:1:6: ", "c.toml:2:14: ",
                   "c.toml:3:1: ", "c.toml:5:6: ", "4 faults")
        self.wrong("resolution = 9999\nup = 'q'\npad = -1\nunit = 'ell'", "c.toml:1:14: ", "c.toml:2:6: ",
                   "c.toml:3:7: ", "c.toml:4:8: ", "4 faults")
        self.fails(2, "--config", "absent.toml", "1.obj", "-o", "x.kelp", says=["absent.toml"])
        self.fails(2, "--config", ".", "1.obj", "-o", "x.kelp", says=["folder"])
        self.fails(1, "--config", "", "1.obj", "-o", "x.kelp", says=["--config"])
        self.fails(1, "--print-config", "--plan", says=["--plan"])
        self.fails(1, "--print-config", "--up", "q", says=["--up q"])
        self.write("c.toml", "")
        self.fails(1, "1.obj", "-o", "c.toml", "--config", "c.toml", says=["c.toml", "would overwrite"])
        self.write("c.toml", 'deps-file = "x.d"')
        self.write("m.json", {"assets": ["1.obj"]})
        self.fails(1, "--manifest", "m.json", "--config", "c.toml", says=["-MF"])


if __name__ == "__main__":
    unittest.main()
