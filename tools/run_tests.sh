#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
set -euo pipefail

usage() {
  cat <<'TEXT'
Usage: tools/run_tests.sh [OPTION]... [-- CTEST_OPTION...]
Installs missing packages, builds Morsel and runs every test that is not labelled `slow`.

  --slow          run the tests labelled `slow` as well
  --no-packages   do not look for missing Debian packages
  --help          show this text

What follows -- goes to ctest, for example: tools/run_tests.sh -- -R octree
Exit code: 0 all passed, 1 (or that of ctest) a step or a test failed or no test ran, 2 wrong usage
or packages that need root.
Environment: CMAKE_BUILD_PARALLEL_LEVEL (compilations side by side), MORSEL_WARNINGS_AS_ERRORS (ON, OFF).
TEXT
}

presets=(release) packages=yes
while [[ $# -gt 0 ]]; do
  case $1 in
    --slow) presets=(release slow) ;;
    --no-packages) packages=no ;;
    --help | -h) usage; exit 0 ;;
    --) shift; break ;;
    *) printf 'run_tests.sh: unknown option %s\n\n' "$1" >&2; usage >&2; exit 2 ;;
  esac
  shift
done

cd "$(dirname "${BASH_SOURCE[0]}")/.."
source tools/lib/steps.sh
source tools/lib/packages.sh
source tools/lib/build.sh

MORSEL_PACKAGES+=("${MORSEL_TEST_PACKAGES[@]}")
if [[ ${presets[*]} == *slow* ]]; then MORSEL_PACKAGES+=("${MORSEL_SLOW_TEST_PACKAGES[@]}"); fi
if [[ $packages == yes ]]; then install_packages; fi
configure_and_build
for preset in "${presets[@]}"; do
  begin_step "Tests ($preset)"
  ctest --preset "$preset" --no-tests=error --parallel "$(nproc)" "$@"
  end_step
done
print_times
