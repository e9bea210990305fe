# SPDX-License-Identifier: MIT
"""The compressed sizes of the page's files, and a limit for the viewer's."""

import gzip
import shutil
import subprocess
import sys

MOST = 300000
VIEWER = ["kelp_viewer.wasm", "kelp_viewer.js", "kelp.js", "stream.js", "kelp-view.js", "controls.js"]
PAGE = ["index.html", "page.js", "page.css"]
BAKER = ["kelp_baker.wasm", "kelp_baker.js", "bake.js", "bake_worker.js"]


def compressed(path):
    with open(path, "rb") as file:
        data = file.read()
    packed = subprocess.run(["brotli", "--quality=11", "--stdout", path], check=True,
                            capture_output=True).stdout \
        if shutil.which("brotli") else None
    return len(data), len(gzip.compress(data, 9)), len(packed) if packed else 0


def main(page):
    print("sizes in bytes: as they are, by gzip, by brotli")
    for what, names in (("viewer", VIEWER), ("page", PAGE), ("baker of .vox", BAKER)):
        sums = [0, 0, 0]
        for name in names:
            sizes = compressed(f"{page}/{name}")
            sums = [a + b for a, b in zip(sums, sizes)]
            print(f"    {name:20}", *(f"{size:9}" for size in sizes))
        print(f"  {what:22}", *(f"{size:9}" for size in sums))
        if what == "viewer" and sums[1] > MOST:
            sys.exit(f"sizes.py: the viewer is larger than {MOST} bytes")


main(sys.argv[1])
