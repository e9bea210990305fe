#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# Bakes every mesh of the shared assets. Draws each pack with kelp-render, and beside it the triangles as
# assimp reads them, from the same camera, with names and refusals below. The pages are
# samples/out/contact_sheet/page_N.png: look at them.
#   tests/bake/contact_sheet/contact_sheet.sh [BUILD_FOLDER [RESOLUTION [PIXELS]]]
#       default: build/dev, 96 voxels, 260 pixels
# Exit code 7 if a pack and its triangles differ. Opt-in:
#   apt-get install --no-install-recommends libassimp-dev
set -euo pipefail
root="$(cd "$(dirname "${BASH_SOURCE[0]}")/../../.." && pwd)"
build="${1:-$root/build/dev}" resolution="${2:-96}" pixels="${3:-260}"
assets="${KELP_ASSETS:-$root/../shared/assets}"
out="$root/samples/out/contact_sheet"
[ -d "$assets" ] || { echo "contact_sheet.sh: $assets is absent: set KELP_ASSETS" >&2; exit 2; }
cmake --build "$build" --target kelp-bake kelp-render contact_sheet >&2
rm -rf "$out"
mkdir -p "$out"

number=0
while IFS= read -r -d '' mesh; do
  number=$((number + 1))
  stem="$out/$(printf %03d "$number")"
  printf '%03d\t%s\t%s\n' "$number" "$mesh" "${mesh#"$assets"/}" >>"$out/list.txt"
  code=0
  "$build/bin/kelp-bake" "$mesh" -o "$stem.kelp" --resolution "$resolution" --progress none \
    2>"$stem.log" || code=$?
  echo "$code" >>"$stem.log"
  [ "$code" -ne 0 ] || "$build/bin/kelp-render" "$stem.kelp" -o "$stem.png" --size "${pixels}x$pixels" \
    --background none --shadows off
done < <(find "$assets/gltf" "$assets/mesh" -type f \( -iname '*.gltf' -o -iname '*.glb' -o -iname '*.obj' \
  -o -iname '*.ply' -o -iname '*.stl' -o -iname '*.off' -o -iname '*.drc' \) -print0 | sort -z)

"$build/tests/bake/contact_sheet/contact_sheet" "$out"
