#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
#
# version.sh ROOT [PROGRAM]: CMakeLists.txt, CITATION.cff, the newest heading of CHANGELOG.md and
# `PROGRAM --version` must state the same version.
set -euo pipefail

root=${1:?usage: version.sh ROOT [PROGRAM]}
program=${2:-}

cmake=$(sed -nE 's/^project\(.*VERSION ([0-9.]+).*/\1/p' "$root/CMakeLists.txt")
citation=$(sed -nE 's/^version: *"?([0-9.]+)"?$/\1/p' "$root/CITATION.cff")
changelog=$(sed -nE 's/^## \[([0-9.]+)\].*/\1/p' "$root/CHANGELOG.md" | head -n 1)
status=0

expect() {
  if [[ -z "$2" || "$2" != "$cmake" ]]; then
    printf '%s says "%s", CMakeLists.txt says "%s"\n' "$1" "$2" "$cmake"
    status=1
  fi
}

expect CITATION.cff "$citation"
expect CHANGELOG.md "$changelog"
if [[ -n "$program" ]]; then
  expect "$(basename "$program") --version" "$("$program" --version | grep -oE '[0-9]+\.[0-9]+\.[0-9]+' | head -n 1)"
fi
exit "$status"
