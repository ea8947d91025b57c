# SPDX-License-Identifier: GPL-3.0-or-later
#
# bash completion for spheretree. It asks the program: subcommands, options and the words that an option takes
# are those of its --help.

_spheretree() {
  local program=${COMP_WORDS[0]} word=${COMP_WORDS[COMP_CWORD]} before=${COMP_WORDS[COMP_CWORD - 1]}
  local subcommand=${COMP_WORDS[1]:-} help words
  COMPREPLY=()
  if ((COMP_CWORD == 1)); then
    help=$("$program" --help 2>/dev/null) || return 0
    words=$(sed -n '/^Subcommands:/,$ s/^  \([a-z][a-z]*\)  *.*/\1/p' <<<"$help")
    mapfile -t COMPREPLY < <(compgen -W "$words --help --version" -- "$word")
    return 0
  fi
  help=$("$program" "$subcommand" --help 2>/dev/null) || return 0
  if [[ $before == -* ]]; then
    # "  --quality fast|normal|best=normal   How much..": the words before the default.
    words=$(sed -n "s/^  \(-[a-z],\)\{0,1\}$before \([a-z0-9|-]*|[a-z0-9|-]*\)=.*/\2/p" <<<"$help")
    if [[ -n $words ]]; then
      mapfile -t COMPREPLY < <(compgen -W "${words//|/ }" -- "$word")
      return 0
    fi
  fi
  if [[ $word == -* ]]; then
    words=$(sed -n -e 's/^  \(-[a-z]\),\(--[a-z-]*\).*/\1 \2/p' -e 's/^  \(--[a-z-]*\).*/\1/p' <<<"$help")
    mapfile -t COMPREPLY < <(compgen -W "$words" -- "$word")
    return 0
  fi
  compopt -o filenames 2>/dev/null || true
  mapfile -t COMPREPLY < <(compgen -f -- "$word")
}

complete -F _spheretree spheretree
