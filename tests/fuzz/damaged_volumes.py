#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Volumes that were cut or changed, through kelp-bake: damaged_volumes.py KELP_BAKE COUNT SEEDS...

OpenVDB and NanoVDB believe what they read, so a crash within them is no fault of kelp's: the child process
that bakes has to hold it. Whatever the bytes, kelp-bake itself ends in time, with one line and one of its
exit codes, and leaves no part of a pack behind.
"""
import collections
import pathlib
import random
import subprocess
import sys
import tempfile
import time

MOST_SECONDS = 30
ORDERLY = {0: "baked", 1: "usage", 3: "damaged", 4: "failed", 5: "unsupported"}


def damaged(seed, chance):
    """Cut, with bytes changed, or with whole numbers changed to large ones."""
    data = bytearray(seed)
    kind = chance.randrange(6)
    if kind == 0:
        return data[: chance.randrange(len(data) + 1)]
    # Heads and counts are few among so many values: half of the changes go to the first bytes.
    reach = min(len(data), 1200) if chance.randrange(2) else len(data)
    for _ in range(1 + chance.randrange(4)):
        at = chance.randrange(reach)
        if kind < 4:
            data[at] ^= 1 << chance.randrange(8)
        else:
            width = chance.choice((2, 4, 8))
            value = chance.choice((0, 1, 0x7F, 0xFF)).to_bytes(1, "little") * width
            data[at : at + width] = value
    return data[: len(seed)]


def main(program, count, folders):
    seeds = sorted(p for f in folders for p in pathlib.Path(f).iterdir() if p.suffix in (".vdb", ".nvdb"))
    counts, faults, slowest = collections.Counter(), [], 0
    with tempfile.TemporaryDirectory() as folder:
        folder = pathlib.Path(folder)
        for i in range(count):
            chance = random.Random(i)
            seed = seeds[i % len(seeds)]
            model = folder / ("input" + seed.suffix)
            model.write_bytes(damaged(seed.read_bytes(), chance))
            pack = folder / "out.kelp"
            options = [["--resolution", "8"], ["--volume", "solid"], ["--grid", "0"], []][chance.randrange(4)]
            start = time.monotonic()
            try:
                run = subprocess.run(
                    [program, model, "-o", pack, "--progress", "none", "--threads", "1",
                     "--max-memory", "200M", "--max-import-time", "10"] + options,
                    stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, timeout=2 * MOST_SECONDS)
                code, text = run.returncode, run.stderr.decode(errors="replace")
            except subprocess.TimeoutExpired:
                code, text = None, "goes on without end"
            seconds = time.monotonic() - start
            slowest = max(slowest, seconds)
            counts["crashed in the child" if "crashed" in text else ORDERLY.get(code, code)] += 1
            left = [p.name for p in folder.iterdir() if p not in (model, pack)]
            bad = (code not in ORDERLY or seconds > MOST_SECONDS or left
                   or (code != 0 and (text.count("\n") != 1 or len(text) > 6000 or pack.exists())))
            if bad:
                faults.append(f"input {i} of {seed.name}: exit {code}, {seconds:.1f} s, left {left}: "
                              + text[:400])
            pack.unlink(missing_ok=True)
            model.unlink()
    print(f"{count} files: {dict(counts)}; slowest {slowest:.1f} s")
    for fault in faults[:10]:
        print(fault)
    return 1 if faults else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1], int(sys.argv[2]), sys.argv[3:]))
