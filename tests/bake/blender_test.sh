#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# Bakes a file that Blender itself exported. Opt-in, since Blender is large: apt-get install --no-install-recommends blender python3-numpy
#   tests/bake/blender_test.sh [BUILD_FOLDER]        (default build/dev)
set -euo pipefail
here="$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)"
build="${1:-$here/../../build/dev}"
for program in blender "$build/bin/kelp-bake" "$build/bin/kelp-dump"; do
  command -v "$program" >/dev/null || { echo "blender_test.sh: $program is missing: install or build it first" >&2; exit 4; }
done
folder="$(mktemp -d)"
trap 'rm -rf "$folder"' EXIT

blender --background --factory-startup --python-exit-code 1 --python "$here/blender_export.py" -- "$folder/reed.glb" >"$folder/blender.log" 2>&1 ||
  { cat "$folder/blender.log" >&2; exit 4; }
"$build/bin/kelp-bake" "$folder/reed.glb" -o "$folder/reed.kelp" --resolution 128 --report "$folder/report.json" --progress none
"$build/bin/kelp-dump" verify --deep "$folder/reed.kelp"

# What the script drew: one part on three knots, one clip, nothing to complain of.
python3 - "$folder/report.json" <<'PYTHON'
import json
import sys

report = json.load(open(sys.argv[1]))
(part,) = report["parts"]
(clip,) = report["clips"]
assert part["name"] == "Reed" and part["rig"].startswith("3 knot empties"), part
assert clip["name"] == "sway" and abs(clip["duration"] - 49 / 24) < 0.01, clip
assert not report["notices"], report["notices"]
PYTHON
echo "blender_test.sh: passed"
