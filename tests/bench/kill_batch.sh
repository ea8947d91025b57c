#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
#
# kill_batch.sh PROGRAM ASSETS WORK [KILLS=30] [SEED=1]: `spheretree batch` killed at random moments.
#
# Builds the folder ASSETS once undisturbed, then again and again with `kill -9` after 0 to 1.75 s, and once more
# to the end. Trees, records and pages must be the same bytes, the summary the same but for `run`, and no other
# file may be there. A round that gets through before KILLS kills are reached is compared and begun anew.
set -euo pipefail

(($# >= 3)) || { sed -n '4,4s/^# //p' "$0" >&2; exit 2; }
program=$(realpath "$1")
assets=$(realpath "$2")
work=$3
wanted=${4:-30}
RANDOM=${5:-1}

mkdir -p "$work"
cd "$work"
rm -rf whole killed

batch() { "$program" batch "$assets" -o "$1" --builder octree --pages --jobs 2 --quiet 2>/dev/null; }

# Everything in the folder, hidden files too, with its hash; the summary without `run`, and without its copies.
contents() {
  (
    cd "$1"
    find . -type f ! -name 'summary.*' -print0 | sort -z | xargs -0 sha256sum
    python3 -c 'import json; s = json.load(open("summary.json")); del s["run"]; print(json.dumps(s))'
    ls summary.*
  )
}

code=0
batch whole || code=$?
contents whole >whole.txt

kills=0
rounds=0
while ((kills < wanted)); do
  rm -rf killed
  while ((kills < wanted)); do
    "$program" batch "$assets" -o killed --builder octree --pages --jobs 2 --quiet 2>/dev/null &
    process=$!
    sleep "$(printf '%d.%03d' $((RANDOM % 2)) $((RANDOM % 750)))"
    kill -9 "$process" 2>/dev/null || true
    status=0
    wait "$process" 2>/dev/null || status=$?
    ((status == 137)) || break  # it was through before
    kills=$((kills + 1))
  done
  again=0
  batch killed || again=$?
  rounds=$((rounds + 1))
  contents killed >killed.txt
  if ((again != code)) || ! cmp whole.txt killed.txt; then
    diff whole.txt killed.txt >&2 || true
    echo "kill_batch.sh: after $kills kills something differs: $work/whole and $work/killed" >&2
    exit 1
  fi
done
echo "$kills kills in $rounds rounds, $(grep -c . whole.txt) files and lines the same each time, nothing left behind"
