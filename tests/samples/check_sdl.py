# SPDX-License-Identifier: MIT
"""Usage: check_sdl.py PROGRAM KELP_BAKE MODEL PACK

Runs samples/sdl on a pack with a socket: its picture, a click, packs that take its place while it runs, good
and bad, a pack without the socket."""

import os
import re
import shutil
import struct
import subprocess
import sys
import tempfile
import time

import check_picture
import x11_input

SIZE = (960, 720)


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

    def text(self):
        with open(self.log, encoding="utf-8") as file:
            text = file.read()
        assert self.process.poll() is None, "it ended with %s: %s" % (self.process.returncode, text)
        return text

    def wait_for_plants(self, screen, seconds=60):
        """The first picture that shows them."""
        until = time.monotonic() + seconds
        while check_picture.share(pixels := screen.picture(*SIZE), check_picture.is_olive) < 0.05:
            assert time.monotonic() < until, "it shows no plants: " + self.text()
            time.sleep(0.1)
        return pixels

    def stop(self):
        self.process.kill()
        self.process.wait()


def check_encoded(pixels):
    """View::output is for the screen: where nothing encodes, linear colors are too dark."""
    plants = sorted(max(pixel) for pixel in pixels if check_picture.is_olive(*pixel))
    assert plants[len(plants) // 2] > 110, "the plants are too dark: %d" % plants[len(plants) // 2]


def check_click(running, screen):
    """Red plants, and small ones at the tips, where the mouse was."""
    before = running.wait_for_plants(screen)
    assert not any(is_red(*pixel) for pixel in before), "something is red before it is clicked"
    assert check_picture.share(before, is_mint) > 0.003, "nothing hangs on the socket"
    check_encoded(before)

    def a_plant(pixels):  # well within the field; they sway
        olive = [i for i, pixel in enumerate(pixels) if check_picture.is_olive(*pixel)]
        at = olive[int(0.9 * len(olive))]
        return at % SIZE[0], at // SIZE[0]

    screen.click_until_red(a_plant, SIZE, is_red, 0.0002)


def damaged(pack, finest):
    """The pack's bytes with every byte of the bricks of all levels up to this one changed (SPEC.md, 3.2)."""
    with open(pack, "rb") as file:
        content = bytearray(file.read())
    for i in range(struct.unpack_from("<I", content, 24)[0]):
        kind, _, level, _, offset, stored = struct.unpack_from("<4sIIIQQ", content, 64 + 48 * i)
        if kind == b"BRCK" and level <= finest:
            for at in range(offset, offset + stored):
                content[at] ^= 0x55
    return bytes(content)


def put(content, used):
    """In one step, as programs that write packs do."""
    with open(used + ".new", "wb") as file:
        file.write(content)
    os.replace(used + ".new", used)


class Watch:
    """Looks at the window, and wants plants in every frame."""

    def __init__(self, running, screen):
        self.running, self.screen = running, screen

    def until(self, pattern, count=1, seconds=120):
        """Until the program has said it so often."""
        until, looks = time.monotonic() + seconds, 0
        while time.monotonic() < until:
            text = self.running.text()
            pixels = self.screen.picture(*SIZE)
            assert check_picture.share(pixels[::7], is_water) < 0.97, "a frame is blank, after\n" + text
            looks += 1
            if len(re.findall(pattern, text)) >= count and looks > 3:
                return
            time.sleep(0.1)
        raise AssertionError("it never says '%s' %d times: %s" % (pattern, count, self.running.text()))


def is_water(r, g, b):
    return abs(r - 148) < 3 and abs(g - 189) < 3 and abs(b - 199) < 3


def check_window(program, kelp_bake, model, pack, folder):
    used, other = os.path.join(folder, "used.kelp"), os.path.join(folder, "other.kelp")
    shutil.copy(pack, used)
    running = Running([program, used], os.path.join(folder, "log.txt"))
    try:
        screen = x11_input.Screen()
        screen.find(*SIZE)
        check_click(running, screen)
        watch = Watch(running, screen)
        with open(pack, "rb") as file:
            whole = file.read()
        put(whole[:-100], used)
        watch.until("shorter than its header")  # the old one stays
        put(damaged(pack, 9), used)
        watch.until("differs from its checksum")  # none of its bricks can be read: the old one stays
        assert "is shown" not in running.text()
        put(damaged(pack, 0), used)
        watch.until("is shown", 1)  # coarser voxels stand in for those that cannot be read
        put(whole, used)
        watch.until("is shown", 2)
        subprocess.run([kelp_bake, model, "-o", other, "--resolution", "40", "--rig", "none"], check=True,
                       capture_output=True)
        with open(other, "rb") as file:
            put(file.read(), used)
        watch.until("is shown", 3)
        assert "there is no socket of that name" in running.text(), running.text()
    finally:
        running.stop()


def check_without_socket(program, kelp_bake, model, folder):
    pack, rig = os.path.join(folder, "named.kelp"), os.path.join(folder, "rig.json")
    with open(rig, "w", encoding="utf-8") as file:
        file.write('{"kelp": 1, "sockets": {"foot": {"at": 0}, "middle": {"at": 0.5}}}')
    subprocess.run([kelp_bake, model, "-o", pack, "--resolution", "40", "--rig", rig], check=True,
                   capture_output=True)
    picture = os.path.join(folder, "named.ppm")
    done = subprocess.run([program, pack, "--frames", "1", picture], check=True, timeout=240,
                          capture_output=True, text=True)
    assert "foot" in done.stderr and "middle" in done.stderr, "the sockets are not listed: " + done.stderr
    pixels = check_picture.read_ppm(picture)[2]
    assert check_picture.share(pixels, check_picture.is_olive) > 0.05, "the plants are missing"
    assert not any(is_mint(*pixel) for pixel in pixels), "something hangs on a socket that is not there"


def main(program, kelp_bake, model, pack):
    with tempfile.TemporaryDirectory() as folder:
        check_without_socket(program, kelp_bake, model, folder)
        try:
            check_window(program, kelp_bake, model, pack, folder)
        except x11_input.Absent as absent:
            print("SKIPPED: " + str(absent))
        absent = os.path.join(folder, "absent.kelp")
        check_picture.expect([program, absent, "--frames", "1"], 2, absent)
        check_picture.expect([program, pack, "--frames", "none"], 1, "usage")


if __name__ == "__main__":
    main(*sys.argv[1:])
