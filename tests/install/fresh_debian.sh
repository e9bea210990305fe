#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# Inside the fresh Debian that `tests/ports.sh debian` makes, with the packages and the sources of the
# consumers in /kelp: installs, uses, removes.
set -euxo pipefail
export DEBIAN_FRONTEND=noninteractive LC_ALL=C
cd /kelp
apt-get update -qq
apt-get purge -y -qq kelp-tools libkelp-dev python3-kelp libkelp0 2>/dev/null || true

# The tools, on a machine that has no compiler and nothing of the baker's.
apt-get install -y -qq --no-install-recommends ./kelp-tools_*.deb libgl1-mesa-dri
printf 'v %s\n' '0 0 0' '1 0 0' '1 2 0' '0 2 0' '0 0 1' '1 0 1' '1 2 1' '0 2 1' >crate.obj
printf 'f %s\n' '1 4 3 2' '5 6 7 8' '1 2 6 5' '4 8 7 3' '1 5 8 4' '2 3 7 6' >>crate.obj
kelp-bake --version
kelp-bake crate.obj -o crate.kelp --rig sway --resolution 32
kelp-dump verify --deep crate.kelp
kelp-render crate.kelp -o crate.png --size 64x64
test -s crate.png
kelp-view --version

# Files for desktops and shells: pages, completions where the shells look for them, the type of
# packs, and kelp-view for it.
apt-get install -y -qq --no-install-recommends man-db mandoc groff-base python3 bash-completion zsh fish \
  desktop-file-utils shared-mime-info libglib2.0-bin
programs=(/usr/bin/kelp-bake /usr/bin/kelp-dump /usr/bin/kelp-render /usr/bin/kelp-view)
python3 -B manual_test.py - /usr "${programs[@]}" --
for shell in bash zsh fish; do python3 -B completions_test.py "$shell" /usr "${programs[@]}" --; done
for program in "${programs[@]}"; do
  man -w "$(basename "$program")"
  whatis "$(basename "$program")"
done
bash -ic '. /usr/share/bash-completion/bash_completion; _completion_loader kelp-bake; complete -p kelp-bake'
zsh -fc 'autoload -Uz compinit; compinit -u -D; for p in bake dump render view; do
  [ "$_comps[kelp-$p]" = "_kelp-$p" ] || { echo "zsh does not find _kelp-$p" >&2; exit 1; }; done'
fish -c 'complete -C "kelp-render --meth"' | grep -- --method
desktop-file-validate /usr/share/applications/kelp-view.desktop
cp crate.kelp nameless
for file in crate.kelp nameless; do
  gio info -a standard::content-type "$file" | grep 'content-type: model/x-kelp$'
done
gio mime model/x-kelp | grep kelp-view.desktop
test -s /usr/share/icons/hicolor/scalable/apps/kelp-view.svg

# The development files: what the package depends on is enough to link; the consumer's window-less OpenGL
# comes besides.
apt-get install -y -qq --no-install-recommends ./libkelp-dev_*.deb ./libkelp0_*.deb g++ cmake \
  ninja-build pkg-config libegl-dev libgl-dev libopengl-dev
cmake -S consumer -B build-consumer -G Ninja
cmake --build build-consumer
build-consumer/write_pack cube.kelp
build-consumer/draw cube.kelp
cmake -S consumer_c -B build-c -G Ninja
cmake --build build-c
build-c/ask cube.kelp
bash consumer_c/pkg_config.sh cc /usr cube.kelp
bash host/pkg_config.sh c++ /usr cube.kelp
cat >CMakeLists.txt <<'END'
cmake_minimum_required(VERSION 3.25)
project(game LANGUAGES CXX)
find_package(kelp 0.1 REQUIRED)
add_executable(game packs/game.cpp)
target_link_libraries(game PRIVATE kelp::runtime)
kelp_add_pack(TARGET crates SOURCE crate.obj OPTIONS --resolution 16)
add_dependencies(game crates)
END
cmake -S . -B build-game -G Ninja
cmake --build build-game
build-game/game build-game/crate.kelp
ninja -C build-game | grep 'no work to do'

# Python.
apt-get install -y -qq --no-install-recommends ./python3-kelp_*.deb libegl1
python3 picture.py crate.kelp python.png
test -s python.png

apt-get purge -y -qq kelp-tools libkelp-dev python3-kelp libkelp0
left=$(find /usr -path '*kelp*')
[ -z "$left" ] || { echo "left behind: $left" >&2; exit 1; }
echo "the packages install, work and leave nothing behind"
