#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
#
# layering.sh ROOT: the rules of docs/architecture.md that a text search can check.
#   1. includes follow the arrows runtime <- medial <- builders <- io <- cli
#   2. runtime uses the standard library only; other packages stay in the layers that own them
#   3. no header includes CGAL, assimp, CLI11 or nlohmann
#   4. no top-level folder besides the layers, tests, models, docs
#   5. every source file opens with its SPDX line: MIT under runtime/, GPL-3.0-or-later elsewhere
# Prints one line per violation and exits with 1 when there is any.
set -euo pipefail

root=$(cd "${1:?usage: layering.sh ROOT}" && pwd -P)
cd "$root"

readonly folders="builders medial io cli runtime tests models docs"
violations=0

report() {
  printf '%s\n' "$1"
  violations=$((violations + 1))
}

# Every file of the project: what git knows or would add; outside a work tree of its own, what lies there.
list_files() {
  if [[ "$(git rev-parse --show-toplevel 2>/dev/null)" == "$root" ]]; then
    git ls-files --cached --others --exclude-standard
  else
    find . \( -path './.*' -o -path ./build -o -path ./install \) -prune -o -type f -print | sed 's|^\./||'
  fi
}

# Sets `layers` to those that a file may include from, itself among them, and `packages` to the foreign ones
# that its .cpp files may include. Eigen is everybody's but the runtime's.
allow() {
  layers="" packages=""
  case "$1" in
    runtime/*) layers="runtime" ;;
    medial/*) layers="medial" packages="CGAL" ;;
    builders/*) layers="medial builders" ;;
    io/*) layers="medial builders io" packages="CGAL assimp nlohmann" ;;
    cli/*) layers="medial builders io cli" packages="CLI CLI11 nlohmann" ;;
    models/make_models.cpp) layers="medial io models" packages="CLI CLI11" ;;
    models/*) layers="medial models" ;;
    docs/*) layers="medial builders io models" ;;
    tests/bench/*) layers="runtime medial builders io models" packages="CLI CLI11" ;;
    tests/*) layers="runtime medial builders io cli models tests" packages="CGAL assimp nlohmann" ;;
  esac
}

contains_word() { [[ " $1 " == *" $2 "* ]]; }

check_include() {
  local file=$1 bracket=$2 target=$3
  local first=${target%%/*} layers packages
  [[ "$target" != */* ]] && first=""
  allow "$file"
  if [[ "$bracket" == '"' && "$target" == ../* ]]; then
    report "$file: includes \"$target\": name the path from the project's root"
  elif contains_word "$folders" "$first" && ! contains_word "$layers" "$first"; then
    report "$file: includes $target, an arrow in the wrong direction"
  fi
  case "$first" in
    CGAL | assimp | CLI | CLI11 | nlohmann)
      if [[ "$file" == *.hpp ]]; then
        report "$file: includes $target in a header"
      elif ! contains_word "$packages" "$first"; then
        report "$file: includes $target, a package of another layer"
      fi
      ;;
  esac
  if [[ "$file" == runtime/* && "$file" != runtime/demo/* && "$bracket" == "<" ]] &&
    ! [[ "$target" =~ ^(spheretree/.*|[a-z_]+|[a-z0-9_]+intrin\.h)$ ]]; then
    report "$file: includes <$target>; the runtime uses the standard library only"
  fi
}

check_includes() {
  local file line
  while IFS=: read -r file line; do
    if [[ "$line" =~ ^[[:space:]]*#[[:space:]]*include[[:space:]]*([\<\"])([^\>\"]+) ]]; then
      check_include "$file" "${BASH_REMATCH[1]}" "${BASH_REMATCH[2]}"
    fi
  done < <(printf '%s\0' "$@" | xargs -0 grep -EH '^[[:space:]]*#[[:space:]]*include' || true)
}

check_licence() {
  local file=$1 licence="GPL-3.0-or-later"
  [[ "$file" == runtime/* ]] && licence="MIT"
  local lines  # the first one, or the second under a #! line
  mapfile -t -n 2 lines <"$file"
  [[ "${lines[*]}" == *"SPDX-License-Identifier: $licence"* ]] ||
    report "$file: does not open with SPDX-License-Identifier: $licence"
}

main() {
  local file code=()
  local -A seen=()
  while IFS= read -r file; do
    [[ -f "$file" ]] || continue
    if [[ "$file" == */* ]]; then
      local top=${file%%/*}
      if [[ -z "${seen[$top]:-}" && "$top" != .* ]] && ! contains_word "$folders build install" "$top"; then
        report "$top/: not a folder of this project"
      fi
      seen[$top]=1
    fi
    case "$file" in
      *.cpp | *.hpp)
        code+=("$file")
        check_licence "$file"
        ;;
      CMakeLists.txt | */CMakeLists.txt | *.cmake | *.sh | *.py | bootstrap | .ci/run) check_licence "$file" ;;
    esac
  done < <(list_files)
  if ((${#code[@]} == 0)); then
    report "no source file found under $root"
  else
    check_includes "${code[@]}"
  fi
  if ((violations > 0)); then
    printf 'layering: %d violation(s)\n' "$violations"
    exit 1
  fi
  printf 'layering: %d source files checked\n' "${#code[@]}"
}

main
