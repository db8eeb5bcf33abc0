#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Checks what every file of the repository must keep to, whatever is in it:
#   licence line, header guard, README of every part, working links between documents, size,
#   direction of dependencies, Embree's headers in one place, executable scripts that parse.
#
# Usage: check_repository.sh [FOLDER]   prints one line for each fault; exits 1 when there is any.
set -euo pipefail

cd "${1:-$(dirname "${BASH_SOURCE[0]}")/../..}"
readonly max_bytes=1500000
faults=0
fault() {
  printf '%s\n' "$*"
  faults=$((faults + 1))
}

# The files that are or would be committed; without git, everything but what builds leave behind.
list_files() {
  if [[ -e .git ]] && git ls-files --error-unmatch README.md >/dev/null 2>&1; then
    git ls-files --cached --others --exclude-standard
  else
    find . \( -path ./.git -o -path ./build -o -path ./pictures -o -name '*.topo' \) -prune -o \
      -type f -printf '%P\n'
  fi
}

# check_includes PART ALLOWED...: what files of PART include of the project lies in ALLOWED.
check_includes() {
  local part=$1 file line included allowed
  shift
  [[ -d $part ]] || return 0
  while IFS=: read -r file line included; do
    included=${included#*\"}
    for allowed in "$@"; do
      [[ $included == "$allowed"/* ]] && continue 2
    done
    fault "$file:$line: $part must not include $included (allowed: $*)"
  done < <(grep -rnE --include='*.h' --include='*.cpp' \
    '^ *#include "(topology|hypertexture_geom|renderer|tools|tests)/[^"]*' -o "$part")
}

check_links() {
  local document=$1 target folder=.
  [[ $document != */* ]] || folder=${document%/*}
  while read -r target; do
    case $target in
      http://* | https://* | mailto:* | "") continue ;;
    esac
    [[ -e $folder/$target ]] || fault "$document: link to $target, which does not exist"
  done < <(grep -oE '\]\([^)# ]+' "$document" | sed 's/^](//')
}

mapfile -t files < <(list_files | sort)
while read -r bytes file; do
  if ((bytes > max_bytes)); then fault "$file: $bytes bytes, more than $max_bytes"; fi
done < <(stat -c '%s %n' "${files[@]}" 2>/dev/null)

headers=()
for file in "${files[@]}"; do
  [[ -f $file ]] || continue
  # Builtins only: one process for each file would be most of the time that this takes.
  mapfile -t -n 3 top <"$file"
  case $file in
    *.h | *.c | *.cpp | *.sh | *.py | *.cmake | CMakeLists.txt | */CMakeLists.txt | .ci/run)
      [[ "${top[*]}" == *'SPDX-License-Identifier: Apache-2.0'* ]] ||
        fault "$file: no SPDX-License-Identifier line at its top"
      ;;
  esac
  case $file in
    *-inl.h) ;; # Highway's: included once for each instruction set, with a guard of their own
    *.h) headers+=("$file") ;;
    *.md) check_links "$file" ;;
    *.sh | .ci/run) bash -n "$file" 2>/dev/null || fault "$file: not valid bash" ;;
  esac
  if [[ ${top[0]:-} == '#!'* && ! -x $file ]]; then
    fault "$file: starts with #! but is not executable"
  fi
done

# What Highway compiles once for each instruction set is included again and again, by its toggle.
while read -r file; do
  [[ $file == *-inl.h ]] && grep -q '== defined(HWY_TARGET_TOGGLE)' "$file" && continue
  fault "$file: no #pragma once"
done < <(grep -L '^#pragma once$' "${headers[@]}")

while read -r file; do
  [[ $file == hypertexture_geom/embree/compat.h ]] ||
    fault "$file: includes Embree itself; hypertexture_geom/embree/compat.h is the place for it"
done < <(grep -rlE --include='*.h' --include='*.cpp' '^ *#include <embree[0-9]*/' \
  topology hypertexture_geom renderer tools tests)

# Every part has a README, and so has the repository.
for folder in . cmake topology hypertexture_geom hypertexture_geom/embree renderer tools scenes tests; do
  [[ -s $folder/README.md ]] || fault "$folder: no README.md"
done

# Arrows point one way: tools -> renderer -> hypertexture_geom -> topology.
check_includes topology topology
check_includes hypertexture_geom topology hypertexture_geom
check_includes renderer topology hypertexture_geom renderer
check_includes tools topology hypertexture_geom renderer tools

echo "${#files[@]} files, $faults faults"
[[ $faults -eq 0 ]]
