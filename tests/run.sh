#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# kelp's tests, from nothing: installs what is missing (Debian 12), builds, tests.
#   tests/run.sh                    everything, by clang, watched by the address and undefined-behaviour sanitizers; then the runtime alone, optimised by gcc, without the baker's
#                                   dependencies, but for what draws
#   tests/run.sh --require-assets   the same, and every skipped test is a failure, but for those of opt-in packages (samples.farm)
#   tests/run.sh --all              besides: the runtime alone draws, on the oldest versions of OpenGL, too; and is built by gcc without optimisation and by clang as it
#                                   ships; everything optimised by gcc, all that tests can try there (KELP_ALL_TESTS);
#                                   everything as it ships; what has threads, watched by the thread sanitizer; then packs of six builds compared byte by byte (tests/cli/same_packs.sh),
#                                   what the fuzzers' seeds reach of the pack reader (tests/fuzz.sh --coverage), and clang-tidy and cppcheck (tests/lint.sh). Hours
# Ends with a line that counts the tests: N passed, N failed, N skipped.
set -uo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

require_assets=0 all=0
for argument in "$@"; do
  case "$argument" in
    --require-assets) require_assets=1 ;;
    --all) all=1 ;;
    -h|--help) sed -n '3,11s/^# \{0,1\}//p' "${BASH_SOURCE[0]}"; exit 0 ;;
    *) echo "run.sh: unknown option '$argument'; see --help" >&2; exit 1 ;;
  esac
done

export CCACHE_BASEDIR="$PWD" CCACHE_NOHASHDIR=1  # what was compiled in another checkout serves here, too
tools/setup.sh tests || exit 1
[ "$all" -eq 0 ] || tools/setup.sh lint || exit 1
passed=0 failed=0 skipped=0

# Builds a preset, runs its tests and adds up their results, as ctest's own report (JUnit) has them.
run_preset() {
  local preset=$1
  cmake --preset "$preset" >"build-$preset.log" 2>&1 || { cat "build-$preset.log"; rm -f "build-$preset.log"; return 1; }
  rm -f "build-$preset.log"
  cmake --build --preset "$preset" || return 1
  local report="$PWD/build/$preset/tests.xml"
  rm -f "$report"
  local choice=()
  [ "$all" -eq 1 ] || [ "$preset" != runtime-only ] || choice=(--label-exclude gl)
  ctest --preset "$preset" "${choice[@]}" --parallel "$(nproc)" --output-junit "$report"
  [ -s "$report" ] || return 1
  local counts
  counts=$(python3 - "$report" <<'PY'
import sys, xml.etree.ElementTree as tree
suite = tree.parse(sys.argv[1]).getroot()
total, failures, skips = (int(suite.get(k, 0)) for k in ("tests", "failures", "skipped"))
disabled = int(suite.get("disabled", 0))
lost = absent = 0  # what needs packages that are opt-in: named, and missed by nobody
for case in suite.iter("testcase"):
    if "SKIPPED (opt-in)" in (case.findtext("system-out") or ""):
        absent += 1
        print("not tried, for want of opt-in packages:", case.get("name"), file=sys.stderr)
    elif case.get("status") in ("notrun", "disabled") or case.find("skipped") is not None:
        message = case.find("skipped").get("message") if case.find("skipped") is not None else ""
        if message.startswith("SKIP_"):
            print("skipped:", case.get("name"), file=sys.stderr)
        else:  # no program, or what prepares it failed
            print("could not run:", case.get("name"), message, file=sys.stderr)
            lost += 1
print(total - failures - skips - disabled, failures + lost, skips + disabled - absent - lost)
PY
  ) || return 1
  set -- $counts
  passed=$((passed + $1)) failed=$((failed + $2)) skipped=$((skipped + $3))
}

broken=0
presets=(asan runtime-only)
[ "$all" -eq 1 ] && presets+=(gcc-debug clang-release dev release tsan)
for preset in "${presets[@]}"; do
  if [ "$preset" = dev ]; then export KELP_ALL_TESTS=1; else unset KELP_ALL_TESTS; fi
  run_preset "$preset" || { echo "run.sh: preset $preset did not build or test" >&2; broken=1; }
done

if [ "$all" -eq 1 ]; then
  for check in tests/cli/same_packs.sh "tests/fuzz.sh --coverage" tests/lint.sh; do
    if $check; then passed=$((passed + 1)); else failed=$((failed + 1)); fi
  done
fi

echo "$passed passed, $failed failed, $skipped skipped"
[ "$broken" -eq 0 ] && [ "$failed" -eq 0 ] && [ "$passed" -gt 0 ] || exit 1
if [ "$require_assets" -eq 1 ] && [ "$skipped" -gt 0 ]; then
  echo "run.sh: $skipped tests were skipped, and --require-assets allows none" >&2
  exit 1
fi
