#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# Builds kelp for the web from nothing: the modules, the packs of the page, and the page itself, in
# build/web_page/page. Any web server can serve that folder.
#   samples/web/build.sh                 all of it; a second run only does what has changed
#   samples/web/build.sh --serve [PORT]  first installs what is missing, as root or with sudo; then serves the
#                                        page on this machine, at port 8000 or PORT, until Ctrl-C
#   samples/web/build.sh --help          this text
# KELP_BAKE and KELP_JOBS: the kelp-bake to make the packs with (built if it is not given), and how many jobs
# to compile with.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/../.."
source tools/port_prefix.sh

serve=
case "${1:-}" in
  "") ;;
  --serve)
    serve=${2:-8000}
    [[ $serve =~ ^[1-9][0-9]{0,4}$ ]] && [ "$serve" -le 65535 ] ||
      fail "--serve: '$serve' is no port from 1 to 65535; see --help"
    ! (exec 3<>"/dev/tcp/127.0.0.1/$serve") 2>/dev/null ||
      fail "--serve: something answers at port $serve already; give another one"
    tools/setup.sh
    tools/setup.sh web ;;
  -h|--help) sed -n '3,10s/^# \{0,1\}//p' "samples/web/build.sh"; exit 0 ;;
  *) fail "unknown option '$1'; see --help" ;;
esac

jobs=${KELP_JOBS:-$(nproc)}
out=build/web_page
page=$out/page
export NODE_PATH=/usr/share/nodejs  # the linker calls node, which looks for Debian's modules there
export NODE_OPTIONS=--no-experimental-fetch  # emscripten 3.1.6 takes a node with fetch() for a browser

modules() {
  need emscripten nodejs
  local toolchain=/usr/share/emscripten/cmake/Modules/Platform/Emscripten.cmake
  prepare web -DCMAKE_TOOLCHAIN_FILE=$toolchain
  cmake -S samples/web -B "$out/modules" -G Ninja -DCMAKE_TOOLCHAIN_FILE=$toolchain \
    -DCMAKE_BUILD_TYPE=Release -DCMAKE_FIND_ROOT_PATH="$PWD/build/ports/web/prefix" >"$out/configure.log" ||
    { tail -20 "$out/configure.log" >&2; fail "CMake found a fault, see $out/configure.log"; }
  cmake --build "$out/modules" -j "$jobs"
}

# kelp-bake of this checkout, unless one is given.
baker() {
  [ -n "${KELP_BAKE:-}" ] && return 0
  cmake --preset release >"$out/release.log"
  cmake --build --preset release -j "$jobs" --target kelp-bake
  KELP_BAKE=$PWD/build/release/bin/kelp-bake
}

# stale TARGET SOURCE...: succeeds if the target is missing or older than a source.
stale() {
  local target=$1 source
  shift
  [ -s "$target" ] || return 0
  for source in "$@"; do [ "$source" -nt "$target" ] && return 0; done
  return 1
}

# bake NAME RESOLUTION: one of kelp's own models.
bake() {
  stale "$page/packs/$1.kelp" "$out/models/$1.glb" "$KELP_BAKE" || return 0
  "$KELP_BAKE" "$out/models/$1.glb" -o "$page/packs/$1.kelp" --resolution "$2" --effort best \
    >>"$out/bake.log" 2>&1 ||
    { tail -5 "$out/bake.log" >&2; fail "$1 was not baked, see $out/bake.log"; }
}

packs() {
  baker
  if stale "$out/models/seabed.glb" samples/models/*.py; then
    python3 -B samples/models/make_models.py "$out/models" >"$out/models.log"
  fi
  bake kelp_plant 256
  bake tentacle 256
  bake octopus 128
}

mkdir -p "$page/packs"
modules
cp samples/web/{index.html,page.css,*.js,*.d.ts,package.json,README.md} "$page/"
cp "$out"/modules/bin/*.{js,wasm} "$page/"
packs
echo "built $page"
[ -z "$serve" ] || exec python3 -B tests/web/server.py "$page" "$serve"
