#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
set -euo pipefail

usage() {
  cat <<'TEXT'
Usage: tools/static_analysis.sh [-j JOBS] [FILE.cpp]...
Runs clang-tidy with the checks of .clang-tidy, which says why others are left out, over these sources; without any, over
all but the tests. A warning is a failure. What is right all the same is marked in place: // NOLINT(check): reason.

  -j JOBS   side by side; as many as there are processors without it
  --help    show this text

Exit code: 0 clean, 1 something was found, or a step failed, 2 wrong usage.
TEXT
}

jobs=$(nproc) files=()
while [[ $# -gt 0 ]]; do
  case $1 in
    -j)
      [[ ${2:-} =~ ^[1-9][0-9]*$ ]] || { printf 'static_analysis.sh: -j needs a number\n\n' >&2; usage >&2; exit 2; }
      jobs=$2
      shift
      ;;
    --help | -h) usage; exit 0 ;;
    -*) printf 'static_analysis.sh: unknown option %s\n\n' "$1" >&2; usage >&2; exit 2 ;;
    *) files+=("$(realpath "$1")") ;;
  esac
  shift
done

cd "$(dirname "${BASH_SOURCE[0]}")/.."
command -v clang-tidy >/dev/null || { echo 'static_analysis.sh: clang-tidy is not installed (Debian: clang-tidy)' >&2; exit 1; }
mkdir -p build
cmake --preset release >build/static_analysis.log 2>&1 || { cat build/static_analysis.log >&2; exit 1; }
if [[ ${#files[@]} -eq 0 ]]; then
  mapfile -t files < <(find topology hypertexture_geom renderer tools -name '*.cpp' | sort)
fi
status=0
printf '%s\0' "${files[@]}" |
  xargs -0 -P "$jobs" -n 1 clang-tidy -p build/release --quiet --warnings-as-errors='*' 2>build/static_analysis.log || status=1
# What is not a warning of a file, such as a program that cannot run, is there.
[[ $status == 0 ]] || grep -v ' warnings\? generated\.$\| treated as error' build/static_analysis.log >&2 || true
printf '%d files: %s\n' "${#files[@]}" "$([[ $status == 0 ]] && echo clean || echo 'see above')"
exit "$status"
