#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
set -euo pipefail

usage() {
  cat <<'TEXT'
Usage: tools/fuzz.sh [-s SECONDS] [TARGET]...
Builds the fuzz targets with clang, libFuzzer and sanitizers and runs each (without a name: all) from its corpus in
tests/data/fuzz. New inputs are kept in build/fuzz/corpus; what fails is written to build/fuzz/TARGET-*.

  -s SECONDS   for each target; 300 without it
  --help       show this text

Exit code: 0 nothing was found, 1 something was, or a step failed, 2 wrong usage.
TEXT
}

seconds=300 targets=()
while [[ $# -gt 0 ]]; do
  case $1 in
    -s) seconds=${2:?}; shift ;;
    --help | -h) usage; exit 0 ;;
    -*) printf 'fuzz.sh: unknown option %s\n\n' "$1" >&2; usage >&2; exit 2 ;;
    *) targets+=("$1") ;;
  esac
  shift
done

cd "$(dirname "${BASH_SOURCE[0]}")/.."
command -v clang++ >/dev/null || { echo 'fuzz.sh: clang++ is not installed (Debian: clang)' >&2; exit 1; }
if [[ ${#targets[@]} -eq 0 ]]; then
  for source in tests/fuzz/*.cpp; do
    name=$(basename "$source" .cpp)
    [[ $name == replay ]] || targets+=("$name")
  done
fi
for target in "${targets[@]}"; do
  [[ -f tests/fuzz/$target.cpp ]] || { printf 'fuzz.sh: no target %s in tests/fuzz\n' "$target" >&2; exit 2; }
done
cmake --preset fuzz >build/fuzz.log 2>&1 || { cat build/fuzz.log >&2; exit 1; }
cmake --build build/fuzz --target "${targets[@]/#/fuzz_}"

for target in "${targets[@]}"; do
  mkdir -p "build/fuzz/corpus/$target"
  dictionary=()
  [[ -f tests/fuzz/$target.dict ]] && dictionary=("-dict=tests/fuzz/$target.dict")
  # Allocations are bounded, so that a declared size that nobody checked is found.
  LSAN_OPTIONS=suppressions=tests/lsan.supp UBSAN_OPTIONS=halt_on_error=1:print_stacktrace=1 "build/fuzz/bin/fuzz_$target" -max_total_time="$seconds" -timeout=20 \
    -rss_limit_mb=2048 -malloc_limit_mb=512 -max_len=16384 -print_final_stats=1 "${dictionary[@]}" \
    -artifact_prefix="build/fuzz/$target-" "build/fuzz/corpus/$target" "tests/data/fuzz/$target"
done
