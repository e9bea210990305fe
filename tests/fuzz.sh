#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# Fuzzes kelp: tests/fuzz/README.md says what each fuzzer reaches. Opt-in, for Debian 12 (clang); everything
# goes to build/.
#   tests/fuzz.sh [MINUTES] [NAME...]   builds preset fuzz, then runs the fuzzers named, or all of them, for
#   MINUTES of processor time each (1), as many at once as there are
#                                       processors. Their corpora grow under build/fuzz/corpus. Ends with a
#                                       table; fails if there was a finding, which it names
#   tests/fuzz.sh --totals              processor time and executions of each fuzzer in all its runs here so
#   far, also those that were cut short
#   tests/fuzz.sh --coverage            the share of the pack reader's lines that the seeds of the packs'
#   fuzzers reach; fails at 95 % or less
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

source tests/support/opt_in.sh

build() {
  local preset=$1
  shift
  cmake --preset "$preset" >"build-$preset.log" 2>&1 || { cat "build-$preset.log" >&2; rm -f "build-$preset.log"; fail "preset $preset did not configure"; }
  rm -f "build-$preset.log"
  ninja -C "build/$preset" "$@"
}

# One fuzzer for so many seconds of processor time, in turns, since libFuzzer counts by the clock; ten minutes
# at most, so that little is lost where it is cut short. Each is noted. Leaves a line of the table in
# build/fuzz/log/NAME.
fuzz_one() {
  local name=$1 wanted=$2 used=0 runs=0 coverage=- code=0 left log=build/fuzz/log/$1
  mkdir -p "build/fuzz/corpus/$name" "build/fuzz/findings"
  rm -f "$log" && : >"$log.text"
  # Each turn begins by reading the corpus: first without what others in it reach, too.
  rm -rf "build/fuzz/corpus/$name.least" && mkdir "build/fuzz/corpus/$name.least"
  # A merge goes on after an input that crashes, and leaves it out: that is a finding, and the corpus stays.
  local merged=0
  "build/fuzz/tests/fuzz/fuzz_$name" -merge=1 -timeout=60 -report_slow_units=60 -rss_limit_mb=2048 -max_len=65536 "-artifact_prefix=build/fuzz/findings/$name-merge-" "build/fuzz/corpus/$name.least" "build/fuzz/corpus/$name" >"$log.merge" 2>&1 || merged=$?
  if grep -aq 'Test unit written to' "$log.merge"; then
    code=1
    cat "$log.merge" >>"$log.text"
  elif [ "$merged" -eq 0 ]; then
    rm -rf "build/fuzz/corpus/$name" && mv "build/fuzz/corpus/$name.least" "build/fuzz/corpus/$name"
  fi
  rm -rf "build/fuzz/corpus/$name.least"
  while left=$(awk "BEGIN { print int($wanted - $used + 0.5) }") && [ "$left" -ge 1 ] && [ "$code" -eq 0 ]; do
    local options=(-max_total_time=$((left < 600 ? left : 600)) -timeout=30 -report_slow_units=20 -rss_limit_mb=2048 -max_len=65536 -print_final_stats=1 -artifact_prefix="build/fuzz/findings/$name-")
    [ -e "tests/fuzz/$name.dict" ] && options+=(-dict="tests/fuzz/$name.dict")
    local seeds=()
    for folder in $(seeds_of "$name"); do [ -d "$folder" ] && seeds+=("$folder"); done
    TIMEFORMAT="%U %S"
    { time "build/fuzz/tests/fuzz/fuzz_$name" "${options[@]}" "build/fuzz/corpus/$name" "${seeds[@]}" >"$log.turn" 2>&1; } 2>"$log.time" || code=$?
    cat "$log.turn" >>"$log.text"
    tail -1 "$log.time" >"$log.seconds"  # above it, bash may say what ended the program
    used=$(awk "{ print $used + \$1 + \$2 }" "$log.seconds")
    local of_turn
    of_turn=$(sed -n 's/^stat::number_of_executed_units: *//p' "$log.turn" | tail -1 | grep . || echo 0)
    runs=$((runs + of_turn))
    awk -v name="$name" -v runs="$of_turn" '{ print name, $1 + $2, runs }' "$log.seconds" >>build/fuzz/turns
    coverage=$(grep -ao 'cov: [0-9]*' "$log.turn" | tail -1 | cut -d' ' -f2 || true)
  done
  printf '%-12s %8.1f %12d %10s %9d\n' "$name" "$(awk "BEGIN { print $used / 60 }")" "$runs" "${coverage:--}" $((code != 0)) >"$log"
}

# Where a fuzzer's seeds are: as tests/fuzz/CMakeLists.txt has it.
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
  [ ${#names[@]} -gt 0 ] || mapfile -t names < <(find build/fuzz/tests/fuzz -name 'fuzz_*' -type f -perm -u+x -printf '%f\n' | sed 's/^fuzz_//' | sort)
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
    [ -s "build/fuzz/log/$name" ] || { echo "$name: did not come to its end; see build/fuzz/log/$name.text"; findings=1; continue; }
    cat "build/fuzz/log/$name"
    [ "$(awk '{ print $5 }' "build/fuzz/log/$name")" -eq 0 ] || { findings=1; grep -aE 'ERROR|runtime error|FAULT|SUMMARY|Test unit written' "build/fuzz/log/$name.text" | tail -4 | sed 's/^/    /'; }
  done
  return $findings
}

totals() {
  [ -s build/fuzz/turns ] || fail "no fuzzer has run here"
  printf '%-12s %8s %12s\n' fuzzer CPU-min executions
  awk '{ seconds[$1] += $2; runs[$1] += $3 } END { for (name in runs) printf "%-12s %8.1f %12d\n", name, seconds[name] / 60, runs[name] }' build/fuzz/turns | sort
}

# All of formats/ except its writers, what only writers use, and the sources of other systems: what decides
# whether a
# pack is read, and decodes it.
readonly NOT_READER='/(tests|tools|runtime|shaders|usr)/|_writer|_encode|raw_pack|source_windows|worker_threads'

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
    LLVM_PROFILE_FILE="build/coverage/$program.profraw" "build/coverage/tests/fuzz/$program" 20000 "${seeds[@]}"
  done
  llvm-profdata merge -sparse -o build/coverage/all.profdata build/coverage/*.profraw
  local about=(-instr-profile build/coverage/all.profdata -ignore-filename-regex "$NOT_READER" "${objects[@]:1}")
  llvm-cov show "${about[@]}" >build/coverage/lines.txt 2>build/coverage/log
  llvm-cov report "${about[@]}" 2>>build/coverage/log | awk 'NF >= 10 { print $1, $8, $9, $10 }' >build/coverage/report
  (echo file lines missed share; cat build/coverage/report) | column -t
  echo "line by line: build/coverage/lines.txt"
  awk '/^TOTAL/ { share = $4 + 0 } END { exit share <= 95 }' build/coverage/report || fail "95 % of the reader's lines or less are reached"
}

case "${1:-}" in
  -h|--help) sed -n '3,8s/^# \{0,1\}//p' "${BASH_SOURCE[0]}" ;;
  --coverage) coverage ;;
  --totals) totals ;;
  -*) fail "unknown option '$1'; see --help" ;;
  *) fuzz "$@" ;;
esac
