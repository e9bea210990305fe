#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# Checks that programs are hardened as they should ship: loaded anywhere, addresses bound at the start and
# read-only then, no stack that is code, stacks and buffers guarded.
#   tests/install/hardened.sh PROGRAM...
set -euo pipefail
weak=0
for program in "$@"; do
  lacks=()
  dynamic=$(readelf --wide --dynamic "$program")
  headers=$(readelf --wide --file-header --program-headers --notes "$program" 2>/dev/null)
  symbols=$(readelf --wide --dyn-syms "$program")
  grep -q 'Type: *DYN' <<<"$headers" || lacks+=("position-independent code")
  grep -q 'GNU_RELRO' <<<"$headers" || lacks+=("relro")
  grep -qE 'BIND_NOW|FLAGS_1.*NOW' <<<"$dynamic" || lacks+=("bindings at the start")
  grep -qE 'GNU_STACK.* RW ' <<<"$headers" || lacks+=("a stack that is no code")
  grep -q '__stack_chk_fail' <<<"$symbols" || lacks+=("stack protector")
  grep -qE '__[a-z]+_chk' <<<"$(grep -v stack_chk <<<"$symbols")" || lacks+=("fortified functions")
  if [ ${#lacks[@]} -gt 0 ]; then
    echo "$program lacks: $(IFS=,; echo "${lacks[*]}")" >&2
    weak=1
  fi
done
exit $weak
