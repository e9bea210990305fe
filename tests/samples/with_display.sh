#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# with_display.sh COMMAND...: runs the command on an X server of its own without a screen, and answers its
# exit code. Unlike xvfb-run it needs no xauth, and the server itself picks the display's number, so that any
# number of these may start at the same time. A window without a screen draws as many frames as it can, on all
# processors: tests beside it come first.
set -euo pipefail
command -v Xvfb >/dev/null || { echo "SKIPPED: no Xvfb (Debian: xvfb)"; exit 0; }

numbers=$(mktemp)
Xvfb -displayfd 3 -screen 0 1280x1024x24 -nolisten tcp 3>"$numbers" 2>/dev/null &
server=$!
trap 'kill "$server" 2>/dev/null || true; wait "$server" 2>/dev/null || true; rm -f "$numbers"' EXIT
for _ in $(seq 200); do
  [ -s "$numbers" ] && break
  kill -0 "$server" 2>/dev/null || { echo "with_display.sh: Xvfb did not start" >&2; exit 4; }
  sleep 0.05
done
[ -s "$numbers" ] || { echo "with_display.sh: Xvfb gave no display within 10 seconds" >&2; exit 4; }
DISPLAY=:$(cat "$numbers") nice -n 5 "$@"
