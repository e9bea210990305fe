#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# pkg_config.sh CC PREFIX PACK: builds ask.c by pkg-config, with the shared library and with the static ones,
# and runs both.
set -euo pipefail
cc=$1 prefix=$2 pack=$3
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
config=$(dirname "$(find "$prefix/" -name kelp.pc)")
export PKG_CONFIG_PATH=$config LD_LIBRARY_PATH=${config%/pkgconfig}
strict=(-std=c99 -Wall -Wextra -pedantic -Werror)
source=$(dirname "${BASH_SOURCE[0]}")/ask.c
# shellcheck disable=SC2046
"$cc" "${strict[@]}" "$source" -o "$work/shared" $(pkg-config --cflags --libs kelp)
# shellcheck disable=SC2046
"$cc" "${strict[@]}" -static "$source" -o "$work/static" $(pkg-config --static --cflags --libs kelp)
"$work/shared" "$pack"
"$work/static" "$pack"
