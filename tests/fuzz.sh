#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# Fuzzes kelp: tests/fuzz/README.md says what each fuzzer reaches. Opt-in, for Debian 12 (clang). Everything
# goes to build/.
#   tests/fuzz.sh [MINUTES] [NAME...]   builds preset fuzz, then runs the named fuzzers, or all, for MINUTES
#                                       of processor time each (1), one on each processor. Their corpora
#                                       grow under build/fuzz/corpus. Ends with a table; fails if there was
#                                       a finding, and names it
#   tests/fuzz.sh --totals              processor time and executions of each fuzzer in all its runs here so
#                                       far, including those that were cut short
#   tests/fuzz.sh --coverage            the share of the pack reader's lines that the seeds of the packs'
#                                       fuzzers reach; fails at 95 % or less
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

source tests/support/opt_in.sh

build() {
  local preset=$1 log="build-$1.log"
  shift
  if ! cmake --preset "$preset" >"$log" 2>&1; then
    cat "$log" >&2
    rm -f "$log"
    fail "preset $preset did not configure"
  fi
  rm -f "$log"
  ninja -C "build/$preset" "$@"
}

# fuzz_one NAME SECONDS runs one fuzzer for so much processor time. libFuzzer counts by the clock, so it runs
# in turns. A turn takes ten minutes at most, so that little is lost when it is cut short; build/fuzz/turns
# lists them all. Leaves a line of the table in build/fuzz/log/NAME.
fuzz_one() {
  local name=$1 wanted=$2 used=0 runs=0 coverage=- code=0 left
  local program=build/fuzz/tests/fuzz/fuzz_$1 corpus=build/fuzz/corpus/$1 log=build/fuzz/log/$1
  local findings=build/fuzz/findings/$1-
  mkdir -p "$corpus" build/fuzz/findings
  rm -f "$log" && : >"$log.text"
  # Every turn reads the whole corpus. So leave out inputs that add no coverage to the others.
  rm -rf "$corpus.least" && mkdir "$corpus.least"
  # A merge leaves out an input that crashes, and goes on. That is a finding, and the corpus stays as it is.
  local merged=0
  "$program" -merge=1 -timeout=60 -report_slow_units=60 -rss_limit_mb=2048 -max_len=65536 \
    "-artifact_prefix=${findings}merge-" "$corpus.least" "$corpus" >"$log.merge" 2>&1 || merged=$?
  if grep -aq 'Test unit written to' "$log.merge"; then
    code=1
    cat "$log.merge" >>"$log.text"
  elif [ "$merged" -eq 0 ]; then
    rm -rf "$corpus" && mv "$corpus.least" "$corpus"
  fi
  rm -rf "$corpus.least"
  while left=$(awk "BEGIN { print int($wanted - $used + 0.5) }") && [ "$left" -ge 1 ] && [ "$code" -eq 0 ]; do
    local options=(-max_total_time=$((left < 600 ? left : 600)) -timeout=30 -report_slow_units=20
      -rss_limit_mb=2048 -max_len=65536 -print_final_stats=1 -artifact_prefix="$findings")
    [ -e "tests/fuzz/$name.dict" ] && options+=(-dict="tests/fuzz/$name.dict")
    local seeds=()
    for folder in $(seeds_of "$name"); do [ -d "$folder" ] && seeds+=("$folder"); done
    TIMEFORMAT="%U %S"
    { time "$program" "${options[@]}" "$corpus" "${seeds[@]}" >"$log.turn" 2>&1; } 2>"$log.time" || code=$?
    cat "$log.turn" >>"$log.text"
    tail -1 "$log.time" >"$log.seconds"  # the lines above it may tell what ended the program
    used=$(awk "{ print $used + \$1 + \$2 }" "$log.seconds")
    local of_turn
    of_turn=$(sed -n 's/^stat::number_of_executed_units: *//p' "$log.turn" | tail -1 | grep . || echo 0)
    runs=$((runs + of_turn))
    awk -v name="$name" -v runs="$of_turn" '{ print name, $1 + $2, runs }' "$log.seconds" >>build/fuzz/turns
    coverage=$(grep -ao 'cov: [0-9]*' "$log.turn" | tail -1 | cut -d' ' -f2 || true)
  done
  local minutes
  minutes=$(awk "BEGIN { print $used / 60 }")
  printf '%-12s %8.1f %12d %10s %9d\n' "$name" "$minutes" "$runs" "${coverage:--}" $((code != 0)) >"$log"
}

