#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
#
# layering_selftest.sh ROOT: layering.sh must pass on a copy of the project and must fail, naming the file,
# on the same copy with one violation of each kind planted in it.
set -euo pipefail

root=$(cd "${1:?usage: layering_selftest.sh ROOT}" && pwd -P)
copy=$(mktemp -d)
trap 'rm -rf "$copy"' EXIT

mkdir "$copy/project"
tar -C "$root" -cf - --exclude=./build --exclude=./install --exclude='./.?*' . | tar -C "$copy/project" -xf -
failures=0

# expect_violation FILE TEXT: with TEXT as the file's content, layering.sh must fail and name the file.
expect_violation() {
  local file="$copy/project/$1" output status=0
  mkdir -p "$(dirname "$file")"
  printf '%b\n' "$2" >"$file"
  output=$("$root/tests/layering.sh" "$copy/project") || status=$?
  if ((status != 1)) || ! grep -qF -- "${3:-$1}" <<<"$output"; then
    printf 'not noticed: %s with %s\n%s\n' "$1" "$2" "$output"
    failures=$((failures + 1))
  fi
  rm "$file"
  rmdir --ignore-fail-on-non-empty "$(dirname "$file")"
}

readonly gpl='// SPDX-License-Identifier: GPL-3.0-or-later\n'
readonly mit='// SPDX-License-Identifier: MIT\n'

"$root/tests/layering.sh" "$copy/project"

expect_violation runtime/planted.cpp "$mit"'#include "medial/surface.hpp"'
expect_violation medial/planted.cpp "$gpl"'#include "builders/report.hpp"'
expect_violation builders/planted.cpp "$gpl"'#include "io/files.hpp"'
expect_violation io/planted.cpp "$gpl"'#include "cli/terminal.hpp"'
expect_violation cli/planted.cpp "$gpl"'#include "models/shapes.hpp"'
expect_violation models/planted.cpp "$gpl"'#include "io/mesh_write.hpp"'
expect_violation docs/planted.cpp "$gpl"'#include "cli/terminal.hpp"'
expect_violation io/planted.cpp "$gpl"'#include "tests/support/shapes.hpp"'
expect_violation medial/planted.cpp "$gpl"'#  include <io/files.hpp>'
expect_violation medial/planted.cpp "$gpl"'#include "../io/files.hpp"'
expect_violation runtime/planted.cpp "$mit"'#include <Eigen/Core>'
expect_violation builders/planted.cpp "$gpl"'#include <CGAL/Bbox_3.h>'
expect_violation medial/planted.cpp "$gpl"'#include <assimp/scene.h>'
expect_violation io/planted.cpp "$gpl"'#include <CLI/CLI.hpp>'
for header in CGAL/Bbox_3.h assimp/scene.h CLI/CLI.hpp CLI11/CLI.hpp nlohmann/json.hpp; do
  expect_violation cli/planted.hpp "$gpl#include <$header>"
done
expect_violation utils/planted.txt 'a folder nobody asked for' 'utils/:'
expect_violation medial/planted.cpp '#include <vector>'
expect_violation medial/planted.cpp "$mit"
expect_violation runtime/planted.hpp "$gpl"
expect_violation tests/planted/CMakeLists.txt 'project(planted)'
expect_violation docs/planted.sh '#!/bin/sh'
expect_violation docs/planted.py 'print()'
expect_violation tests/planted.cpp "$gpl"'#include <CLI/CLI.hpp>'
expect_violation docs/planted.cmake 'set(PLANTED ON)'

"$root/tests/layering.sh" "$copy/project" >/dev/null  # every plant was pulled out again
((failures == 0))
