#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Completions of real shells: the options and fixed values that --help shows, nothing else, and files that
the programs read.

Usage: completions_test.py SHELL FOLDER PROGRAM... -- [unittest options]
FOLDER: manual/ of a build, or the prefix of an installation."""

import os
import re
import subprocess
import sys
import tempfile
import unittest

import shells
from help_truth import needs, place, truths

END = sys.argv.index("--")
SHELL, FOLDER, PROGRAMS = sys.argv[1], sys.argv[2], [os.path.abspath(path) for path in sys.argv[3:END]]
del sys.argv[1:END + 1]
PATHS = {os.path.basename(path): path for path in PROGRAMS}
SCRIPTS = {program: os.path.abspath(place(FOLDER, SHELL, program)) for program in PATHS}
TETRAHEDRON = "v 0 0 0\nv 1 0 0\nv 0 2 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 1 4 3\n"
MODELS = {"glb", "gltf", "vrm", "obj", "ply", "stl", "off", "drc", "vdb", "nvdb", "vox", "binvox", "raw"}
OTHERS = {"kelp", "png", "json", "gpl", "txt", "ppm", "d"}


def run(program, *words, **more):
    return subprocess.run([PATHS[program], *words], capture_output=True, text=True, **more)


class Completions(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.holder = tempfile.TemporaryDirectory()
        cls.folder, setup = os.path.join(cls.holder.name, "work"), os.path.join(cls.holder.name, "setup")
        os.makedirs(os.path.join(cls.folder, "sub"))
        os.mkdir(setup)
        for kind in MODELS | OTHERS:
            with open(os.path.join(cls.folder, "a." + kind), "w", encoding="utf-8") as file:
                file.write(TETRAHEDRON if kind == "obj" else "")
        shell = {"bash": shells.Bash, "fish": shells.Fish, "zsh": shells.Zsh}[SHELL]
        cls.shell = shell(SCRIPTS, cls.folder, *([setup] if SHELL == "zsh" else []))
        cls.truths = truths(PROGRAMS)
        cls.all_choices = {word for truth in cls.truths for words in truth.choices.values() for word in words}

    @classmethod
    def tearDownClass(cls):
        if SHELL == "zsh":
            cls.shell.close()
        cls.holder.cleanup()

    def words(self, *line):
        return set(self.shell.ask(*line))

    def kinds(self, *line):
        """The extensions of the files that are offered. The folder must be, too."""
        words = self.words(*line)
        self.assertIn("sub", {word.rstrip("/") for word in words}, line)
        others = {word for word in words if not re.match(r"a\.|sub/?$", word)}
        self.assertEqual(others - self.all_choices, set())
        return {word[2:] for word in words if word.startswith("a.")}

    def test_options(self):
        for truth in self.truths:
            own = [*truth.words, "-"]
            self.assertEqual(self.words(*own), truth.options, own)
            for option in sorted(truth.options)[-2:]:
                self.assertIn(option, self.words(*truth.words, option[:-1]))

    def test_commands(self):
        for truth in self.truths:
            if truth.commands:
                self.assertEqual(self.words(truth.program, ""), set(truth.commands))

    def test_descriptions(self):
        if SHELL == "bash":
            self.skipTest("bash shows none")
        for truth in self.truths:
            offered = self.shell.ask(*truth.words, "-")
            for flags, about in truth.descriptions.items():
                begin = "".join(about.split())[:20]
                for option in flags.split(","):
                    # zsh shows one text for all options that have it, beside the first.
                    texts = [offered[option]] if SHELL == "fish" else self.shell.texts
                    self.assertTrue(any(begin in "".join(text.split()) for text in texts), (option, about))

    def test_fixed_values(self):
        count = 0
        for truth in self.truths:
            for option, values in truth.choices.items():
                line = [*truth.words, option, ""]
                offered = {word for word in self.words(*line) if not re.match(r"a\.|sub", word)}
                self.assertEqual(offered, values, line)
                if truth.program != "kelp-view":
                    self.assertEqual({word for word in self.words(*truth.words, option + "=")
                                      if not re.match(r"a\.|sub", word)}, values, line)
                count += 1
        self.assertGreater(count, 10 if "kelp-bake" in PATHS else 3)

    def test_files(self):
        if "kelp-bake" in PATHS:
            self.assertEqual(self.kinds("kelp-bake", ""), MODELS)
            self.assertEqual(self.kinds("kelp-bake", "-o", ""), {"kelp"})
            self.assertEqual(self.kinds("kelp-bake", "--rig", ""), {"json"})
        if "kelp-dump" in PATHS:
            self.assertEqual(self.kinds("kelp-dump", "info", ""), {"kelp"})
            self.assertEqual(self.kinds("kelp-dump", "extract", "a.kelp", "--proxy", ""),
                             {"obj", "ply", "stl", "off"})
            self.assertEqual(self.kinds("kelp-dump", "slice", "-o", ""), {"png"})
        if "kelp-render" in PATHS:
            self.assertEqual(self.kinds("kelp-render", "a.kelp", "--and", ""), {"kelp"})
            self.assertEqual(self.kinds("kelp-render", "-o", ""), {"png"})
        if "kelp-view" in PATHS:
            self.assertEqual(self.kinds("kelp-view", ""), {"kelp"})
            self.assertEqual(self.kinds("kelp-view", "--watch", ""), MODELS | {"kelp"})

    def test_models_are_those_that_kelp_bake_reads(self):
        """An empty file of a kind that it knows is invalid, and one that it does not know is unsupported."""
        if "kelp-bake" not in PATHS:
            self.skipTest("no kelp-bake")
        offered = self.kinds("kelp-bake", "")
        for kind in MODELS | OTHERS:
            done = run("kelp-bake", os.path.join(self.folder, "a." + kind), "-o",
                       os.path.join(self.folder, "sub/out.kelp"), "--resolution", "4")
            self.assertEqual(done.returncode != 5, kind in offered, (kind, done.stderr))

    def test_view_completes_the_options_of_kelp_bake(self):
        if "kelp-bake" not in PATHS or "kelp-view" not in PATHS:
            self.skipTest("no kelp-bake or no kelp-view")
        offered = self.words("kelp-view", "--edit", "--watch", "a.obj", "-")
        truth = next(truth for truth in self.truths if truth.program == "kelp-bake")
        self.assertLessEqual(offered, truth.options)
        without_display = {name: value for name, value in os.environ.items() if "DISPLAY" not in name}
        for option in truth.options - {"-h"}:
            done = run("kelp-view", "--watch", "a.obj", option, env=without_display, cwd=self.folder)
            self.assertEqual("kelp-view sets this itself" not in done.stderr, option in offered,
                             (option, done.stderr))
        self.assertEqual(self.words("kelp-view", "--watch", "a.obj", "--effort", ""), {"fast", "best"})
        self.assertEqual({word for word in self.words("kelp-view", "--watch", "a.kelp", "-")
                          if word.startswith("-")}, set())

    @unittest.skipUnless(SHELL == "bash", "zsh and fish are asked as their users ask them")
    def test_a_user_of_bash(self):
        self.assertEqual(self.shell.types("kelp-dump ver"), "kelp-dump verify")
        self.assertEqual(self.shell.types("kelp-dump info --format j"), "kelp-dump info --format json")
        self.assertEqual(self.shell.types("kelp-dump info --format=j"), "kelp-dump info --format=json")
        self.assertEqual(self.shell.types("kelp-dump info a."), "kelp-dump info a.kelp")


if __name__ == "__main__":
    needs(SHELL)
    unittest.main()
