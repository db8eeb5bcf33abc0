#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
set -euo pipefail

usage() {
  cat <<'TEXT'
Usage: tools/soak.sh [OPTION]...
Random scenes in a loop: topology caches are built, interrupted, killed and built again, pictures are rendered, interrupted
and resumed, which must give the same pixels. Then says how much one process grows with each scene that it renders.

  --minutes M         how long (5)
  --seed S            of the scenes and of the moments (1)
  --morsel PROGRAM    the command to use (build/release/bin/morsel)
  --help              show this text

Needs python3 (its standard library). Exit code: 0 no failure, 1 failures, which are printed, 2 wrong usage.
TEXT
}

minutes=5 seed=1 morsel=$(dirname "${BASH_SOURCE[0]}")/../build/release/bin/morsel
while [[ $# -gt 0 ]]; do
  case $1 in
    --help | -h) usage; exit 0 ;;
    --minutes | --seed | --morsel)
      [[ $# -gt 1 ]] || { echo "soak.sh: $1 needs a value" >&2; exit 2; }
      declare "${1#--}=$2"
      shift
      ;;
    *) printf 'soak.sh: unknown option %s\n\n' "$1" >&2; usage >&2; exit 2 ;;
  esac
  shift
done
[[ $minutes =~ ^[0-9]+(\.[0-9]+)?$ && $seed =~ ^[0-9]+$ ]] || { echo "soak.sh: --minutes and --seed are numbers" >&2; exit 2; }
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 "$(dirname "${BASH_SOURCE[0]}")/soak/soak.py" "$(realpath "$morsel")" "$minutes" "$seed" "$folder"
