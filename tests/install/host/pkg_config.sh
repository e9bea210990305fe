#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# pkg_config.sh CXX PREFIX PACK: builds host.cpp by pkg-config, with what of it is shared and all static.
set -euo pipefail
cxx=$1 prefix=$2 pack=$3
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
PKG_CONFIG_PATH=$(dirname "$(find "$prefix/" -name kelp-runtime.pc)")
export PKG_CONFIG_PATH
source=$(dirname "${BASH_SOURCE[0]}")/host.cpp
# shellcheck disable=SC2046
"$cxx" -std=c++20 "$source" -o "$work/host" $(pkg-config --cflags --libs kelp-runtime)
# shellcheck disable=SC2046
"$cxx" -std=c++20 -static "$source" -o "$work/static" $(pkg-config --static --cflags --libs kelp-runtime)
"$work/host" "$pack"
"$work/static" "$pack"
