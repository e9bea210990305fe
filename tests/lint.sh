#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# clang-tidy (.clang-tidy) and cppcheck over what kelp ships: formats, runtime, tools, samples. Opt-in, an
# hour on two cores: tests/run.sh needs nothing of this.
#   tests/lint.sh [FOLDER...]   those folders alone
# What is let pass stands, with its reason, in .clang-tidy or at its place (NOLINT, cppcheck-suppress). Fails
# if anything else is found.
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
# sources that are generated
ninja -C build/dev -t targets all | sed -n 's/: CUSTOM_COMMAND$//p' | grep -E '\.(cpp|h)$' | xargs -r ninja -C build/dev >/dev/null
mapfile -t sources < <(python3 - "${folders[@]}" <<'PY'
import json, os, sys
names = {os.path.relpath(os.path.join(entry["directory"], entry["file"])) for entry in json.load(open("build/dev/compile_commands.json"))}
print("\n".join(sorted(name for name in names if any(name.startswith(folder.rstrip("/") + "/") for folder in sys.argv[1:]))))
PY
)
[ -n "${sources[0]:-}" ] || fail "no sources in: ${folders[*]}"
failed=0
# One that GCC alone knows is no warning of kelp's.
printf '%s\n' "${sources[@]}" | xargs -P "$(nproc)" -n 1 clang-tidy -p build/dev --quiet --warnings-as-errors='*' --extra-arg=-Wno-unknown-warning-option 2> >(grep -v ' warnings\? generated' >&2) || failed=1
folders=("${folders[@]%/}")
filters=("${folders[@]/#/--file-filter=}")  # of names beneath this folder
# GLSL has no references; it takes braces after an index for a statement of their own.
cppcheck --quiet -j "$(nproc)" --project=build/dev/compile_commands.json "${filters[@]/%//*}" --enable=warning,performance,portability --inline-suppr --error-exitcode=1 \
  --suppress=passedByValue:shaders/*.glsl --suppress=constStatement || failed=1
exit $failed
