#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# Builds and tests kelp from nothing on Debian 12: installs what is missing, builds, tests.
#   tests/run.sh                the build that samples/demo.sh makes (preset release), and all its tests
#   tests/run.sh --sanitizers   the code that reads untrusted bytes, and the shaders' C++, built by clang
#                               with the address and the undefined-behavior sanitizer (preset asan)
#   tests/run.sh --all          takes hours. Both of these; with assertions and every case (preset dev,
#                               KELP_ALL_TESTS); without the baker, by gcc and clang, optimized and not;
#                               with the thread sanitizer (preset tsan); the packs of six builds, byte by
#                               byte (tests/cli/same_packs.sh); the coverage of the fuzzers' seeds
#                               (tests/fuzz.sh --coverage); clang-tidy and cppcheck (tests/lint.sh)
#   --require-assets            with any of these: fails if tests are skipped, except tests of opt-in packages
# Ends with a line that counts the tests: N passed, N failed, N skipped. Names the skipped tests and why.
set -uo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

require_assets=0 mode=default
for argument in "$@"; do
  case "$argument" in
    --require-assets) require_assets=1 ;;
    --sanitizers) mode=sanitizers ;;
    --all) mode=all ;;
    -h|--help) sed -n '3,12s/^# \{0,1\}//p' "${BASH_SOURCE[0]}"; exit 0 ;;
    *) echo "run.sh: unknown option '$argument'; see --help" >&2; exit 1 ;;
  esac
done

export CCACHE_BASEDIR="$PWD" CCACHE_NOHASHDIR=1  # ccache shares objects between checkouts
case "$mode" in
  default) sets=(tests) presets=(release) ;;
  sanitizers) sets=(tests sanitizers) presets=(asan) ;;
  all)
    sets=(tests sanitizers lint)
    presets=(release asan dev runtime-only gcc-debug clang-release tsan) ;;
esac
for set in "${sets[@]}"; do tools/setup.sh "$set" || exit 1; done
passed=0 failed=0 skipped=0

# Builds a preset, runs its tests and adds up their results from ctest's report.
run_preset() {
  local preset=$1 report="$PWD/build/$1/tests.xml" log="build-$1.log" counts
  cmake --preset "$preset" >"$log" 2>&1 || { cat "$log"; rm -f "$log"; return 1; }
  rm -f "$log" "$report"
  cmake --build --preset "$preset" || return 1
  # one more than there are processors, because some tests wait most of their time
  ctest --preset "$preset" --parallel "$(($(nproc) + 1))" --output-junit "$report"
  [ -s "$report" ] || return 1
  counts=$(python3 -B tests/support/count_tests.py "$report") || return 1
  set -- $counts
  passed=$((passed + $1)) failed=$((failed + $2)) skipped=$((skipped + $3))
}

broken=0
for preset in "${presets[@]}"; do
  unset KELP_ALL_TESTS
  [ "$preset" != dev ] || export KELP_ALL_TESTS=1
  run_preset "$preset" || { echo "run.sh: preset $preset did not build or test" >&2; broken=1; }
done
if [ "$mode" = all ]; then
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
