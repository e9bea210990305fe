# SPDX-License-Identifier: MIT
# Sourced by tests/ports.sh and samples/web/build.sh: kelp's dependencies for another system. The working
# directory is the top of the checkout.

source tests/support/opt_in.sh

# Makes build/ports/SYSTEM/prefix: headers of this machine's packages, and zstd from the source that Debian
# has of it. prepare SYSTEM CMAKE_ARGUMENT...
prepare() {
  local system=$1 work=$PWD/build/ports
  shift
  local prefix=$work/$system/prefix
  need libglm-dev libxxhash-dev nlohmann-json3-dev libcli11-dev libfmt-dev dpkg-dev cmake ninja-build
  [ -e "$prefix/complete" ] && return 0
  mkdir -p "$prefix/include" "$prefix/share/cmake"
  cp -r /usr/include/{glm,nlohmann,CLI,fmt,xxhash.h} "$prefix/include/"
  cp -r /usr/share/cmake/glm /usr/share/cmake/nlohmann_json /usr/share/cmake/CLI11 "$prefix/share/cmake/"
  mkdir -p "$prefix/share/cmake/fmt"  # its headers alone, in place of this machine's library
  cat >"$prefix/share/cmake/fmt/fmt-config.cmake" <<END
if(TARGET fmt::fmt)
  return()
endif()
add_library(fmt::fmt INTERFACE IMPORTED)
target_compile_definitions(fmt::fmt INTERFACE FMT_HEADER_ONLY)
target_include_directories(fmt::fmt INTERFACE "$prefix/include")
END
  fetch_zstd
  build_dependency "$work/zstd/build/cmake" "$work/$system/zstd" "$prefix" \
    -DZSTD_BUILD_PROGRAMS=OFF -DZSTD_BUILD_SHARED=OFF -DZSTD_MULTITHREAD_SUPPORT=OFF "$@"
  touch "$prefix/complete"
}

# Adds GoogleTest to the prefix. prepare_googletest SYSTEM CMAKE_ARGUMENT...
prepare_googletest() {
  local system=$1 work=$PWD/build/ports
  shift
  local prefix=$work/$system/prefix
  need libgtest-dev
  [ -e "$prefix/googletest_complete" ] && return 0
  build_dependency /usr/src/googletest "$work/$system/googletest" "$prefix" -DBUILD_GMOCK=OFF "$@"
  touch "$prefix/googletest_complete"
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
