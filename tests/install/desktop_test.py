#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""The desktop entry, the type of .kelp files and the icon, as the desktop's own programs take them.

Usage: desktop_test.py FOLDER PACK -- [unittest options]"""

import os
import shutil
import subprocess
import sys
import tempfile
import unittest
import xml.etree.ElementTree

from help_truth import needs

FOLDER, PACK = sys.argv[1], sys.argv[2]
del sys.argv[1:4]
ENTRY, TYPE, ICON = (os.path.join(FOLDER, name)
                     for name in ("kelp-view.desktop", "kelp.xml", "kelp-view.svg"))


def run(*command, **more):
    done = subprocess.run(command, capture_output=True, text=True, **more)
    return done.returncode, (done.stdout + done.stderr).strip()


class Desktop(unittest.TestCase):
    def test_the_entry_is_valid(self):
        self.assertEqual(run("desktop-file-validate", ENTRY), (0, ""))

    def test_names_are_the_same_everywhere(self):
        with open(ENTRY, encoding="utf-8") as file:
            entry = dict(line.strip().split("=", 1) for line in file if "=" in line)
        kind = xml.etree.ElementTree.parse(TYPE).getroot()[0]
        self.assertEqual(entry["MimeType"], kind.get("type") + ";")
        icon = kind.find("{http://www.freedesktop.org/standards/shared-mime-info}icon")
        self.assertEqual([entry["Icon"] + ".svg", icon.get("name") + ".svg"], [os.path.basename(ICON)] * 2)
        self.assertEqual(entry["Exec"], "kelp-view %f")

    def test_packs_are_known_by_name_and_by_content(self):
        with tempfile.TemporaryDirectory() as folder:
            packages = os.path.join(folder, "mime/packages")
            os.makedirs(packages)
            shutil.copy(TYPE, packages)
            path = {**os.environ, "XDG_DATA_HOME": folder, "XDG_DATA_DIRS": folder}
            code, said = run("update-mime-database", os.path.join(folder, "mime"), env=path)
            self.assertEqual((code, said), (0, ""))
            shutil.copy(PACK, os.path.join(folder, "named.kelp"))
            shutil.copy(PACK, os.path.join(folder, "nameless"))
            with open(os.path.join(folder, "other"), "wb") as file:
                file.write(b"KELPAK\r\n\x1a\n" + bytes(100))
            for name, is_pack in (("named.kelp", True), ("nameless", True), ("other", False)):
                _, said = run("gio", "info", "-a", "standard::content-type", os.path.join(folder, name),
                              env=path)
                self.assertEqual("standard::content-type: model/x-kelp" in said, is_pack, (name, said))

    def test_the_icon_is_sound(self):
        root = xml.etree.ElementTree.parse(ICON).getroot()
        self.assertEqual(root.get("viewBox"), "0 0 128 128")
        if shutil.which("rsvg-convert"):
            done = subprocess.run(["rsvg-convert", "-w", "48", ICON], capture_output=True, check=False)
            self.assertEqual((done.returncode, done.stderr), (0, b""))
            self.assertGreater(len(done.stdout), 500, "an empty picture")


if __name__ == "__main__":
    needs("desktop-file-validate", "update-mime-database", "gio")
    unittest.main()
