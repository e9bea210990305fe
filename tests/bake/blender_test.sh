#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# Bakes files that Blender itself exported. Opt-in, since Blender is large:
#   apt-get install --no-install-recommends blender python3-numpy
#   tests/bake/blender_test.sh [BUILD_FOLDER]        (default build/dev)
set -euo pipefail
here="$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)"
build="${1:-$here/../../build/dev}"
for program in blender "$build/bin/kelp-bake" "$build/bin/kelp-dump"; do
  command -v "$program" >/dev/null ||
    { echo "blender_test.sh: $program is missing: install or build it first" >&2; exit 4; }
done
folder="$(mktemp -d)"
trap 'rm -rf "$folder"' EXIT

# Runs a script of this folder in Blender, with the arguments that follow its name.
run_blender() {
  local script="$here/$1"
  shift
  blender --background --factory-startup --python-exit-code 1 --python "$script" -- "$@" \
    >"$folder/blender.log" 2>&1 || { cat "$folder/blender.log" >&2; exit 4; }
}

run_blender blender_export.py "$folder/reed.glb"
"$build/bin/kelp-bake" "$folder/reed.glb" -o "$folder/reed.kelp" --resolution 128 \
  --report "$folder/report.json" --progress none
"$build/bin/kelp-dump" verify --deep "$folder/reed.kelp"

# The script drew one part on three knots and one clip, without a notice.
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

# The steps of tools/rig/LANGUAGE.md, and its table of axes: Blender's (x, y, z) is the file's (x, z, -y), in
# lengths of the reed, which is 2 m.
run_blender blender_steps.py "$folder"
for name in empties property; do
  "$build/bin/kelp-bake" "$folder/$name.glb" -o "$folder/$name.kelp" --resolution 64 \
    --report "$folder/$name.report.json" --progress none
  "$build/bin/kelp-dump" rig "$folder/$name.kelp" >"$folder/$name.rig.json"
done
python3 - "$folder" <<'PYTHON'
import json
import math
import sys

def load(name):
    return json.load(open(sys.argv[1] + "/" + name))

def near(vector, wanted):
    assert all(abs(a - b) < 2e-3 for a, b in zip(vector, wanted)), (vector, wanted)

report, rig = load("empties.report.json"), load("empties.rig.json")
# The reed leans: two notices say so.
notices = report["notices"]
assert len(notices) == 2 and all("at rest" in notice for notice in notices), notices
assert report["parts"][0]["rig"].startswith("3 knot empties"), report["parts"]
near(rig["knots"][1]["offset"], [0.1, 0, -0.05])
tangent = [rig["knots"][2]["tangent"][i] for i in range(3)]
near(tangent, [math.sin(math.radians(30)), math.cos(math.radians(30)), 0])
(clip,) = rig["clips"]
offsets = [key["offset"] for key in rig["clips"][clip]["keys"] if key["knot"] == 2 and "offset" in key]
assert clip == "sway", clip
near(max(offsets), [0.2, 0, 0])

report, rig = load("property.report.json"), load("property.rig.json")
assert not report["notices"], report["notices"]
near(rig["clips"]["sway"]["waves"][0]["offset"], [0.2, 0, -0.05])
PYTHON

# A tentacle of eight bones with automatic weights that curls by 30 degrees at each: one swept part, which
# follows the skin at 128 voxels within half a voxel in the mean.
run_blender blender_tentacle.py "$folder/tentacle.glb" 30
"$build/bin/kelp-bake" "$folder/tentacle.glb" -o "$folder/tentacle.kelp" --resolution 128 \
  --report "$folder/tentacle.json" --progress none
"$build/bin/kelp-dump" verify --deep "$folder/tentacle.kelp"
python3 - "$folder/tentacle.json" <<'PYTHON'
import json
import sys

report = json.load(open(sys.argv[1]))
assert len(report["parts"]) == 1 and not report["notices"], (report["parts"], report["notices"])
(clip,) = report["clips"]
print("tentacle:", clip["fit"])
assert clip["name"] == "curl" and clip["fit"]["mean"] <= 0.5 and clip["fit"]["p95"] <= 2, clip
PYTHON
echo "blender_test.sh: passed"
