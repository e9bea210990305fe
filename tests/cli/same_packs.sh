#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# Builds kelp-bake in six ways and compares what they bake, byte by byte: gcc and clang, each Debug and
# Release; gcc with AVX2 and FMA in all of the code; gcc without kelp's own vector code. Opt-in: the first run
# takes an hour on two cores. Needs clang: apt-get install clang
#   tests/cli/same_packs.sh [BUILD_FOLDER]        (default build/same; tests/run.sh --all calls it)
set -euo pipefail
here="$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)"
sources="$(cd "$here/../.." && pwd)"
build="${1:-$sources/build/same}"
for program in g++ clang++; do
  command -v "$program" >/dev/null ||
    { echo "same_packs.sh: $program is missing: install it first" >&2; exit 4; }
done
launcher=()
command -v ccache >/dev/null && launcher=(-DCMAKE_CXX_COMPILER_LAUNCHER=ccache)

programs=()
# build_one NAME COMPILER BUILD_TYPE [CMAKE_ARGUMENT...]
build_one() {
  local folder="$build/$1"
  cmake -S "$sources" -B "$folder" -G Ninja -DCMAKE_CXX_COMPILER="$2" -DCMAKE_BUILD_TYPE="$3" \
    "${launcher[@]}" -DKELP_WERROR=ON -DKELP_TESTS=OFF -DKELP_SAMPLES=OFF -DKELP_TOOLS=OFF "${@:4}" >/dev/null
  cmake --build "$folder" --target kelp-bake
  programs+=("$folder/bin/kelp-bake")
}
build_one gcc-release g++ Release
build_one clang-release clang++ Release
build_one gcc-debug g++ Debug
build_one clang-debug clang++ Debug
build_one gcc-avx2 g++ Release -DCMAKE_CXX_FLAGS=-march=x86-64-v3
build_one gcc-plain g++ Release -DCMAKE_DISABLE_FIND_PACKAGE_hwy=ON

python3 -B "$sources/samples/models/make_models.py" "$build/models" >/dev/null
python3 -B "$here/same_packs.py" made --full --models "$build/models" "${programs[@]}"
status=0
python3 -B "$here/same_packs.py" real --full "${programs[@]}" || status=$?
[ "$status" -eq 0 ] || [ "$status" -eq 77 ] || exit "$status"
echo "same_packs.sh: passed"
