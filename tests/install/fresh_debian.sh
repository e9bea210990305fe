#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# Inside the fresh Debian that `tests/ports.sh debian` makes, with the packages and the sources of the consumers in /kelp: installs, uses, removes.
set -euxo pipefail
export DEBIAN_FRONTEND=noninteractive LC_ALL=C
cd /kelp
apt-get update -qq
apt-get purge -y -qq kelp-tools libkelp-dev 2>/dev/null || true

# The tools, on a machine that has no compiler and nothing of the baker's.
apt-get install -y -qq --no-install-recommends ./kelp-tools_*.deb libgl1-mesa-dri
printf 'v 0 0 0\nv 1 0 0\nv 1 2 0\nv 0 2 0\nv 0 0 1\nv 1 0 1\nv 1 2 1\nv 0 2 1\nf 1 4 3 2\nf 5 6 7 8\nf 1 2 6 5\nf 4 8 7 3\nf 1 5 8 4\nf 2 3 7 6\n' >crate.obj
kelp-bake --version
kelp-bake crate.obj -o crate.kelp --rig sway --resolution 32
kelp-dump verify --deep crate.kelp
kelp-render crate.kelp -o crate.png --size 64x64
test -s crate.png

# The development files: what the package depends on is enough to link; the consumer's window-less OpenGL comes besides.
apt-get install -y -qq --no-install-recommends ./libkelp-dev_*.deb g++ cmake ninja-build libegl-dev libgl-dev
cmake -S consumer -B build-consumer -G Ninja && cmake --build build-consumer
build-consumer/write_pack cube.kelp && build-consumer/draw cube.kelp
printf 'cmake_minimum_required(VERSION 3.25)\nproject(game LANGUAGES CXX)\nfind_package(kelp 0.1 REQUIRED)\nadd_executable(game packs/game.cpp)\ntarget_link_libraries(game PRIVATE kelp::runtime)\nkelp_add_pack(TARGET crates SOURCE crate.obj OPTIONS --resolution 16)\nadd_dependencies(game crates)\n' >CMakeLists.txt
cmake -S . -B build-game -G Ninja && cmake --build build-game
build-game/game build-game/crate.kelp
ninja -C build-game | grep 'no work to do'

apt-get purge -y -qq kelp-tools libkelp-dev
left=$(find /usr -path '*kelp*')
[ -z "$left" ] || { echo "left behind: $left" >&2; exit 1; }
echo "both packages install, work and leave nothing behind"
