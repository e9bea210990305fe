# SPDX-License-Identifier: MIT
"""Usage: check_kelp_view_rig.py KELP_VIEW KELP_BAKE KELP_DUMP MODEL.glb

Edits a rig with the mouse, saves it, and bakes what was saved. Watches a model that changes and breaks. Runs
the programs themselves, on the display that DISPLAY names."""

import json
import os
import queue
import shutil
import signal
import subprocess
import sys
import tempfile
import threading
import time

import x11_input


class View:
    """The program, and what it says line by line."""

    def __init__(self, *command):
        self.process = subprocess.Popen(command, stderr=subprocess.PIPE, text=True)
        self.lines = queue.Queue()
        self.said = []
        threading.Thread(target=self.read, daemon=True).start()

    def read(self):
        for line in self.process.stderr:
            self.lines.put(line.rstrip())
        self.lines.put(None)

    def heard(self, word, seconds):
        """True if it prints this text in that time."""
        end = time.monotonic() + seconds
        while True:
            try:
                line = self.lines.get(timeout=max(end - time.monotonic(), 0.01))
            except queue.Empty:
                return False
            assert line is not None, "it ended, and never said %r:\n%s" % (word, "\n".join(self.said))
            self.said.append(line)
            if word in line:
                return True

    def expect(self, word, seconds=60):
        assert self.heard(word,
                          seconds), "no %r within %d s; it said:\n%s" % (word, seconds, "\n".join(self.said))

    def end(self):
        self.process.send_signal(signal.SIGTERM)
        self.process.wait(timeout=120)


def rig_of(dump, pack):
    return json.loads(subprocess.run([dump, "rig", pack], check=True, capture_output=True, text=True).stdout)


def replace(path, text):
    with open(path + ".new", "w") as file:
        file.write(text)
    os.rename(path + ".new", path)


# Slender, so that it can be swept.
POST = """v 0 0 0\nv .5 0 0\nv .5 3 0\nv 0 3 0\nv 0 0 .3\nv .5 0 .3\nv .5 3 .3\nv 0 3 .3
f 1 4 3 2\nf 5 6 7 8\nf 1 2 6 5\nf 4 8 7 3\nf 2 3 7 6\nf 1 5 8 4\n"""
POST_RIG = """{"kelp": 1, "knots": [{"at": 0, "tangent": [0, 1, 0]}, {"at": 0.3}, {"at": 0.65}, {"at": 1}],
  "clips": {"sway": {"waves": [{"knot": 3, "offset": [0.05, 0, 0], "period": 4}]}}}"""


def check_edit(screen, view, bake, dump, folder):
    pack, rig = os.path.join(folder, "post.kelp"), os.path.join(folder, "post.rig.json")
    model, given = os.path.join(folder, "post.obj"), os.path.join(folder, "given.json")
    replace(model, POST)
    replace(given, POST_RIG)
    subprocess.run([bake, model, "-o", pack, "--rig", given, "--resolution", "32", "--progress", "none"],
                   check=True, capture_output=True)
    before = rig_of(dump, pack)
    # a slow machine may draw its first frames late, and what was saved takes a line of the panel
    for pause in (1.5, 5, 15, 45):
        program = View(view, "--edit", pack)
        screen.find(1280, 800)
        screen.settle(pause)
        screen.click(936, 95)  # bend
        screen.click(936, 136)  # from shear to sweep
        screen.drag(1040, 95, 1100, 95)  # roll
        screen.drag(933, 249, 983, 249)  # knot 1, offset x
        screen.settle(1)
        screen.key("Control_L", "s")
        program.expect("saved " + rig)
        with open(rig) as file:
            saved = json.load(file)
        moved = saved["knots"][1].get("offset", [0, 0, 0])
        if moved[0] > 0.02 and saved.get("roll", 0) > 5:
            break
        program.end()
        os.remove(rig)
    assert moved[0] > 0.02 and moved[1:] == [0, 0], "50 pixels moved knot 1 by %s" % moved
    assert before["bend"] == "shear" and saved["bend"] == "sweep" and 5 < saved["roll"] < 60, saved

    # Baked, it is what was saved.
    subprocess.run([bake, model, "-o", pack, "--resolution", "32", "--rig", rig, "--progress", "none"],
                   check=True, capture_output=True)
    after = rig_of(dump, pack)
    assert len(after["knots"]) == len(saved["knots"])
    for have, want, old in zip(after["knots"], saved["knots"], before["knots"]):
        for key in ("offset", "tangent"):
            for a, b in zip(have.get(key, [0, 0, 0]), want.get(key, have.get(key, [0, 0, 0]))):
                assert abs(a - b) < 1e-5, "%s: %s is %s" % (key, want, have)
        assert abs(have["at"] - old["at"]) < 1e-6
    assert after["clips"] == before["clips"], "the clips were not touched"
    assert after["bend"] == "sweep" and abs(after["roll"] - saved["roll"]) < 1e-4, after

    # Undone, it is no longer what was saved: closing asks, and stays when told to. A slow machine may not
    # have drawn the question yet.
    screen.key("Control_L", "z")
    screen.close()
    for _ in range(3):
        screen.settle(0.7)
        assert program.process.poll() is None, "closed without a question"
        screen.key("Escape")
    # A place that cannot be written is said, and nothing is lost.
    for _ in range(6):
        screen.click(1075, 72)
        screen.settle(1)
        screen.key("slash")
        screen.key("Return")
        screen.settle(1)
        screen.click(1067, 49)
        if program.heard(" be written", 4):
            break
    assert " be written" in program.said[-1], program.said
    assert program.process.poll() is None
    program.end()


