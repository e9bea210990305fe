#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# kelp-dump for Windows under wine, on the golden packs: kelp_dump_windows_test.sh WINE KELP_DUMP.exe
# SOURCE_FOLDER
set -euo pipefail
wine=$1 program=$(realpath "$2") source=$(realpath "$3")
golden=$source/tests/formats/golden
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cd "$work"
cp "$golden"/solid.kelp tiny.kelp
cp "$golden"/fog.kelp fog.kelp

fail() { echo "kelp_dump_windows_test.sh: $*" >&2; exit 1; }
dump() { "$wine" "$program" "$@"; }

# exits CODE ARGUMENT...: what it says stays in out and err.
exits() {
  local wanted=$1 got=0
  shift
  dump "$@" >out 2>err || got=$?
  [ "$got" -eq "$wanted" ] || { cat out err >&2; fail "$*: exit code $got, not $wanted"; }
}
# says FILE WORDS: in out or err, whose lines end as they do elsewhere.
says() {
  grep -qF -- "$2" "$1" || { cat "$1" >&2; fail "'$2' is not in $1"; }
  ! grep -q $'\r' "$1" || fail "a carriage return in $1"
}

exits 0 --version; says out "kelp-dump "
exits 0 info --help; says out "Examples:"
exits 0 info tiny.kelp; says out "tiny.kelp: kelp pack"
exits 0 info fog.kelp --count --format json; says out '"schema": "kelp-dump/1"'
exits 0 verify tiny.kelp; says out "sound"
exits 0 verify fog.kelp; says out "sound"
exits 0 diff tiny.kelp tiny.kelp
exits 7 diff tiny.kelp fog.kelp
exits 0 schema rig; cmp out "$source/tools/rig/rig.schema.json"

# Standard output is bytes; names need not be ASCII.
dump extract tiny.kelp --vox - >piped.vox 2>err
cp tiny.kelp "größe ä.kelp"
exits 0 verify "größe ä.kelp"
exits 0 extract "größe ä.kelp" --vox "größe.vox"
cmp piped.vox "größe.vox"

# Errors.
exits 1; exits 1 knit; exits 1 info tiny.kelp --nonsense
exits 2 info missing.kelp; says err "check the path"
exits 2 info .; says err "is a folder"
exits 2 extract tiny.kelp --vox missing/tiny.vox
exits 2 extract tiny.kelp --vox TINY.KELP
head -c 300 tiny.kelp >cut.kelp
exits 3 info cut.kelp; exits 3 verify cut.kelp
exits 5 extract tiny.kelp --vdb tiny.vdb
exits 5 slice tiny.kelp -o tiny.png
left=$(find . -name '*.tmp')
[ -z "$left" ] || fail "left behind: $left"
echo "kelp-dump for Windows: all as elsewhere"
