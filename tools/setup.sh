#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# Installs what is missing to build kelp on Debian 12. Does nothing, and needs no rights, when all is there.
#   tools/setup.sh             everything that is built: programs and samples
#   tools/setup.sh runtime     for the runtime, kelp-dump and kelp-render alone
#   tools/setup.sh tests       for tests/run.sh
#   tools/setup.sh sanitizers  for tests/run.sh --sanitizers, besides
#   tools/setup.sh lint        for tests/lint.sh
#   tools/setup.sh farm        for samples/farm; nothing else needs it (some 700 MB)
#   tools/setup.sh web         for samples/web, besides (some 800 MB)
#   tools/setup.sh pictures    for samples/pictures/figures.sh, besides
set -euo pipefail

build=(g++ cmake ninja-build ccache pkg-config python3)
runtime=(libglm-dev libzstd-dev libxxhash-dev libfmt-dev libcli11-dev nlohmann-json3-dev libpng-dev
         libopenmesh-dev  # kelp-dump extract --proxy
         libegl-dev libgl-dev libgles-dev libopengl-dev libegl1 libegl-mesa0 libgl1-mesa-dri libgtest-dev
         python3-jsonschema   # tests only: published schemas by another validator
         python3-numpy)       # tests only: kelp.py
baker=(libopenvdb-dev libnanovdb-dev libboost-iostreams-dev libtbb-dev libblosc-dev zlib1g-dev
       libtinygltf-dev libdraco-dev
       libmeshoptimizer-dev libstb-dev libeigen3-dev libjpeg62-turbo-dev libwebp-dev libhwy-dev libseccomp-dev
       make)  # tests only: it reads the rules of kelp-bake -MD
samples=(libglfw3-dev libsdl2-dev libimgui-dev xvfb xauth libxtst6)
format=(clang-format mypy)  # tests/check_house.py, kelp.py
manual=(groff-base mandoc man-db desktop-file-utils shared-mime-info libglib2.0-bin)  # tests/install
sanitizers=(clang libclang-rt-14-dev lld llvm)
lint=(clang-tidy cppcheck)
vulkan=(glslang-tools spirv-tools spirv-cross)  # shaders/translate.sh
farm=(snakemake slurm-wlm munge)
web=(emscripten nodejs dpkg-dev)
pictures=(webp)  # img2webp

case "${1:-all}" in
  all) packages=("${build[@]}" "${runtime[@]}" "${baker[@]}" "${samples[@]}") ;;
  tests)
    packages=("${build[@]}" "${runtime[@]}" "${baker[@]}" "${samples[@]}" "${format[@]}" "${manual[@]}"
              "${vulkan[@]}") ;;
  sanitizers) packages=("${build[@]}" "${sanitizers[@]}") ;;
  runtime) packages=("${build[@]}" "${runtime[@]}") ;;
  lint) packages=("${build[@]}" "${runtime[@]}" "${baker[@]}" "${samples[@]}" "${lint[@]}") ;;
  farm) packages=("${farm[@]}") ;;
  web) packages=("${web[@]}") ;;
  pictures) packages=("${pictures[@]}") ;;
  *)
    echo "setup.sh: unknown set '$1': give 'all', 'runtime', 'tests', 'sanitizers', 'lint', 'farm', 'web'" \
      "or 'pictures'" >&2
    exit 1 ;;
esac

missing=()
for package in "${packages[@]}"; do
  dpkg-query -W -f='${Status}' "$package" 2>/dev/null | grep -q 'ok installed' || missing+=("$package")
done
[ ${#missing[@]} -eq 0 ] && exit 0

as_root=()
if [ "$(id -u)" -ne 0 ]; then
  command -v sudo >/dev/null ||
    { echo "setup.sh: run as root, or install sudo; missing packages: ${missing[*]}" >&2; exit 1; }
  as_root=(sudo)
fi
echo "Installing: ${missing[*]}" >&2
export DEBIAN_FRONTEND=noninteractive
"${as_root[@]}" apt-get update -qq >&2
"${as_root[@]}" apt-get install -y -qq --no-install-recommends "${missing[@]}" >&2
