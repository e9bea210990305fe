# SPDX-License-Identifier: MIT
# Sourced by the scripts that tests/run.sh does not need.

fail() { echo "$(basename "$0"): $*" >&2; exit 1; }

# need PACKAGE...: fails, and says what to do, where one is not installed.
need() {
  local missing=()
  for package in "$@"; do
    dpkg-query -W -f='${Status}' "$package" 2>/dev/null | grep -q 'ok installed' || missing+=("$package")
  done
  [ ${#missing[@]} -eq 0 ] || fail "first: apt-get install --no-install-recommends ${missing[*]}"
}
