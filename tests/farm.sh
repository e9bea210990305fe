#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# Bakes a table with the workflow of samples/farm: on this machine, and on a Slurm of this machine alone,
# where one job is killed midway and another is cancelled. The packs must be those of kelp-bake, byte for
# byte. Opt-in: takes minutes; tests/run.sh does not need it.
#   tests/farm.sh [KELP_BAKE]   default: build/dev/bin/kelp-bake, built if it is missing
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

case "${1:-}" in
  -h|--help) sed -n '3,6s/^# \{0,1\}//p' "${BASH_SOURCE[0]}"; exit 0 ;;
esac
source tests/support/opt_in.sh
need snakemake munge slurm-wlm

kelp_bake=${1:-build/dev/bin/kelp-bake}
if [ $# -eq 0 ] && [ ! -x "$kelp_bake" ]; then
  cmake --preset dev && cmake --build --preset dev --target kelp-bake
fi
for where in Local Slurm; do
  python3 -B tests/samples/check_farm.py "$where" "$kelp_bake" samples/farm -v
done
