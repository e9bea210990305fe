#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# From a fresh Debian 12 to pictures of models that bend, in samples/out: installs missing packages (as root,
# or with sudo), builds kelp, makes the sample models, bakes and verifies them, and renders them. It needs no
# display. On two cores it takes some 15 minutes, most of them the build. It needs 2 GB of disk: 1.3 GB
# for the packages (270 MB to download), the rest for build/release and samples/out. A second run only does
# what has changed.
#   samples/demo.sh           all of it
#   samples/demo.sh --help    this text
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

case "${1:-}" in
  "") ;;
  -h|--help) sed -n '3,9s/^# \{0,1\}//p' "samples/demo.sh"; exit 0 ;;
  *) echo "demo.sh: unknown option '$1'; see --help" >&2; exit 1 ;;
esac

out=samples/out
bin=build/release/bin
log=$out/demo.log
mkdir -p "$out"
: >"$log"

# step WHAT COMMAND...: runs the command, says what it is and how long it took. Its output goes to the log. If
# it fails, shows the end of the log and ends the demo.
step() {
  local what=$1 began=$SECONDS code=0
  shift
  printf '  %-52s' "$what" >&2
  echo "== $what: $*" >>"$log"
  "$@" >>"$log" 2>&1 || code=$?
  if [ "$code" -ne 0 ]; then
    echo "FAILED" >&2
    tail -n 40 "$log" >&2
    echo "demo.sh: '$what' failed with exit code $code; the whole log is $log" >&2
    exit "$code"
  fi
  echo "$((SECONDS - began)) s" >&2
}

# stale TARGET SOURCE...: succeeds if the target is missing or older than a source.
stale() {
  local target=$1 source
  shift
  [ -s "$target" ] || return 0
  for source in "$@"; do [ "$source" -nt "$target" ] && return 0; done
  return 1
}

bake() {
  local name=$1 resolution=$2
  stale "$out/$name.kelp" "$out/models/$name.glb" "$bin/kelp-bake" || return 0
  "$bin/kelp-bake" "$out/models/$name.glb" -o "$out/$name.kelp" --resolution "$resolution"
}

# picture FILE NAME OPTIONS...: renders the pack of that name.
picture() {
  local file=$1 name=$2
  shift 2
  "$bin/kelp-render" "$out/$name.kelp" -o "$out/$file" --size 960x960 "$@"
}

# The scene of the sample underwater, on an X server without a screen.
reef() {
  xvfb-run -a "$bin/underwater" "$out" --size 960x540 --start 2 --frames 1 "$out/underwater.ppm" &&
    python3 -B samples/pictures/ppm_to_png.py "$out/underwater.ppm" "$out/underwater.png" &&
    rm "$out/underwater.ppm"
}

cat >&2 <<END
kelp's demo: packages, build, models, packs, pictures. Some 15 minutes the first time, on two cores.
The build goes to build/release, the rest to $PWD/$out, all output to $log.
END
step "install packages (a minute or two the first time)" tools/setup.sh
step "configure" cmake --preset release
step "build (the longest step, the first time)" cmake --build --preset release --target \
  kelp-bake kelp-dump kelp-render kelp-view game_loop mirror sdl underwater \
  kelp_manual kelp_c kelp_c_static  # what an installation needs beside these
if stale "$out/models/seabed.glb" samples/models/*.py; then
  step "make the models" python3 -B samples/models/make_models.py "$out/models"
fi
for pack in kelp_plant:256 orange:256 fish:256 sea_grass:160 dulse:128 fusilier:128 tentacle:256 \
  octopus:128; do
  name=${pack%:*}
  step "bake $name at ${pack#*:} voxels" bake "$name" "${pack#*:}"
  step "verify $name" "$bin/kelp-dump" verify --deep "$out/$name.kelp"
done
step "render the plant at rest" picture plant_rest.png kelp_plant
step "render the plant bent" picture plant_bent.png kelp_plant \
  --offset 2=-0.13,-0.01,0.03 --offset 3=-0.5,-0.08,0.1 --tangent 1=-0.25,1,0.05 \
  --tangent 2=-0.9,1,0.2 --tangent 3=-1.3,0.7,0.2
step "render the plant in motion" picture plant_sway.png kelp_plant --clip current --time 2
step "render the orange" picture orange.png orange
step "render the fish" picture fish.png fish --clip swim --time 0.2
step "render the tentacle" picture tentacle.png tentacle --clip curl --time 2.5
step "render the octopus" picture octopus.png octopus --clip idle --time 2 --yaw 10
step "render the reef" reef

echo "All of it took $((SECONDS / 60)) min $((SECONDS % 60)) s." >&2

echo
"$bin/kelp-dump" info "$out/kelp_plant.kelp"
cat <<END

Made in $PWD/$out:
  models/*.glb     nine models, *.kelp: eight packs of them
  plant_rest.png   the plant at rest
  plant_bent.png   bent by its knots and tangents
  plant_sway.png   2 s into its clip "current"
  orange.png, fish.png
  tentacle.png     rolled up: its voxels are swept along the spline, so it stays as thick as it is
  octopus.png      its arms roll up: a skinned model, whose joints move parts
  underwater.png   400 plants and 59 fish

See it move (needs a display and OpenGL 3.3):
  $bin/kelp-view $out/kelp_plant.kelp
  $bin/game_loop $out/kelp_plant.kelp
  $bin/sdl $out/kelp_plant.kelp          click on a plant
  $bin/underwater $out
Bake a model of yours:  $bin/kelp-bake YOURS.glb -o YOURS.kelp --resolution 256 --rig sway
Make a rig for it:      $bin/kelp-view --watch YOURS.glb      (tools/kelp-view/FIRST_RIG.md)
END
