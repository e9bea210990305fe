# SPDX-License-Identifier: MIT
"""Usage: check_sdl_c.py PROGRAM PROGRAM_WITH_ADDRESS_SANITIZER PACK FOLDER_OF_SAMPLES

Runs samples/sdl_c: its picture, a click, its errors, and that it leaks nothing of its own or of kelp's."""

import os
import subprocess
import sys
import tempfile

import check_picture
import x11_input
from check_sdl import SIZE, is_red

# Memory that a library below SDL keeps until the end.
SUPPRESSED = "leak:libdbus\n"


def check_leaks(program, pack, folder):
    suppressions, picture = os.path.join(folder, "leaks.supp"), os.path.join(folder, "picture.ppm")
    with open(suppressions, "w", encoding="utf-8") as file:
        file.write(SUPPRESSED)
    options = {"ASAN_OPTIONS": "detect_leaks=1:exitcode=99",
               "LSAN_OPTIONS": "print_suppressions=0:suppressions=" + suppressions}
    done = subprocess.run([program, pack, "--frames", "2", picture], env={**os.environ, **options},
                          timeout=240, capture_output=True, text=True)
    assert done.returncode == 0, "%d: %s" % (done.returncode, done.stderr)
    width, height, pixels = check_picture.read_ppm(picture)
    assert (width, height) == SIZE
    assert check_picture.share(pixels, check_picture.is_olive) > 0.05, "the plants are missing"
    assert check_picture.share(pixels, is_red) < 0.0002, "something is red before it is clicked"


def check_click(program, pack):
    screen = x11_input.Screen()
    process = subprocess.Popen([program, pack])
    try:
        screen.find(*SIZE)
        # the stem of the plant to the left in front
        screen.click_until_red(lambda pixels: (160, 470), SIZE, is_red, 0.002)
        screen.close()
        assert process.wait(timeout=60) == 0
    finally:
        process.kill()


def main(program, with_sanitizer, pack, samples):
    with tempfile.TemporaryDirectory() as folder:
        check_leaks(with_sanitizer, pack, folder)
        try:
            check_click(program, pack)
        except x11_input.Absent as absent:
            print("SKIPPED: " + str(absent))
        absent = os.path.join(folder, "absent.kelp")
        check_picture.expect([program, absent, "--frames", "1"], 2, absent)
        check_picture.expect([program, samples + "/README.md", "--frames", "1"], 3, "README.md")
        check_picture.expect([program, pack, "--frames", "none"], 1, "usage")


if __name__ == "__main__":
    main(*sys.argv[1:])
