# SPDX-License-Identifier: Apache-2.0
# shellcheck shell=bash
# Completion of the command morsel for bash.
# Subcommands, flags and their choices are what `--help` says, so that this never falls behind.

declare -gA _morsel_help

_morsel() {
  local word=${COMP_WORDS[COMP_CWORD]} before=${COMP_WORDS[COMP_CWORD - 1]} path=() i
  COMPREPLY=()
  # The subcommand: the words before the first flag or file, at most two.
  for ((i = 1; i < COMP_CWORD && ${#path[@]} < 2; ++i)); do
    [[ ${COMP_WORDS[i]} =~ ^[a-z]+$ ]] || break
    path+=("${COMP_WORDS[i]}")
  done
  # The longest part of it that the program knows.
  local key help=""
  while :; do
    key="morsel ${path[*]}"
    if [[ -z ${_morsel_help[$key]+x} ]]; then
      _morsel_help[$key]=$("${COMP_WORDS[0]}" "${path[@]}" --help 2>/dev/null) || _morsel_help[$key]=""
    fi
    help=${_morsel_help[$key]}
    [[ -n $help || ${#path[@]} -eq 0 ]] && break
    unset 'path[-1]'
  done

  local words=""
  if [[ $word == -* ]]; then
    words=$(grep -oE '(^|[ ,])--?[a-z][a-z-]*' <<<"$help" | tr -d ' ,' | sort -u) || true
  elif [[ $before == --* ]]; then
    # Choices stand in braces: --progress TEXT:{auto,bar,...}
    words=$(grep -oE -- "$before [A-Z]+:\{[^}]*\}" <<<"$help" | head -n 1 | sed 's/.*{//; s/}//; s/,/ /g') || true
  elif ((${#path[@]} == COMP_CWORD - 1)); then
    words=$(sed -n '/^Subcommands:/,$ s/^  \([a-z][a-z]*\) .*/\1/p' <<<"$help")
  fi
  mapfile -t COMPREPLY < <(compgen -W "$words" -- "$word")
  if [[ ${#COMPREPLY[@]} -eq 0 && $word != -* ]]; then
    mapfile -t COMPREPLY < <(compgen -f -- "$word")
    compopt -o filenames 2>/dev/null
  fi
  return 0
}
complete -F _morsel morsel
