#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# The man page names every subcommand with all its flags, and the completion offers them.
# Usage: help_test.sh MORSEL MORSEL_RENDER SOURCE_FOLDER
set -euo pipefail
morsel=$1 renderer=$2 source=$3 faults=0
fault() { echo "$1"; faults=$((faults + 1)); }

"$source/tools/make_man.sh" "$morsel" "$renderer" | diff "$source/tools/man/morsel.1" - >/dev/null ||
  fault "the man page is not up to date: tools/make_man.sh $morsel $renderer >tools/man/morsel.1"
grep -qxE '\.TH MORSEL 1 "[A-Z][a-z]+ 20[0-9]{2}" "Morsel [0-9]+\.[0-9]+\.[0-9]+" "User Commands"' "$source/tools/man/morsel.1" ||
  fault "the head of the man page lacks date or version"
# The page as it is read: one section for each command.
page=$(sed 's/\\-/-/g; s/\\f[A-Z]//g' "$source/tools/man/morsel.1")
subcommands() { "$morsel" "$@" --help | sed -n '/^Subcommands:/,$ s/^  \([a-z][a-z]*\) .*/\1/p'; }
# covers COMMAND [SECOND]: the section of the command has every flag that its help lists.
covers() {
  local section flags flag
  section=$(sed -n "/^\.SS \"morsel $* *[A-Z.]*[A-Z. ]*\"\$/,/^\.S[SH] /p" <<<"$page")
  flags=$("$morsel" "$@" --help | grep -oE '^  -[^ ]*' | tr ', ' '\n\n' | grep -vxE -- '|-h|--help') || true
  [[ -n $flags ]] || return 0
  [[ -n $section ]] || fault "the man page lacks: morsel $*"
  for flag in $flags; do
    grep -qE -- "^$flag( |,|\$)|, $flag( |\$)" <<<"$section" || fault "the man page lacks: morsel $* $flag"
    checked=$((checked + 1))
  done
}
checked=0
for command in $(subcommands); do
  covers "$command"
  for second in $(subcommands "$command"); do covers "$command" "$second"; done
done
[[ $checked -gt 100 ]] || fault "only $checked flags are listed by --help"
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