def check_parts(screen, view, dump, model, folder):
    """Saved by the key, the rig stands beside the model by its part's name, and is baked."""
    source, pack, rig = (os.path.join(folder, "reed" + suffix) for suffix in (".glb", ".kelp", ".rig.json"))
    shutil.copy(model, source)
    program = View(view, "--edit", "--watch", source, "--resolution", "24", "--parts", "nodes")
    program.expect("kelp-view: baked " + pack)
    screen.find(1280, 800)
    for pause in (1.5, 5, 15, 45):
        screen.settle(pause)
        screen.key("Control_L", "s")
        if program.heard("saved " + rig, 5):
            break
    program.expect("kelp-view: shows " + pack)
    before = rig_of(dump, pack)
    with open(rig) as file:
        saved = json.load(file)
    assert list(saved) == ["kelp", "parts"] and saved["parts"].keys() <= before["parts"].keys(), saved
    saved["parts"][next(iter(saved["parts"]))]["sockets"] = {"mine": {"at": 0.5}}
    replace(rig, json.dumps(saved))
    program.expect("kelp-view: shows " + pack)
    assert any("mine" in part.get("sockets", {}) for part in rig_of(dump, pack)["parts"].values())
    program.end()


def check_watch(view, dump, model, folder):
    source, pack, rig = (os.path.join(folder, "reed" + suffix) for suffix in (".glb", ".kelp", ".rig.json"))
    shutil.copy(model, source)
    program = View(view, "--watch", source, "--resolution", "24", "--axis", "+y")
    program.expect("kelp-view: baked " + pack)
    replace(rig, '{"kelp": 1, "knots": [{"at": 0}, {"at": 0.5, "offset": [0.1, 0, 0]}, {"at": 1}]}')
    program.expect("kelp-view: shows " + pack)
    assert len(rig_of(dump, pack)["knots"]) == 3
    replace(rig, '{"kelp": 1, "knuts": []}')
    program.expect("not baked")
    assert "knuts" in program.said[-1] and "knots" in program.said[-1], program.said[-1]
    assert len(rig_of(dump, pack)["knots"]) == 3, "the old pack stays"
    replace(rig, '{"kelp": 1}')
    program.expect("kelp-view: shows " + pack)

    # The pack goes, comes back damaged, and comes back sound.
    with open(pack, "rb") as file:
        sound = file.read()
    os.remove(pack)
    time.sleep(1)
    with open(pack, "wb") as file:
        file.write(sound[:-50])
    program.expect("the picture shows the last version")
    with open(pack + ".new", "wb") as file:
        file.write(sound)
    os.rename(pack + ".new", pack)
    program.expect("kelp-view: shows " + pack)
    os.remove(source)
    program.expect("not baked")
    assert "reed.glb" in program.said[-1], program.said[-1]
    assert program.process.poll() is None
    program.end()
    assert sorted(os.listdir(folder)) == ["reed.kelp", "reed.rig.json"], os.listdir(folder)

    # With --frames a bake that fails ends the program, with the baker's exit code.
    absent = subprocess.run([view, "--frames", "1", "--watch", source], capture_output=True, text=True,
                            timeout=60)
    assert absent.returncode == 2 and "reed.glb" in absent.stderr, absent
    shutil.copy(model, source)
    picture = os.path.join(folder, "picture.ppm")
    subprocess.run([view, "--frames", "1", picture, "--watch", source, "--resolution", "24", "--rig",
                    "sway"], check=True, timeout=120, capture_output=True)
    assert os.path.getsize(picture) > 1280 * 800 * 3


def main(view, bake, dump, model):
    with tempfile.TemporaryDirectory() as folder:
        check_watch(view, dump, model, folder)
    with tempfile.TemporaryDirectory() as folder:
        try:
            screen = x11_input.Screen()
        except x11_input.Absent as absent:
            print("SKIPPED: the mouse: %s" % absent)
            return
        check_edit(screen, view, bake, dump, folder)
    with tempfile.TemporaryDirectory() as folder:
        check_parts(screen, view, dump, model, folder)


if __name__ == "__main__":
    main(*sys.argv[1:])
