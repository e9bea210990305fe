#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# Usage: translate.sh OUT_DIR [OPTION...]
#
# Translates every program of kelp's for Vulkan and others: OUT_DIR/spirv (for Vulkan 1.1, validated), hlsl
# (shader model 5.1), msl (Metal 2.1) and essl (OpenGL ES 3.1), and lists them in OUT_DIR/programs.txt.
# BINDINGS.md says what they need. OPTION is for glslangValidator:
#   -DKELP_SET=2                       other sets and bindings: uniforms.glsl
#   -DKELP_HOST_SURFACE -IFOLDER       the host's look: FOLDER/kelp_surface.glsl defines kelpSurface
set -euo pipefail

if [ $# -lt 1 ] || [[ $1 == -* ]]; then
  sed -n '3,/^set/ { /^#/ s/^# \{0,1\}//p; }' "$0"
  [ "${1:-}" = --help ] && exit 0 || exit 1
fi
for tool in glslangValidator:glslang-tools spirv-val:spirv-tools spirv-cross:spirv-cross; do
  command -v "${tool%:*}" >/dev/null ||
    { echo "translate.sh: ${tool%:*} is not installed: install the package ${tool#*:}" >&2; exit 1; }
done
out=$1 options=("${@:2}") shaders=$(cd "$(dirname "$0")" && pwd)
mkdir -p "$out"/{spirv,hlsl,msl,essl}

programs() {
  printf '%s\n' draw.vert "draw.vert KELP_CAGED_ONLY" lines.vert lines.frag "draw.frag KELP_DEBUG"
  for look in "" " KELP_GRADIENT_ONLY"; do
    for rays in "" " KELP_SECONDARY_RAYS"; do
      for parts in "" " KELP_SHEARED_ONLY" " KELP_SWEPT_ONLY" " KELP_CAGED_ONLY" " KELP_DISTANCES"; do
        echo "draw.frag$parts$rays$look"
      done
    done
  done
  for parts in SHEARED SWEPT; do
    echo "fog.frag KELP_${parts}_ONLY KELP_DEBUG"
    for heat in "" " KELP_FOG_HEAT"; do
      for shadow in "" " KELP_FOG_SHADOW"; do echo "fog.frag KELP_${parts}_ONLY$heat$shadow"; done
    done
  done
}

# Runs a tool that is silent when all is well.
quietly() {
  local said
  if ! said=$("$@" 2>&1) || [ -n "$said" ]; then
    printf 'translate.sh: %s:\n%s\n' "$*" "$said" >&2
    exit 1
  fi
}

# FILE [DEFINE...]
translate() {
  local defines=("${@:2}") stage=${1##*.} name spirv
  name=${1%.*}$(printf %s "${@:2}" | tr '[:upper:]' '[:lower:]' | sed 's/kelp_/_/g; s/_only//g; s/_fog//g')
  spirv=$out/spirv/$name.$stage.spv
  quietly glslangValidator --quiet --target-env vulkan1.1 -DKELP_VULKAN ${defines[@]+"${defines[@]/#/-D}"} \
    ${options[@]+"${options[@]}"} \
    "$shaders/$1" -o "$spirv"
  quietly spirv-val --target-env vulkan1.1 "$spirv"
  quietly spirv-cross "$spirv" --hlsl --shader-model 51 --output "$out/hlsl/$name.$stage.hlsl"
  quietly spirv-cross "$spirv" --msl --msl-version 20100 --msl-decoration-binding \
    --output "$out/msl/$name.$stage.metal"
  quietly spirv-cross "$spirv" --es --version 310 --output "$out/essl/$name.$stage"
  echo "$name.$stage: $*"
}

while read -ra program; do translate "${program[@]}"; done < <(programs) | sort >"$out/programs.txt"
