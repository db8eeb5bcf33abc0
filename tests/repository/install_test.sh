#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Installs a build into a fresh folder and uses what is there.
# Usage: install_test.sh BUILD_FOLDER
set -euo pipefail

build=$1
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
fail() {
  printf 'Failed: %s\n' "$*"
  exit 1
}

cmake --install "$build" --prefix "$folder" >"$folder/log" || { cat "$folder/log"; fail "cmake --install"; }
[[ -f $folder/share/morsel/scenes/default.json ]] || fail "the default scene is not installed"
left=$(find "$folder" -name '*.topo' -o -name '*.tmp')
[[ -z $left ]] || fail "caches or temporary files are installed: $left"

for file in share/man/man1/morsel.1 share/bash-completion/completions/morsel \
  share/zsh/vendor-completions/_morsel share/fish/vendor_completions.d/morsel.fish; do
  [[ -s $folder/$file ]] || fail "$file is not installed"
done

version=$("$folder/bin/morsel" --version) || fail "the installed command does not run"
expected=$(sed -n 's/^CMAKE_PROJECT_VERSION:STATIC=//p' "$build/CMakeCache.txt")
[[ -n $expected && $version == *"$expected"* ]] || fail "--version says \"$version\", not $expected"

cd /
printf '0 0 0\n' >"$folder/points.txt"
scene=$folder/share/morsel/scenes/figures/table1_l1.json
values=$("$folder/bin/morsel" field eval "$scene" --geometry rock --points "$folder/points.txt") ||
  fail "the field of an installed scene cannot be evaluated"
[[ $(wc -w <<<"$values") -eq 4 ]] || fail "field eval printed: $values"
"$folder/bin/morsel" render --help >"$folder/help" || fail "the installed command finds no renderer"
grep -q -- --spp "$folder/help" || fail "render --help printed: $(cat "$folder/help")"
