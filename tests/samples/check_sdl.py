# SPDX-License-Identifier: MIT
"""Usage: check_sdl.py PROGRAM KELP_BAKE MODEL PACK

Runs samples/sdl on a pack with a socket: its picture, a click, a pack that is exchanged while it runs, a pack
without the socket."""

import os
import re
import shutil
import subprocess
import sys
import tempfile
import time

import check_picture
import x11_input


def is_red(r, g, b):
    return r > 120 and r > 2 * g and r > 2 * b


def is_mint(r, g, b):
    return g > 140 and g > 1.5 * r and b > 0.4 * g


class Running:
    """The program, and what it says line by line."""

    def __init__(self, command, log):
        self.log = log
        with open(log, "wb") as file:
            self.process = subprocess.Popen(command, stderr=file)

    def said(self, pattern, seconds=60):
        until = time.monotonic() + seconds
        while time.monotonic() < until:
            with open(self.log, encoding="utf-8") as file:
                text = file.read()
            if re.search(pattern, text):
                return text
            assert self.process.poll() is None, "it ended with %s: %s" % (self.process.returncode, text)
            time.sleep(0.05)
        raise AssertionError("it never says '%s': %s" % (pattern, text))

    def stop(self):
        self.process.kill()
        self.process.wait()


def check_click(program, pack, folder):
    """Red plants, and small ones at the tips, where the mouse was."""
    plain, clicked = os.path.join(folder, "plain.ppm"), os.path.join(folder, "clicked.ppm")
    subprocess.run([program, pack, "--frames", "2", plain], check=True, timeout=240)
    width, height, before = check_picture.read_ppm(plain)
    assert (width, height) == (960, 720)
    assert check_picture.share(before, check_picture.is_olive) > 0.05, "the plants are missing"
    assert not any(is_red(*pixel) for pixel in before), "something is red before it is clicked"
    screen = x11_input.Screen()
    process = subprocess.Popen([program, pack, "--frames", "60", clicked])
    try:
        screen.find(width, height)
        olive = [i for i, pixel in enumerate(before) if check_picture.is_olive(*pixel)]
        # Well within the field, where a plant stands at every moment of its clip.
        aim = olive[int(0.9 * len(olive))]
        for _ in range(40):
            if process.poll() is not None:
                break
            screen.click(aim % width, aim // width)
            time.sleep(0.2)
        assert process.wait(timeout=240) == 0
    finally:
        process.kill()
    after = check_picture.read_ppm(clicked)[2]
    assert check_picture.share(after, is_red) > 0.0002, "a click turns nothing red"
    assert check_picture.share(after, is_mint) > 0.00005, "nothing hangs on the socket"


def check_exchange(program, kelp_bake, model, pack, folder):
    used = os.path.join(folder, "used.kelp")
    shutil.copy(pack, used)
    running = Running([program, used, "--frames", "1000000"], os.path.join(folder, "log.txt"))
    try:
        time.sleep(1)
        broken = os.path.join(folder, "broken.kelp")
        with open(pack, "rb") as whole, open(broken, "wb") as part:
            part.write(whole.read()[:-100])
        os.replace(broken, used)
        running.said("shorter than its header")  # the old one stays
        subprocess.run([kelp_bake, model, "-o", used, "--resolution", "48"], check=True,
                       capture_output=True)
        running.said("the new pack is shown")
        subprocess.run([kelp_bake, model, "-o", used, "--resolution", "40", "--rig", "none"],
                       check=True, capture_output=True)
        text = running.said("there is no socket of that name")
        assert running.process.poll() is None, text
    finally:
        running.stop()


def main(program, kelp_bake, model, pack):
    with tempfile.TemporaryDirectory() as folder:
        check_exchange(program, kelp_bake, model, pack, folder)
        try:
            check_click(program, pack, folder)
        except x11_input.Absent as absent:
            print("SKIPPED: " + str(absent))
        absent = os.path.join(folder, "absent.kelp")
        check_picture.expect([program, absent, "--frames", "1"], 2, absent)
        check_picture.expect([program, pack, "--frames", "none"], 1, "usage")


if __name__ == "__main__":
    main(*sys.argv[1:])
