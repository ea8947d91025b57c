#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
#
# run_experiments.sh [--quick] [BUNNY.obj]: the paper's experiments, from meshes to docs/experiments.md.
#
# Builds the toolkit (preset release), makes the trees of a bunny of 1500 triangles and of a cube, runs
# tests/bench/experiments on them and, where the program crowded_room was built, measures frames with
# rendering; then plot_experiments.py draws the pictures and writes the tables of the page. --quick tries
# the whole way in some minutes, into build/experiments only, with figures that are good for nothing.
#
# It runs one experiment after the other. Interrupted, it goes on where it was when it is started again with
# the same program and trees; tables and page change when everything is there.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/../.."

readonly work=build/experiments
readonly trees=$work/trees
readonly programs=build/release
readonly experiments=(trees figure-4 figure-5 figure-6 figure-7 figure-8 scaling movements thousand broad-phases
                      own-scaling same-state capacity endurance)
readonly rendered_counts=(100 350 500 750 1000)

die() {
  printf 'run_experiments.sh: %s\n' "$*" >&2
  exit 1
}

quick=no
bunny=build/run/bunny-1500.obj
for argument in "$@"; do
  case "$argument" in
    --quick) quick=yes ;;
    -*) die "unknown option $argument; usage: run_experiments.sh [--quick] [BUNNY.obj]" ;;
    *) bunny=$argument ;;
  esac
done
[[ -r "$bunny" ]] || die "$bunny: no such file; ./bootstrap run makes it, or name a bunny of about 1500 triangles"

results=tests/bench/results
pieces=$work/pieces
settings=()
rendered_frames=10
if [[ $quick == yes ]]; then
  results=$work/quick
  pieces=$work/quick-pieces
  settings=(frames=20 repeats=1 steps=2000)
  rendered_frames=3
fi

build() {
  # As in bootstrap: a compiler's new warnings must not stand in the way. What is configured stays as it is.
  [[ -e $programs/build.ninja ]] || cmake --preset release -DSPHERETREE_WERROR=OFF
  local targets=(spheretree make_models experiments)
  if cmake --build "$programs" --target help | grep '^crowded_room:' >/dev/null; then targets+=(crowded_room); fi
  cmake --build "$programs" --target "${targets[@]}"
}

# tree NAME MESH BUILDER LEVELS; the room draws NAME.obj for NAME.sph.
tree() {
  "$programs/cli/spheretree" build "$2" --builder "$3" --levels "$4" -o "$trees/$1.sph" --force --quiet
  cp "$2" "$trees/$1.obj"
}

# Levels count the root.
make_trees() {
  mkdir -p "$trees"
  "$programs/models/make_models" -o "$work" --only cube --force >/dev/null
  tree box-octree-2 "$work/cube.obj" octree 2
  tree box-combined-3 "$work/cube.obj" combined 3
  tree bunny-octree-4 "$bunny" octree 4
  tree bunny-octree-5 "$bunny" octree 5
  tree bunny-combined-2 "$bunny" combined 2
  tree bunny-combined-3 "$bunny" combined 3
}

# Figure 9: frames with everything, drawn off-screen.
render() {
  local reports=$work/rendered objects levels
  rm -rf "$reports"
  mkdir -p "$reports"
  for objects in "${rendered_counts[@]}"; do
    for levels in 2 3; do
      "$programs/runtime/demo/crowded_room" --headless --render --frames "$rendered_frames" --objects "$objects" \
        --broad sweep_and_prune --trees "$trees" --bunny-tree "bunny-combined-$levels" --box-tree box-octree-2 \
        --levels "$levels" --view room --report "$reports/$objects-$levels.json" || return 1
    done
  done
  tests/bench/plot_experiments.py --collect "$reports" --results "$results"
}

# What the measured pieces belong to: program, trees and settings.
key() {
  sha256sum "$programs/tests/bench/experiments" "$trees"/*.sph
  echo "${settings[*]}"
}

measure() {
  local machine name
  machine="$(sed -n 's/^model name[^:]*: //p' /proc/cpuinfo | head -n 1), $(nproc) hardware threads"
  if [[ "$(key)" != "$(cat "$pieces/key" 2>/dev/null)" ]]; then
    rm -rf "$pieces"
    mkdir -p "$pieces"
    key >"$pieces/key"
  fi
  for name in "${experiments[@]}"; do
    [[ ! -d "$pieces/$name" ]] || continue
    rm -rf "$pieces/unfinished"
    mkdir "$pieces/unfinished"
    "$programs/tests/bench/experiments" "trees=$trees" "out=$pieces/unfinished" "machine=$machine" "only=$name" \
      "${settings[@]}"
    mv "$pieces/unfinished" "$pieces/$name"
  done
}

# join TABLE: the heads of the first piece, the rows of all, in place of what was there.
join() {
  local name
  {
    sed '/^[^#]/q' "$pieces/${experiments[0]}/$1"
    for name in "${experiments[@]}"; do sed '/^#/d' "$pieces/$name/$1" | tail -n +2; done
  } >"$results/.$1.new"
  mv "$results/.$1.new" "$results/$1"
}

build
make_trees
mkdir -p "$results"
measure
join experiments.csv
join experiments-parts.csv
if [[ -x "$programs/runtime/demo/crowded_room" ]]; then
  render || echo "run_experiments.sh: nothing could be rendered here; the page keeps what it had of Figure 9" >&2
fi
if [[ $quick == yes ]]; then
  mkdir -p "$work/pictures"
  cp docs/experiments.md "$work/experiments.md"
  tests/bench/plot_experiments.py --results "$results" --page "$work/experiments.md" --pictures "$work/pictures"
else
  tests/bench/plot_experiments.py
fi
