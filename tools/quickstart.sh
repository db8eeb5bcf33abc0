#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
set -euo pipefail

usage() {
  cat <<'TEXT'
Usage: tools/quickstart.sh [OPTION]...
From a bare Debian 12 or 13 to a picture: installs missing packages, builds Morsel, computes the
topology cache of the default scene and renders it at 640 x 360 pixels. On two processors that
takes about thirteen minutes, nearly all of them for compiling. What is up to date is not done again.

  --no-render     stop after the topology cache
  --no-packages   do not look for missing Debian packages
  --help          show this text

Exit code: 0 done, 1 a step failed, 2 wrong usage or packages that need root.
Environment: CMAKE_BUILD_PARALLEL_LEVEL (compilations side by side), MORSEL_WARNINGS_AS_ERRORS (ON, OFF).
TEXT
}

render=yes packages=yes
for argument in "$@"; do
  case $argument in
    --no-render) render=no ;;
    --no-packages) packages=no ;;
    --help | -h) usage; exit 0 ;;
    *) printf 'quickstart.sh: unknown option %s\n\n' "$argument" >&2; usage >&2; exit 2 ;;
  esac
done

cd "$(dirname "${BASH_SOURCE[0]}")/.."
source tools/lib/steps.sh
source tools/lib/packages.sh
source tools/lib/build.sh
source tools/lib/pictures.sh

if [[ $packages == yes ]]; then install_packages; fi
configure_and_build morsel # the tests are built by those who run them
build_topology_cache scenes/default.json
if [[ $render == no ]]; then
  print_times
  exit 0
fi
render_picture scenes/default.json pictures/default.exr --resolution 640x360
print_times
list_pictures pictures/default.exr
