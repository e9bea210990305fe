#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""kelp-dump verify beside zstd -t and xxhsum on the same pack of fog. README.md here.

  bench_verify.py KELP_DUMP PACK [ROUNDS]
"""
import os
import statistics
import struct
import subprocess
import sys
import tempfile
import time


def frames(pack):
    """The zstd frames of a pack, as its index lists them, one behind the other, as in a .zst file.

    They are the chunks with the zstd flag, and the pages of fog. Pages of voxels are none."""
    count = struct.unpack_from("<I", pack, 24)[0]
    out = bytearray()
    for i in range(count):
        fourcc, flags, _, _, offset, stored = struct.unpack_from("<4sIIIQQ", pack, 64 + 48 * i)
        if fourcc == b"BRCK":
            sys.exit("bench_verify.py: the pack has solid parts, whose pages zstd cannot read: "
                     "give one of fog, and see bench_bake read for the others")
        if flags & 2 or fourcc == b"FOGB":
            out += pack[offset:offset + stored]
    return bytes(out)


def run(command):
    begin = time.perf_counter()
    subprocess.run(command, check=True, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    return time.perf_counter() - begin


def main():
    if len(sys.argv) not in (3, 4):
        sys.exit(__doc__)
    dump, path = sys.argv[1], sys.argv[2]
    rounds = int(sys.argv[3]) if len(sys.argv) == 4 else 9
    pack = open(path, "rb").read()
    with tempfile.TemporaryDirectory() as folder:
        zst = os.path.join(folder, "frames.zst")
        open(zst, "wb").write(frames(pack))
        commands = {"kelp-dump verify PACK": [dump, "verify", path],
                    "zstd -t FRAMES.zst": ["zstd", "-q", "-t", "--single-thread", zst],
                    "xxhsum -H3 PACK": ["xxhsum", "-H3", path], "kelp-dump --version": [dump, "--version"]}
        times = {name: [] for name in commands}
        for _ in range(rounds):
            for name, command in commands.items():
                times[name].append(run(command))
        median = {name: statistics.median(t) for name, t in times.items()}
    print(f"{path}: {len(pack) / 2**20:.1f} MiB, medians of {rounds} interleaved rounds")
    for name, seconds in median.items():
        print(f"  {name:<22} {1000 * seconds:8.1f} ms")
    peers = median["zstd -t FRAMES.zst"] + median["xxhsum -H3 PACK"]
    print("  speed of verify over that of zstd -t and xxhsum together: "
          f"{peers / median['kelp-dump verify PACK']:.2f}")
    work = median["kelp-dump verify PACK"] - median["kelp-dump --version"]
    print(f"  the same without the start of kelp-dump, which loads its libraries: {peers / work:.2f}")


if __name__ == "__main__":
    main()
