#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# The man page, of tools/man/morsel.1.in, the program's version and the options that the commands themselves declare; a test
# compares the page in tools/man with it.
# Usage: make_man.sh MORSEL MORSEL_RENDER >tools/man/morsel.1
set -euo pipefail
here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
options=$("$1" --man && "$2" --man)
version=$("$1" --version | sed -n 's/^morsel //p')
while IFS= read -r line; do
  if [[ $line == @OPTIONS@ ]]; then printf '%s\n' "$options"; else printf '%s\n' "${line//@VERSION@/$version}"; fi
done <"$here/man/morsel.1.in"
