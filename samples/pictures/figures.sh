#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# From a fresh Debian 12 to the pictures of GALLERY.md: Figures 6 and 7 of the paper as kelp draws them
# (figures.py), what its two maps do (bends.py), skinned models that play (skins.py), rigs (rigs.py), looks,
# light, fog and programs with a window (gallery.py), and the moving picture (moving.py). Installs what is
# missing (as root, or with sudo), builds kelp, makes the sample models, and leaves the pictures in
# samples/out/figures. The moving picture takes longest without a graphics card.
# Spot, the Stanford bunny, CesiumMan and greenman come from KELP_ASSETS, or from shared/assets beside the
# checkout; where they are not, kelp's own models stand in for the first two, and the sheets of the others are
# left out.
#   samples/pictures/figures.sh [OPTION OF figures.py]...    for instance --tile 600
#   samples/pictures/figures.sh --help                       this text
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/../.."

case "${1:-}" in
  -h|--help) sed -n '3,12s/^# \{0,1\}//p' samples/pictures/figures.sh; exit 0 ;;
esac

out=samples/out/figures
bin=build/release/bin
log=$out/figures.log
mkdir -p "$out"

step() {
  printf '  %s\n' "$1" >&2
  shift
  "$@" >"$log" 2>&1 ||
    { tail -n 40 "$log" >&2; echo "figures.sh: '$*' failed; the whole log is $log" >&2; exit 4; }
}

step "packages (minutes, the first time)" tools/setup.sh
step "the encoder of the moving picture" tools/setup.sh pictures
step "configure" cmake --preset release
step "build (minutes, the first time)" cmake --build --preset release --target \
  kelp-bake kelp-dump kelp-render kelp-view collider jelly mirror underwater
step "make the models" python3 -B samples/models/make_models.py "$out/models"
printf '  bake, render and lay out\n' >&2
python3 -B samples/pictures/rigs.py --bin "$bin" --out "$out"
for script in figures.py bends.py skins.py gallery.py moving.py; do
  python3 -B samples/pictures/$script --bin "$bin" --models "$out/models" --out "$out" "$@"
done
