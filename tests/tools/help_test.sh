#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# The man page names every subcommand and every flag of `render`, and the completion offers them.
# Usage: help_test.sh MORSEL SOURCE_FOLDER
set -euo pipefail
morsel=$1 source=$2 faults=0
fault() { echo "$1"; faults=$((faults + 1)); }

page=$(sed 's/\\-/-/g; s/\\f[A-Z]//g' "$source/tools/man/morsel.1")
subcommands() { "$morsel" "$@" --help | sed -n '/^Subcommands:/,$ s/^  \([a-z][a-z]*\) .*/\1/p'; }
for command in $(subcommands); do
  if [[ $command == scene || $command == cache || $command == field ]]; then
    for second in $(subcommands "$command"); do
      grep -q "morsel $command $second" <<<"$page" || fault "the man page lacks: morsel $command $second"
    done
  else
    grep -q "morsel $command " <<<"$page" || fault "the man page lacks: morsel $command"
  fi
done
flags=$("$morsel" render --help | grep -oE '(^|[ ,])--[a-z][a-z-]*' | tr -d ' ,' | sort -u)
[[ $(wc -l <<<"$flags") -gt 20 ]] || fault "render --help lists few flags"
for flag in $flags; do
  [[ $flag == --help ]] && continue
  grep -qE -- "(^|[^a-z-])$flag([^a-z-]|\$)" <<<"$page" || fault "the man page lacks: render $flag"
done
if command -v man >/dev/null && command -v groff >/dev/null; then
  warnings=$(groff -man -Tascii -ww "$source/tools/man/morsel.1" 2>&1 >/dev/null) || true
  [[ -z $warnings ]] || fault "groff: $warnings"
fi

# shellcheck source=/dev/null
source "$source/tools/completion/morsel.bash"
compopt() { :; }
# offers "WORDS SO FAR" WORD: what is typed, the last word being completed, offers WORD.
offers() {
  local expected=$2
  read -ra COMP_WORDS <<<"$1"
  [[ $1 == *' ' ]] && COMP_WORDS+=("")
  COMP_WORDS[0]=$morsel
  COMP_CWORD=$((${#COMP_WORDS[@]} - 1))
  _morsel
  [[ " ${COMPREPLY[*]} " == *" $expected "* ]] || fault "'$1' does not offer $expected but: ${COMPREPLY[*]}"
}
offers "morsel re" render
offers "morsel " bench
offers "morsel cache " verify
offers "morsel scene n" new
offers "morsel cache info --j" --json
offers "morsel render x.json --check" --checkpoint
offers "morsel render x.json --progress p" plain
offers "morsel render x.json --solver s" sphere
offers "morsel render x.json --keep ma" main

# The same of the other shells, where they are installed (Debian: zsh, fish).
# answers SHELL "WORDS SO FAR" WORD: the completion of that shell offers WORD.
answers() {
  local offered
  if [[ $1 == zsh ]]; then
    # compadd notes what it is given instead of showing it, which needs a terminal.
    offered=$(zsh -f -c '
      compdef() { :; }
      source "$1/tools/completion/_morsel"
      compadd() { [[ $1 == -- ]] && shift; print -l -- "$@"; }
      _files() { print FILES; }
      words=("${(@s: :)2}") CURRENT=${#words}
      words[1]=$3
      _morsel' zsh "$source" "$2" "$morsel") || true
  else
    offered=$(fish --no-config -c 'source $argv[1]/tools/completion/morsel.fish
      complete -C $argv[2]' "$source" "${2/#morsel/morsel}" | cut -f 1) || true
  fi
  grep -qxF -- "$3" <<<"$offered" || fault "$1: '$2' does not offer $3 but: ${offered//$'\n'/ }"
}
for shell in zsh fish; do
  command -v "$shell" >/dev/null || { echo "$shell is not installed"; continue; }
  # fish asks the morsel that it finds.
  PATH=$(dirname "$morsel"):$PATH
  answers "$shell" "morsel re" render
  answers "$shell" "morsel " bench
  answers "$shell" "morsel cache " verify
  answers "$shell" "morsel scene n" new
  answers "$shell" "morsel cache info --j" --json
  answers "$shell" "morsel render x.json --check" --checkpoint
  answers "$shell" "morsel render x.json --progress p" plain
  answers "$shell" "morsel render x.json --solver s" sphere
done
[[ $faults -eq 0 ]]
