#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
#
# run_fuzzers.sh SECONDS [TARGET...]: every fuzz target, or those named, for so long, one after the other, with
# libFuzzer, the address and the undefined-behaviour sanitizer. Needs clang. What was learnt stays in
# build/fuzz-corpus/TARGET for the next run; inputs that end a target stay in build/fuzz-findings/. Prints one
# line of CSV per target, as tests/hard/results/fuzz.csv has them. Exits with 1 when anything was found.
#
# BUILD=folder uses the targets of a folder that is already built.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/../.."

seconds=${1:?usage: run_fuzzers.sh SECONDS [TARGET...]}
shift
if (($# > 0)); then
  targets=("$@")
else
  targets=()
  for source in tests/fuzz/*_target.cpp; do
    name=$(basename "$source" _target.cpp)
    [[ "$name" == manifest && ! -e io/manifest.hpp ]] && continue
    [[ "$name" == fuzz ]] || targets+=("$name")
  done
fi

build=${BUILD:-build/fuzz}
if [[ -z "${BUILD:-}" ]]; then
  command -v clang++ >/dev/null || {
    echo "run_fuzzers.sh: libFuzzer needs clang++; without it the tests fuzz_*_smoke try seeded mutations" >&2
    exit 2
  }
  cmake --preset fuzz >/dev/null
  cmake --build --preset fuzz >&2
fi

# Slower than this is a finding as well, and so is more memory; sanitizers take their share of both. By the clock:
# on a crowded machine run a timeout again before believing it.
readonly slowest=100
readonly megabytes=2048
# Small inputs reach everything; large ones only make the targets slow.
readonly longest=4096

found=0
findings=build/fuzz-findings
mkdir -p "$findings"
echo "target,executions,seconds,found"
for name in "${targets[@]}"; do
  learnt=build/fuzz-corpus/$name
  mkdir -p "$learnt"
  log=build/fuzz-$name.log
  dictionary=()
  if [[ -e tests/fuzz/$name.dict ]]; then dictionary=("-dict=tests/fuzz/$name.dict"); fi
  "$build/tests/fuzz/fuzz_$name" -max_total_time="$seconds" -max_len=$longest -timeout=$slowest -report_slow_units=$slowest \
    -rss_limit_mb=$megabytes -print_final_stats=1 -artifact_prefix="$findings/$name-" "${dictionary[@]}" \
    "$learnt" "tests/fuzz/corpus/$name" >"$log" 2>&1 || found=1
  executions=$(sed -n 's/^stat::number_of_executed_units: *//p' "$log")
  took=$(sed -n 's/^Done [0-9]* runs in \([0-9]*\) second.*/\1/p' "$log")
  crashes=$(find "$findings" -name "$name-*" | wc -l)
  echo "$name,${executions:-0},${took:-stopped},$crashes"
  if ((crashes > 0)); then grep -m 3 -E '^flaw:|^SUMMARY:|runtime error:' "$log" >&2 || true; fi
done
exit "$found"
