#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# clang-tidy (.clang-tidy) and cppcheck over formats, runtime, tools and samples. Opt-in: takes an hour on two
# cores; tests/run.sh alone does not need it.
#   tests/lint.sh [FOLDER...]   checks those folders only
# Exceptions stand, each with its reason, in .clang-tidy or at their place (NOLINT, cppcheck-suppress). Fails on
# any other finding.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

source tests/support/opt_in.sh

case "${1:-}" in
  -h|--help) sed -n '3,5s/^# \{0,1\}//p' "${BASH_SOURCE[0]}"; exit 0 ;;
  -*) fail "unknown option '$1'; see --help" ;;
esac
need clang-tidy cppcheck
folders=("$@")
[ ${#folders[@]} -gt 0 ] || folders=(formats runtime tools samples)

cmake --preset dev >/dev/null
# Generated sources are made first.
ninja -C build/dev -t targets all | sed -n 's/: CUSTOM_COMMAND$//p' | grep -E '\.(cpp|h)$' |
  xargs -r ninja -C build/dev >/dev/null
mapfile -t sources < <(python3 - "${folders[@]}" <<'PY'
import json, os, sys
entries = json.load(open("build/dev/compile_commands.json"))
names = {os.path.relpath(os.path.join(entry["directory"], entry["file"])) for entry in entries}
folders = tuple(folder.rstrip("/") + "/" for folder in sys.argv[1:])
print("\n".join(sorted(name for name in names if name.startswith(folders))))
PY
)
[ -n "${sources[0]:-}" ] || fail "no sources in: ${folders[*]}"
failed=0
# The builds name warnings that only GCC knows; clang-tidy ignores them.
printf '%s\n' "${sources[@]}" |
  xargs -P "$(nproc)" -n 1 clang-tidy -p build/dev --quiet --warnings-as-errors='*' \
    --extra-arg=-Wno-unknown-warning-option 2> >(grep -v ' warnings\? generated' >&2) || failed=1
folders=("${folders[@]%/}")
filters=("${folders[@]/#/--file-filter=}")  # --file-filter=FOLDER/*
# passedByValue: GLSL has no references. constStatement: cppcheck takes braces after an index for a statement.
cppcheck --quiet -j "$(nproc)" --project=build/dev/compile_commands.json "${filters[@]/%//*}" \
  --enable=warning,performance,portability --inline-suppr --error-exitcode=1 \
  --suppress=passedByValue:shaders/*.glsl --suppress=constStatement || failed=1
exit $failed
