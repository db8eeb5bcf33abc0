#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Shows that check_repository.sh finds each kind of fault, and none in a clean folder.
set -euo pipefail

check=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)/check_repository.sh
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"

licence='// SPDX-License-Identifier: Apache-2.0'
for part in . cmake topology hypertexture_geom hypertexture_geom/embree renderer tools scenes tests; do
  mkdir -p "$part"
  echo "A part." >"$part/README.md"
done
printf '%s\n#pragma once\n#include "topology/box.h"\n' "$licence" >renderer/clean.h
echo 'See [the tools](tools/README.md#names) and [a site](https://example.org).' >README.md

if ! output=$("$check" "$folder"); then
  printf 'A clean folder was refused:\n%s\n' "$output"
  exit 1
fi

failures=0
# expect MESSAGE: the check fails and says so; then the folder is clean again.
expect() {
  local output
  if output=$("$check" "$folder"); then
    printf 'Not found: %s\n' "$1"
    failures=$((failures + 1))
  elif [[ $output != *"$1"* || $output != *" 1 faults" ]]; then
    printf 'Expected one fault, "%s", got:\n%s\n' "$1" "$output"
    failures=$((failures + 1))
  fi
}

echo 'int x;' >topology/bare.cpp
expect 'topology/bare.cpp: no SPDX-License-Identifier line'
rm topology/bare.cpp

echo "$licence" >topology/twice.h
expect 'topology/twice.h: no #pragma once'
rm topology/twice.h

printf '%s\n#include "hypertexture_geom/field/field.h"\n' "$licence" >topology/upward.cpp
expect 'topology/upward.cpp:2: topology must not include hypertexture_geom/field/field.h'
rm topology/upward.cpp

printf '%s\n#include <embree3/rtcore.h>\n' "$licence" >renderer/direct.cpp
expect 'renderer/direct.cpp: includes Embree itself'
rm renderer/direct.cpp

head -c 1600000 /dev/zero >scenes/huge.bin
expect 'scenes/huge.bin: 1600000 bytes'
rm scenes/huge.bin

echo 'See [nothing](nowhere.md).' >scenes/README.md
expect 'scenes/README.md: link to nowhere.md, which does not exist'
echo 'A part.' >scenes/README.md

rm tests/README.md
expect 'tests: no README.md'
echo 'A part.' >tests/README.md

printf '#!/bin/sh\n# SPDX-License-Identifier: Apache-2.0\n' >tools/asleep.sh
expect 'tools/asleep.sh: starts with #! but is not executable'
rm tools/asleep.sh

printf '# SPDX-License-Identifier: Apache-2.0\nif true; then\n' >tools/broken.sh
expect 'tools/broken.sh: not valid bash'
rm tools/broken.sh

"$check" "$folder" >/dev/null || {
  echo "The folder is not clean at the end"
  failures=$((failures + 1))
}
exit $((failures > 0))
