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
[[ $faults -eq 0 ]]