# The folders of a fuzzer's seeds, as in tests/fuzz/CMakeLists.txt.
seeds_of() {
  echo "tests/fuzz/seeds/$1"
  [ "$1" = pack ] && echo tests/formats/golden
  return 0
}

fuzz() {
  local minutes=1
  if [[ "${1:-}" =~ ^[0-9]+([.][0-9]+)?$ ]]; then minutes=$1; shift; fi
  need clang libclang-rt-14-dev llvm
  build fuzz
  local names=("$@")
  [ ${#names[@]} -gt 0 ] || mapfile -t names < <(
    find build/fuzz/tests/fuzz -name 'fuzz_*' -type f -perm -u+x -printf '%f\n' | sed 's/^fuzz_//' | sort)
  mkdir -p build/fuzz/log
  for name in "${names[@]}"; do
    [ -x "build/fuzz/tests/fuzz/fuzz_$name" ] || fail "there is no fuzzer '$name'"
  done
  for name in "${names[@]}"; do
    while [ "$(jobs -rp | wc -l)" -ge "$(nproc)" ]; do wait -n || true; done
    fuzz_one "$name" "$(awk "BEGIN { print 60 * $minutes }")" &
  done
  wait
  printf '%-12s %8s %12s %10s %9s\n' fuzzer CPU-min executions coverage findings
  local findings=0
  for name in "${names[@]}"; do
    local log=build/fuzz/log/$name
    if [ ! -s "$log" ]; then
      echo "$name: did not end; see $log.text"
      findings=1
      continue
    fi
    cat "$log"
    if [ "$(awk '{ print $5 }' "$log")" -ne 0 ]; then
      findings=1
      grep -aE 'ERROR|runtime error|FAULT|SUMMARY|Test unit written' "$log.text" | tail -4 | sed 's/^/    /'
    fi
  done
  return $findings
}

totals() {
  [ -s build/fuzz/turns ] || fail "no fuzzer has run here"
  printf '%-12s %8s %12s\n' fuzzer CPU-min executions
  awk '{ seconds[$1] += $2; runs[$1] += $3 }
    END { for (name in runs) printf "%-12s %8.1f %12d\n", name, seconds[name] / 60, runs[name] }' \
    build/fuzz/turns | sort
}

# All but the pack reader, as a pattern of paths. The reader is formats/ without the writers, their helpers,
# and sources of other systems.
NOT_READER='/(tests|tools|runtime|shaders|usr)/'
NOT_READER+='|_writer|_encode|raw_pack|source_windows|worker_threads'
readonly NOT_READER

coverage() {
  need clang libclang-rt-14-dev llvm
  local programs=(fuzz_pack fuzz_restamped fuzz_round_trip)
  build coverage "${programs[@]}"
  local objects=()
  rm -f build/coverage/*.profraw
  for program in "${programs[@]}"; do
    objects+=(-object "build/coverage/tests/fuzz/$program")
    local seeds=()
    for folder in $(seeds_of "${program#fuzz_}"); do [ -d "$folder" ] && seeds+=("$PWD/$folder"); done
    LLVM_PROFILE_FILE="build/coverage/$program.profraw" \
      "build/coverage/tests/fuzz/$program" 20000 "${seeds[@]}"
  done
  llvm-profdata merge -sparse -o build/coverage/all.profdata build/coverage/*.profraw
  local about=(-instr-profile build/coverage/all.profdata -ignore-filename-regex "$NOT_READER"
    "${objects[@]:1}")
  llvm-cov show "${about[@]}" >build/coverage/lines.txt 2>build/coverage/log
  llvm-cov report "${about[@]}" 2>>build/coverage/log |
    awk 'NF >= 10 { print $1, $8, $9, $10 }' >build/coverage/report
  (echo file lines missed share; cat build/coverage/report) | column -t
  echo "line by line: build/coverage/lines.txt"
  awk '/^TOTAL/ { share = $4 + 0 } END { exit share <= 95 }' build/coverage/report ||
    fail "95 % of the reader's lines or less are reached"
}

case "${1:-}" in
  -h|--help) sed -n '3,12s/^# \{0,1\}//p' "${BASH_SOURCE[0]}" ;;
  --coverage) coverage ;;
  --totals) totals ;;
  -*) fail "unknown option '$1'; see --help" ;;
  *) fuzz "$@" ;;
esac
