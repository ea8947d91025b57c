#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
#
# completion_test.sh PROGRAM COMPLETION: what a shell would offer.
set -euo pipefail
tested=$(realpath "$1")
# shellcheck source=/dev/null
source "$2"

failures=0

# offers WORDS... -- EXPECTED...: every expected word is offered after the words.
offers() {
  COMP_WORDS=("$tested")
  while [[ $1 != @ ]]; do
    COMP_WORDS+=("$1")
    shift
  done
  shift
  COMP_CWORD=$((${#COMP_WORDS[@]} - 1))
  COMPREPLY=()
  _spheretree
  local expected
  for expected in "$@"; do
    if [[ " ${COMPREPLY[*]} " != *" $expected "* ]]; then
      echo "after '${COMP_WORDS[*]:1}' there is no '$expected' in: ${COMPREPLY[*]}"
      failures=$((failures + 1))
    fi
  done
}

# exactly WORDS... @ EXPECTED...: these and no others.
exactly() {
  offers "$@"
  local words=("$@")
  while [[ ${words[0]} != @ ]]; do words=("${words[@]:1}"); done
  if ((${#COMPREPLY[@]} != ${#words[@]} - 1)); then
    echo "after '${COMP_WORDS[*]:1}' there are others in: ${COMPREPLY[*]}"
    failures=$((failures + 1))
  fi
}

work=$(mktemp -d)
trap 'rm -r "$work"' EXIT
touch "$work/chair one.obj"

offers "" @ build batch compare eval list --help
exactly "bu" @ build
exactly "build" "--lev" @ --levels
offers "build" "-" @ -o --output --builder --quality
exactly "build" "--quality" "" @ fast normal best
exactly "build" "--quality" "n" @ normal
offers "batch" "in" "-o" "out" "--" @ --jobs --shard --merge-summaries
exactly "eval" "--frame" "b" @ box-centred
cd "$work"
exactly "build" "ch" @ "chair one.obj"
exit $((failures > 0 ? 1 : 0))
