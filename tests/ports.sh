#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# Tests kelp on other systems than the one that builds it. Opt-in: tests/run.sh does not need it.
#   tests/ports.sh debian    makes the Debian packages, checks them with lintian, installs them into a fresh
#                            Debian and uses them there (as root; downloads some 500 MB)
#   tests/ports.sh hosts     builds games that build kelp, one of them with zstd's source, not a download
#   tests/ports.sh windows   cross-compiles the runtime, kelp.dll and kelp-dump with mingw-w64, runs their
#                            tests in wine
#   tests/ports.sh web       compiles the runtime with emscripten, runs its tests in node, links a program
#                            with WebGL 2; then builds the page of samples/web, tests its package for npm, and
#                            it in Chromium and Firefox (KELP_WEB=page: this alone). Screenshots:
#                            build/web_page/tests
# Names the packages to install if one is missing. Everything goes to build/.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

source tools/port_prefix.sh

port_debian() {
  [ "$(id -u)" -eq 0 ] || fail "debian: needs root, to make a fresh Debian in a folder"
  need lintian debootstrap dpkg-dev gzip
  rm -f build/package/*.deb
  cmake --workflow --preset package
  # No bug of Debian's asks for the packages. CPack calls ldconfig besides the trigger that does.
  lintian --allow-root --fail-on error,warning \
    --suppress-tags initial-upload-closes-no-bugs,maintscript-calls-ldconfig build/package/*.deb
  tests/install/hardened.sh build/package/bin/kelp-* build/package/runtime/c/libkelp.so.*.*
  local root=build/debian-root
  if [ ! -x "$root/usr/bin/apt-get" ]; then
    local repository
    repository=$(debian_repository)
    rm -rf "$root"
    debootstrap --variant=minbase "${repository#* }" "$root" "${repository% *}" >build/debian-root.log ||
      { tail -5 build/debian-root.log >&2; exit 1; }
  fi
  rm -rf "$root/kelp" && mkdir "$root/kelp"
  cp build/package/*.deb "$root/kelp"
  cp -r tests/install/consumer tests/install/consumer_c tests/install/host tests/install/packs "$root/kelp"
  cp samples/python/picture.py "$root/kelp"
  cp tests/install/{fresh_debian.sh,help_truth.py,shells.py,manual_test.py,completions_test.py} "$root/kelp"
  cp /etc/resolv.conf "$root/etc/resolv.conf"
  # Shells that are asked what they complete want a terminal, and bash /dev/fd.
  trap 'umount -q build/debian-root/dev/pts build/debian-root/proc' EXIT
  mountpoint -q "$root/dev/pts" || mount -t devpts devpts "$root/dev/pts"
  mountpoint -q "$root/proc" || mount -t proc proc "$root/proc"
  chroot "$root" bash /kelp/fresh_debian.sh
}

port_hosts() {
  need libglm-dev libxxhash-dev libzstd-dev dpkg-dev cmake ninja-build
  mkdir -p build/ports
  fetch_zstd
  cmake -DTEST_DIR="$PWD/tests/install" -DKELP_SOURCE_DIR="$PWD" -DWORK_DIR="$PWD/build/ports/hosts" \
    -DGENERATOR=Ninja -DCXX_COMPILER=c++ -DLAUNCHER= -DGLM_INCLUDE_DIR=/usr/include \
    -DXXHASH_INCLUDE_DIR=/usr/include -DZSTD_LIBRARY="$(c++ -print-file-name=libzstd.a)" \
    -DZSTD_SOURCE="$PWD/build/ports/zstd" -P tests/install/host_test.cmake
}

port_windows() {
  need g++-mingw-w64-x86-64-posix wine64
  prepare windows -DCMAKE_TOOLCHAIN_FILE="$PWD/tools/cmake/toolchain_windows.cmake"
  prepare_googletest windows -DCMAKE_TOOLCHAIN_FILE="$PWD/tools/cmake/toolchain_windows.cmake"
  cmake --preset windows
  cmake --build --preset windows
  WINEPREFIX="$PWD/build/ports/wine" WINEDEBUG=-all ctest --preset windows
}

# The page of samples/web in real browsers, with kelp-bake and kelp-render of this checkout.
test_page() {
  local programs=$PWD/build/release/bin page=build/web_page/page out=build/web_page/tests failed=0 browser
  if [ -n "${KELP_PROGRAMS:-}" ]; then
    programs=$KELP_PROGRAMS
  else
    tools/setup.sh
    cmake --preset release >build/ports/web/release.log
    cmake --build --preset release --target kelp-bake kelp-render
  fi
  KELP_BAKE=$programs/kelp-bake samples/web/build.sh
  cmake -S tests/web -B build/web_page/native -G Ninja -DCMAKE_BUILD_TYPE=Release \
    >build/ports/web/native.log
  cmake --build build/web_page/native --target kelp_camera
  python3 -B tests/web/sizes.py "$page"
  python3 -B tests/web/package.py "$page" build/web_page/package || failed=1
  for browser in firefox chromium; do
    python3 -B tests/web/browsers.py "$browser" "$page" "$out" "$programs" \
      build/web_page/native/kelp_camera || failed=1
  done
  [ "$failed" -eq 0 ] || fail "the package, or the page in a browser, failed"
}

port_web() {
  need emscripten nodejs chromium firefox-esr xvfb xauth python3 brotli node-typescript
  command -v npm >/dev/null || need npm  # a nodejs that is not Debian's brings its own
  if [ "${KELP_WEB:-}" = page ]; then
    mkdir -p build/ports/web
    test_page
    return
  fi
  # where Debian's modules are; a node that is not Debian's does not look there
  export NODE_PATH=/usr/share/nodejs
  export NODE_OPTIONS=--no-experimental-fetch  # emscripten 3.1.6 takes a node with fetch() for a browser
  local toolchain=/usr/share/emscripten/cmake/Modules/Platform/Emscripten.cmake
  prepare web -DCMAKE_TOOLCHAIN_FILE=$toolchain
  prepare_googletest web -DCMAKE_TOOLCHAIN_FILE=$toolchain -DCMAKE_CXX_FLAGS=-fexceptions \
    -Dgtest_disable_pthreads=ON
  cmake --preset web
  cmake --build --preset web
  ctest --preset web
  # A page, against what is installed; without exceptions, as pages are.
  cmake --install build/web --prefix "$PWD/build/ports/web/kelp" >build/ports/web/install.log
  cmake -S tests/install/web -B build/ports/web/page -G Ninja -DCMAKE_TOOLCHAIN_FILE=$toolchain \
    -DCMAKE_BUILD_TYPE=Release -DCMAKE_FIND_ROOT_PATH="$PWD/build/ports/web/kelp;$PWD/build/ports/web/prefix"
  cmake --build build/ports/web/page
  local said
  said=$(node build/ports/web/page/draw.js tests/formats/golden/solid.kelp 2>&1 || true)
  echo "$said"
  [[ "$said" == *"parts loaded"*"no WebGL 2 here"* ]] || fail "the page did not load its pack"
  test_page
}

main() {
  case "${1:-}" in
    debian|hosts|windows|web) "port_$1" ;;
    -h|--help) sed -n '3,15s/^# \{0,1\}//p' "${BASH_SOURCE[0]}" ;;
    *) fail "give one of debian, hosts, windows, web; see --help" ;;
  esac
}

main "$@"; exit  # read as a whole: the file may change while the tests run
