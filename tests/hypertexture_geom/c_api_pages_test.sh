#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# The library exports what the header declares, each function has one page with its declaration, and nothing else is there.
# Usage: c_api_pages_test.sh SOURCE_FOLDER LIBRARY
set -euo pipefail

source=$1/hypertexture_geom library=$2
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
failures=0
same() {
  diff "$folder/$1" "$folder/$2" >"$folder/difference" && return
  printf 'Failed: %s (<) and %s (>) differ:\n' "$1" "$2"
  cat "$folder/difference"
  failures=$((failures + 1))
}

# The declarations, one a line, blanks as one.
sed -n '/^MORSEL_API /,/;/p' "$source/include/morsel/hypertexture_geom.h" | tr -s ' \n' ' ' |
  sed 's/MORSEL_API /\n/g' | sed 's/;.*/;/' | grep . >"$folder/declarations"
grep -oE 'morsel_[a-z_]+\(' "$folder/declarations" | tr -d '(' | sort >"$folder/header"
[[ $(wc -l <"$folder/header") -gt 20 ]] || { echo "Failed: hardly any function in the header"; exit 1; }
# Symbols of the version node itself (type A) are no functions.
nm -D --defined-only "$library" | awk '$2 != "A" { sub(/@.*/, "", $3); print $3 }' | sort >"$folder/exports"
find "$source/docs" -name '*.md' ! -name README.md -printf '%f\n' | sed 's/\.md$//' | sort >"$folder/pages"
grep -oE '^\| \[morsel_[a-z_]+\]' "$source/docs/README.md" | tr -d '|[] ' | sort >"$folder/index"
same header exports
same header pages
same header index

while read -r declaration; do
  name=$(grep -oE 'morsel_[a-z_]+\(' <<<"$declaration" | head -n 1 | tr -d '(')
  page=$source/docs/$name.md
  [[ -f $page ]] || continue
  tr -s ' \n' ' ' <"$page" | grep -qF "$declaration" || {
    echo "Failed: $page does not show: $declaration"
    failures=$((failures + 1))
  }
done <"$folder/declarations"
exit $((failures > 0))
