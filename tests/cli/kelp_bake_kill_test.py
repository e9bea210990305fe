#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""kill -9 at random moments of a bake, of the program alone or with its child. The output is the old pack or
the new one, whole, and nothing else looks like a result. 30 times; KELP_ALL_TESTS=1 makes it 1000.

Usage: kelp_bake_kill_test.py KELP_BAKE KELP_DUMP"""
import os
import random
import shutil
import signal
import subprocess
import sys
import tempfile
import time

KELP_BAKE, KELP_DUMP = (os.path.abspath(path) for path in sys.argv[1:3])
KILLS = 1000 if os.environ.get("KELP_ALL_TESTS") else 30


def block(n):
    """A box of n x 2n x n voxels with a pillar on it, as OBJ."""
    corners, faces = [], []
    for low, high in (((0, 0, 0), (n, 2 * n, n)), ((n // 3, 2 * n, n // 3), (n // 2, 3 * n, n // 2))):
        first = len(corners)
        for i in range(8):
            corners.append([high[axis] if i >> axis & 1 else low[axis] for axis in range(3)])
        quads = ((0, 2, 3, 1), (4, 5, 7, 6), (0, 1, 5, 4), (2, 6, 7, 3), (0, 4, 6, 2), (1, 3, 7, 5))
        faces += [[first + i for i in quad] for quad in quads]
    lines = [f"v {x} {y} {z}\n" for x, y, z in corners]
    lines += ["f " + " ".join(str(i + 1) for i in face) + "\n" for face in faces]
    return "".join(lines)


def bake(source, output):
    return subprocess.Popen(
        [KELP_BAKE, source, "-o", output, "--resolution", "96", "--threads", "1", "--progress", "none"],
        stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, start_new_session=True)


def ended(run):
    """Its exit code. The program's standard output has an end once its child is gone, too."""
    with run.stdout:
        run.stdout.read()
    return run.wait()


def read(path):
    with open(path, "rb") as file:
        return file.read()


def main():
    folder = tempfile.mkdtemp(prefix="kelp_kill_")
    try:
        sources, packs, seconds = [], [], 0.0
        for i in range(2):
            sources.append(os.path.join(folder, "model.obj" if i == 0 else "other.obj"))
            with open(sources[i], "w", encoding="utf-8") as file:
                file.write(block(12 + 9 * i))
            whole = os.path.join(folder, f"whole{i}.kelp")
            start = time.monotonic()
            if ended(bake(sources[i], whole)) != 0:
                sys.exit("kelp-bake fails")
            seconds = max(seconds, time.monotonic() - start)
            packs.append(read(whole))
            os.remove(whole)
        assert packs[0] != packs[1]

        output = os.path.join(folder, "model.kelp")
        with open(output, "wb") as file:
            file.write(packs[0])
        chance = random.Random(7)
        killed = finished = replaced = left = 0
        now = 0
        while killed < KILLS:
            run = bake(sources[1 - now], output)
            # Anywhere, and every second time near the end, where the pack is written and moved into place.
            time.sleep(chance.uniform(0.7 if killed % 2 else 0.0, 1.1) * seconds)
            if killed % 3:
                run.send_signal(signal.SIGKILL)
            else:
                os.killpg(run.pid, signal.SIGKILL)
            code = ended(run)
            killed += code == -signal.SIGKILL
            finished += code == 0
            found = read(output)
            if found == packs[1 - now]:
                replaced += 1
                now = 1 - now
            elif found != packs[now]:
                sys.exit(f"after kill {killed}: {output} is neither the old pack nor the new one: "
                         f"{len(found)} bytes")
            elif code == 0:
                sys.exit("a bake that came to its end has left the old pack")
            for name in os.listdir(folder):
                if name in ("model.kelp", "model.obj", "other.obj"):
                    continue
                if not (name.startswith(".") and name.endswith(".tmp")):
                    sys.exit(f"{name} could be taken for a result")
                left += 1
                os.remove(os.path.join(folder, name))
            # Fast machines and slow moments: keep the kills inside the bake.
            if code == 0:
                seconds *= 0.98
            elif found == packs[now] and killed % 16 == 0:
                seconds *= 1.02
        print(f"{killed} bakes killed, {finished} finished first: {replaced} new packs, "
              f"{killed + finished - replaced} old ones, {left} temporaries left, 0 damaged")
        if KILLS >= 1000 and left == 0:
            sys.exit("no kill fell where the pack is written: nothing was tried")
        subprocess.run([KELP_DUMP, "verify", output], check=True, stdout=subprocess.DEVNULL)
    finally:
        shutil.rmtree(folder)


main()
