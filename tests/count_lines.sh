#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# Prints the lines of the product and of the tests, and the words of the documents, room by room.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

# count FOLDER FILTER PATTERN...: lines (-l) or words (-w) of the files below FOLDER with these names.
count() {
  local folder=$1 what=$2 names=()
  shift 2
  for pattern in "$@"; do names+=(-o -name "$pattern"); done
  find "$folder" -name build -prune -o -name out -prune -o -type f \( "${names[@]:1}" \) -exec cat {} + |
    wc "$what"
}

code=('*.cpp' '*.h' '*.hpp' '*.c' '*.glsl' '*.inl' '*.frag' '*.vert' '*.py' '*.sh' '*.js' '*.ts' '*.cmake'
      CMakeLists.txt)
for group in "product formats runtime shaders samples tools" "tests tests"; do
  read -r name folders <<<"$group"
  total=0
  for folder in $folders; do
    lines=$(count "$folder" -l "${code[@]}")
    total=$((total + lines))
    [ "$name" != product ] || printf '%7d  %s\n' "$lines" "$folder"
  done
  printf '%7d lines of %s\n' "$total" "$name"
done
printf '%7d words of documents\n' "$(count . -w '*.md')"
