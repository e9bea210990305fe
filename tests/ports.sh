#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# Tests kelp on other systems than the one that builds it. Opt-in: tests/run.sh does not need it.
#   tests/ports.sh debian    makes the Debian packages, checks them with lintian, installs them into a fresh
#                            Debian and uses them there (as root; downloads some 500 MB)
#   tests/ports.sh windows   cross-compiles the runtime and kelp-dump with mingw-w64, runs their tests in wine
#   tests/ports.sh web       compiles the runtime with emscripten, runs its tests in node, links a program
#                            with WebGL 2
# Names the packages to install if one is missing. Everything goes to build/.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

source tests/support/opt_in.sh

# Kelp's dependencies for another system, in build/ports/SYSTEM/prefix: headers of this machine's packages,
# zstd and GoogleTest from the sources that Debian has of them. prepare SYSTEM CMAKE_ARGUMENT...
prepare() {
  local system=$1 work=$PWD/build/ports
  shift
  local prefix=$work/$system/prefix
  need libglm-dev libxxhash-dev nlohmann-json3-dev libcli11-dev libfmt-dev libgtest-dev dpkg-dev cmake \
    ninja-build
  [ -e "$prefix/complete" ] && return 0
  mkdir -p "$prefix/include" "$prefix/share/cmake"
  cp -r /usr/include/{glm,nlohmann,CLI,fmt,xxhash.h} "$prefix/include/"
  cp -r /usr/share/cmake/glm /usr/share/cmake/nlohmann_json /usr/share/cmake/CLI11 "$prefix/share/cmake/"
  mkdir -p "$prefix/share/cmake/fmt"  # its headers alone, in place of this machine's library
  cat >"$prefix/share/cmake/fmt/fmt-config.cmake" <<END
add_library(fmt::fmt INTERFACE IMPORTED)
target_compile_definitions(fmt::fmt INTERFACE FMT_HEADER_ONLY)
target_include_directories(fmt::fmt INTERFACE "$prefix/include")
END
  fetch_zstd
  build_dependency "$work/zstd/build/cmake" "$work/$system/zstd" "$prefix" \
    -DZSTD_BUILD_PROGRAMS=OFF -DZSTD_BUILD_SHARED=OFF -DZSTD_MULTITHREAD_SUPPORT=OFF "$@"
  build_dependency /usr/src/googletest "$work/$system/googletest" "$prefix" -DBUILD_GMOCK=OFF "$@"
  touch "$prefix/complete"
}

build_dependency() {
  local source=$1 build=$2 prefix=$3
  shift 3
  {
    cmake -S "$source" -B "$build" -G Ninja -DCMAKE_BUILD_TYPE=Release -DCMAKE_INSTALL_PREFIX="$prefix" \
      -DKELP_PORT_PREFIX="$prefix" "$@" && cmake --build "$build" && cmake --install "$build"
  } >"$build.log" 2>&1 || { tail -20 "$build.log" >&2; fail "$source did not build, see $build.log"; }
}

# The Debian repository that apt on this machine is configured with: "URI SUITE".
debian_repository() {
  local suite found
  suite=$(. /etc/os-release && echo "$VERSION_CODENAME")
  found=$(apt-get indextargets --format '$(REPO_URI) $(RELEASE)' 'Created-By: Packages' 'Origin: Debian' \
    'Component: main' "Codename: $suite")
  [ -n "$found" ] || fail "apt has no repository of Debian's $suite; add it, then apt-get update"
  head -n 1 <<<"$found"
}

# zstd's source from Debian: the version that libzstd-dev has. apt checks its signature. A list of sources of
# its own leaves this machine's lists as they are.
fetch_zstd() {
  local work=$PWD/build/ports repository
  [ -d "$work/zstd" ] && return 0
  repository=$(debian_repository)
  rm -rf "$work/apt" "$work/source" && mkdir -p "$work/apt/lists/partial" "$work/source"
  echo "deb-src [signed-by=/usr/share/keyrings/debian-archive-keyring.gpg] $repository main" \
    >"$work/apt/sources.list"
  (
    cd "$work/source" || exit 1
    own_apt() {
      apt-get -qq -o Dir::Etc::SourceList="$work/apt/sources.list" -o Dir::Etc::SourceParts=/nonexistent \
        -o Dir::State::Lists="$work/apt/lists" -o Dir::Cache::pkgcache= -o Dir::Cache::srcpkgcache= \
        -o APT::Sandbox::User=root "$@"
    }
    own_apt update && own_apt source --download-only libzstd &&
      dpkg-source --no-check -x libzstd_*.dsc "$work/zstd"
  ) >"$work/source.log" 2>&1 ||
    { tail -5 "$work/source.log" >&2; fail "no source of zstd from Debian, see $work/source.log"; }
}

port_debian() {
  [ "$(id -u)" -eq 0 ] || fail "debian: needs root, to make a fresh Debian in a folder"
  need lintian debootstrap dpkg-dev gzip
  rm -f build/package/*.deb
  cmake --workflow --preset package
  # No manual pages: --help has it all. No bug of Debian's asks for the packages.
  lintian --allow-root --fail-on error --suppress-tags no-manual-page,initial-upload-closes-no-bugs \
    build/package/*.deb
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
  cp -r tests/install/consumer tests/install/consumer_c tests/install/packs "$root/kelp"
  cp tests/install/fresh_debian.sh "$root/kelp"
  cp /etc/resolv.conf "$root/etc/resolv.conf"
  chroot "$root" bash /kelp/fresh_debian.sh
}

port_windows() {
  need g++-mingw-w64-x86-64-posix wine64
  prepare windows -DCMAKE_TOOLCHAIN_FILE="$PWD/tools/cmake/toolchain_windows.cmake"
  cmake --preset windows
  cmake --build --preset windows
  WINEPREFIX="$PWD/build/ports/wine" WINEDEBUG=-all ctest --preset windows
}

port_web() {
  need emscripten nodejs
  # where Debian's modules are; a node that is not Debian's does not look there
  export NODE_PATH=/usr/share/nodejs
  export NODE_OPTIONS=--no-experimental-fetch  # emscripten 3.1.6 takes a node with fetch() for a browser
  local toolchain=/usr/share/emscripten/cmake/Modules/Platform/Emscripten.cmake
  prepare web -DCMAKE_TOOLCHAIN_FILE=$toolchain -DCMAKE_CXX_FLAGS=-fexceptions -Dgtest_disable_pthreads=ON
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
}

main() {
  case "${1:-}" in
    debian|windows|web) "port_$1" ;;
    -h|--help) sed -n '3,9s/^# \{0,1\}//p' "${BASH_SOURCE[0]}" ;;
    *) fail "give one of debian, windows, web; see --help" ;;
  esac
}

main "$@"; exit  # read as a whole: the file may change while the tests run
