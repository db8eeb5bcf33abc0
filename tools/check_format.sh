#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Lists the C++ files that clang-format would change (exit 1), or changes them with --fix.
# Versions of clang-format differ in details; version 14, Debian 12's, is the one that counts.
set -euo pipefail

mode=(--dry-run --Werror)
case ${1:-} in
  "") ;;
  --fix) mode=(-i) ;;
  *) echo "Usage: tools/check_format.sh [--fix]" >&2; exit 2 ;;
esac

cd "$(dirname "${BASH_SOURCE[0]}")/.."
formatter=clang-format
if command -v clang-format-14 >/dev/null; then formatter=clang-format-14; fi
if ! command -v "$formatter" >/dev/null; then
  echo "clang-format is not installed: apt-get install clang-format" >&2
  exit 2
fi
mapfile -t files < <(find topology hypertexture_geom renderer tools tests -name '*.h' -o -name '*.cpp' | sort)
"$formatter" "${mode[@]}" --style=file "${files[@]}"
echo "${#files[@]} files: formatted ($("$formatter" --version | grep -oE 'version [0-9.]+'))"
