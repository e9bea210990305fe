#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# clang-tidy (.clang-tidy) and cppcheck over what kelp ships: formats, runtime, tools, samples. Opt-in, half an hour on two cores: tests/run.sh needs nothing of this.
#   tests/lint.sh [FOLDER...]   those folders alone
# What is let pass, and why, stands in .clang-tidy, in tests/lint.suppressions and at its place (NOLINT, cppcheck-suppress). Fails if anything else is found.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

case "${1:-}" in
  -h|--help) sed -n '3,5s/^# \{0,1\}//p' "${BASH_SOURCE[0]}"; exit 0 ;;
esac
for program in clang-tidy cppcheck; do
  command -v "$program" >/dev/null || { echo "lint.sh: first: apt-get install --no-install-recommends clang-tidy cppcheck" >&2; exit 1; }
done
folders=("$@")
[ ${#folders[@]} -gt 0 ] || folders=(formats runtime tools samples)
commands=build/dev/compile_commands.json
[ -e "$commands" ] || cmake --preset dev >/dev/null
ninja -C build/dev $(ninja -C build/dev -t targets all | sed -n 's/^\(.*[.]\(inc\|h\|glsl[.]cpp\)\): CUSTOM_COMMAND$/\1/p') >/dev/null  # what is generated
mapfile -t sources < <(python3 - "$commands" "${folders[@]}" <<'PY'
import json, os, sys
for entry in json.load(open(sys.argv[1])):
    name = os.path.relpath(entry["file"])
    if any(name.startswith(folder.rstrip("/") + "/") for folder in sys.argv[2:]):
        print(name)
PY
)
[ ${#sources[@]} -gt 0 ] || { echo "lint.sh: no sources in: ${folders[*]}" >&2; exit 1; }
failed=0
printf '%s\n' "${sources[@]}" | sort -u | xargs -P "$(nproc)" -n 4 clang-tidy -p build/dev --quiet --warnings-as-errors='*' --extra-arg=-Wno-unknown-warning-option || failed=1
filters=()
for folder in "${folders[@]}"; do filters+=("--file-filter=$PWD/${folder%/}/*"); done
cppcheck --quiet -j "$(nproc)" --project="$commands" "${filters[@]}" --enable=warning,performance,portability --inline-suppr --suppressions-list=tests/lint.suppressions \
  --error-exitcode=1 || failed=1
exit $failed
