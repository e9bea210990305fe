#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Damaged volumes and meshes through kelp-bake: each ends in order, with an exit code that says why and one
line, within a gigabyte and thirty seconds of processor time, and leaves nothing behind.

Usage: kelp_bake_damaged_test.py KELP_BAKE MAKE_VOLUMES SOURCE_FOLDER [FILES]

FILES: how many are damaged and baked; 100 if it is left out (40 under a sanitizer), 10000 with
KELP_ALL_TESTS=1. Samples are volumes that MAKE_VOLUMES writes, the seeds in tests/fuzz, small meshes and
models of voxels, and files of the assets, where they are."""
import collections
import concurrent.futures
import os
import random
import resource
import struct
import subprocess
import sys
import tempfile
import time

from kelp_bake_case import KELP_BAKE, SANITIZED, box, lump
from limited import limits

MAKE_VOLUMES, SOURCES = (os.path.abspath(path) for path in sys.argv[1:3])
FILES = (int(sys.argv[3]) if len(sys.argv) > 3 else 10000 if os.environ.get("KELP_ALL_TESTS")
         else 40 if SANITIZED else 100)
SEEDS = os.path.join(SOURCES, "tests", "fuzz", "seeds", "vdb")
ASSETS = os.environ.get("KELP_ASSETS") or os.path.join(SOURCES, "..", "shared", "assets")
OF_ASSETS = ("vdb/gaffer_arnold_sphere.vdb", "vdb/openusd_densityAndHeat.vdb", "vdb/gaffer_sphere.vdb",
             "vdb/openusd_smoke_000001.vdb", "mesh/common3d/spot.obj",
             "mesh/draco_testdata/test_pos_color.ply", "gltf/pmndrs/barrel.glb", "gltf/aquarium/coral.glb",
             "gltf/assimp/glTF2/Box.glb")
VOLUMES = (".vdb", ".nvdb")
SECONDS = 30


def meshes():
    """A cube with quads of 4 x 4 on its sides, in every format of meshes that is easily written."""
    text = lump(4)
    corners = [[float(x) for x in line.split()[1:]] for line in text.split("\n") if line.startswith("v ")]
    quads = [[int(i) - 1 for i in line.split()[1:]] for line in text.split("\n") if line.startswith("f ")]
    triangles = [(q[0], q[i], q[i + 1]) for q in quads for i in (1, 2)]
    head = "element vertex %d\nproperty float x\nproperty float y\nproperty float z\nelement face %d\n" \
           "property list uchar int vertex_indices\nend_header\n" % (len(corners), len(quads))
    lines = ["%g %g %g" % tuple(c) for c in corners] + ["4 %d %d %d %d" % tuple(q) for q in quads]
    yield "lump.obj", text.encode()
    yield "box.obj", box(1, 2, 1).encode()
    yield "text.ply", ("ply\nformat ascii 1.0\n" + head + "\n".join(lines) + "\n").encode()
    yield "binary.ply", ("ply\nformat binary_little_endian 1.0\n" + head).encode() + b"".join(
        struct.pack("<3f", *c) for c in corners) + b"".join(struct.pack("<B4i", 4, *q) for q in quads)
    yield "lump.off", ("OFF\n%d %d 0\n" % (len(corners), len(quads)) + "\n".join(lines) + "\n").encode()
    yield "lump.stl", bytes(80) + struct.pack("<I", len(triangles)) + b"".join(
        struct.pack("<12fH", 0, 0, 0, *(x for i in t for x in corners[i]), 0) for t in triangles)


def voxels():
    """Models of voxels: a .vox of a scene, and a .binvox."""
    def chunk(name, content):
        return name + struct.pack("<2i", len(content), 0) + content

    voxels = bytes(b % 9 if i % 4 < 3 else b for i in range(160) for b in [i * 7 % 251])
    model = (chunk(b"SIZE", struct.pack("<3i", 9, 9, 9))
             + chunk(b"XYZI", struct.pack("<i", 40) + voxels))
    turn = struct.pack("<8i", 4, 0, 3, -1, -1, 1, 1, 2) + b"_t" + struct.pack("<i", 7) + b"30 0 -9"
    scene = b"".join(
        (chunk(b"nTRN", struct.pack("<7i", 0, 0, 1, -1, -1, 1, 0)),
         chunk(b"nGRP", struct.pack("<5i", 1, 0, 2, 2, 4)),
         chunk(b"nTRN", struct.pack("<7i", 2, 0, 3, -1, -1, 1, 0)),
         chunk(b"nSHP", struct.pack("<5i", 3, 0, 1, 0, 0)),
         chunk(b"nTRN", turn),
         chunk(b"RGBA", bytes(range(256)) * 4)))
    head = b"VOX " + struct.pack("<i", 200) + b"MAIN" + struct.pack("<2i", 0, len(model + scene))
    yield "made.vox", head + model + scene
    head = b"#binvox 1\ndim 8 8 8\ntranslate 0 0 0\nscale 1\ndata\n"
    yield "made.binvox", head + b"\x01\x80\x00\x80" * 2


def samples(folder):
    """Names, bytes and options of sound files."""
    subprocess.run([MAKE_VOLUMES, folder], check=True, timeout=60)
    for name in sorted(os.listdir(folder)):
        with open(os.path.join(folder, name), "rb") as file:
            yield name, file.read(), ["--grid", "0"] if name.startswith("several") else []
    for name in sorted(os.listdir(SEEDS)):
        if name.endswith(VOLUMES):
            with open(os.path.join(SEEDS, name), "rb") as file:
                yield name, file.read(), random.Random(name).choice(
                    (["--resolution", "8"], ["--volume", "solid"], ["--grid", "0"], []))
    for name, content in meshes():
        yield name, content, ["--resolution", "16"]
    for name, content in voxels():
        yield name, content, []
    for name in OF_ASSETS:
        path = os.path.join(ASSETS, name)
        if os.path.exists(path):
            with open(path, "rb") as file:
                yield os.path.basename(path), file.read(), ["--resolution", "32"]


def damaged(good, number):
    """Bytes that are not those any more. Every second change is among the first, where counts and offsets
    are. Words become values that overflow sums; files are cut; pieces are lost, doubled and exchanged."""
    pick = random.Random(number)
    bad = bytearray(good)
    reach = min(len(bad), 1500) if number % 2 else len(bad)
    for _ in range(1 + number % 3):
        at = pick.randrange(max(1, min(reach, len(bad))))
        kind = pick.randrange(6)
        if kind == 0:
            bad[at:at + 1] = bytes([pick.randrange(256)])
        elif kind == 1 and at < len(bad):
            bad[at] ^= 1 << pick.randrange(8)
        elif kind == 2:
            value = pick.choice((-1, 1 << 31, (1 << 31) - 1, 1 << 62, 0, pick.getrandbits(63)))
            word = struct.pack("<q", value)[:pick.choice((4, 8))]
            bad[at:at + len(word)] = word[:len(bad) - at]
        elif kind == 3:
            del bad[at:]
        elif kind == 4:
            del bad[at:at + pick.randrange(1, 64)]
        else:
            length, other = pick.randrange(1, 512), pick.randrange(max(1, len(bad)))
            bad[at:at + length] = bad[other:other + length]
    return bytes(bad)


def bake(folder, number, name, good, options):
    """Returns the fault in the end of this bake, or None, its exit code, and True if it crashed."""
    place = os.path.join(folder, str(number))
    os.mkdir(place)
    path = os.path.join(place, name)
    with open(path, "wb") as file:
        file.write(damaged(good, number))
    command = [KELP_BAKE, path, "-o", os.path.join(place, "out.kelp"), *options, "--threads", "1",
               "--progress", "none", "--max-import-time", str(6 * SECONDS)]
    limited = limits(KELP_BAKE)
    inner = limited.pop("preexec_fn", lambda: None)

    def limit():
        inner()
        resource.setrlimit(resource.RLIMIT_CPU, (SECONDS, SECONDS + 1))

    result = subprocess.run(command, capture_output=True, timeout=120, preexec_fn=limit, **limited)
    text = result.stderr.decode(errors="replace")
    crashed = "crashed" in text
    wrong = ""
    one_line = text.startswith("kelp-bake: ") and text.count("\n") == 1 and ";" in text
    if result.returncode not in (0, 1, 3, 4, 5):
        wrong = "exit code %d" % result.returncode
    elif result.returncode and not one_line:
        wrong = "not one line that says what to do"
    elif "unexpected" in text or "Sanitizer" in text or "processor time" in text or len(text) > 8000:
        wrong = "this line"
    elif crashed and not name.endswith(VOLUMES):
        wrong = "a crash"
    kept = {name, "out.kelp"} if result.returncode == 0 else {name}
    if not wrong and set(os.listdir(place)) != kept:
        wrong = "leaves %s" % sorted(set(os.listdir(place)) - kept)
    if wrong:
        wrong = "%s, change %d (%s): %s: %s" % (name, number, path, wrong, text[:1500])
        return wrong, result.returncode, crashed
    for left in os.listdir(place):
        os.remove(os.path.join(place, left))
    os.rmdir(place)
    return "", result.returncode, crashed


def main():
    folder = tempfile.mkdtemp(prefix="kelp_damaged_")
    sound = os.path.join(folder, "sound")
    os.mkdir(sound)
    good = list(samples(sound))
    start = time.monotonic()
    with concurrent.futures.ThreadPoolExecutor(os.cpu_count()) as pool:
        ends = list(pool.map(lambda i: bake(folder, i, *good[i % len(good)]), range(FILES)))
    wrong = [end[0] for end in ends if end[0]]
    codes = collections.Counter(end[1] for end in ends)
    print("%d damaged files of %d samples in %.0f s: exit codes %s; %d crashes in libraries of volumes; "
          "%d wrong" % (FILES, len(good), time.monotonic() - start, dict(sorted(codes.items())),
             sum(end[2] for end in ends), len(wrong)))
    for line in wrong[:10]:
        print(line)
    if codes[3] < FILES // 5:
        sys.exit("so few of them are refused: they are not damaged")
    sys.exit(1 if wrong else 0)


if __name__ == "__main__":
    main()
