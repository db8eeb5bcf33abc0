#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# `morsel` stays quick to start: it does not load the libraries of the renderer, which cost more time
# than a small command takes; `morsel-render`, which it runs for pictures, does.
# Usage: light_command_test.sh MORSEL MORSEL_RENDER
set -eu
needed() { readelf -d "$1" | sed -n 's/.*(NEEDED).*\[\(.*\)\]/\1/p'; }
needed "$2" | grep -q '^libOpenImageIO' || { echo "$2 should load OpenImageIO"; exit 1; }
if needed "$1" | grep -E '^lib(OpenImageIO|OpenEXR|embree|assimp)'; then
  echo "$1 loads the libraries above before it knows what it is asked"
  exit 1
fi
