#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
set -euo pipefail

usage() {
  cat <<'TEXT'
Usage: tools/tsan.sh [--tbb-source DIR] [-- CTEST_OPTION...]
Looks for data races: builds the tests that run on several threads with ThreadSanitizer (preset tsan) and runs them with
a TBB that is built with it too. Without that, it would take every task that another thread finished for a race, since
it does not see how the installed library hands tasks over. What other libraries hide from it is in tools/tsan.supp.

  --tbb-source DIR   sources of oneTBB; without it those of the installed package, by apt-get source
  -- OPTIONS         go to ctest, instead of the choice of tests; there are those of topology, morse, topology_mesh, c_api,
                     cache_store, progressive, integrator, render and hypertexture_test

Exit code: 0 no race was found, 1 one was, or a step failed, 2 wrong usage.
TEXT
}

tbb_source='' options=()
while [[ $# -gt 0 ]]; do
  case $1 in
    --tbb-source)
      [[ -d ${2:-} ]] || { printf 'tsan.sh: --tbb-source needs a folder\n\n' >&2; usage >&2; exit 2; }
      tbb_source=$(realpath "$2")
      shift
      ;;
    --) shift; options=("$@"); break ;;
    --help | -h) usage; exit 0 ;;
    *) printf 'tsan.sh: unknown option %s\n\n' "$1" >&2; usage >&2; exit 2 ;;
  esac
  shift
done

cd "$(dirname "${BASH_SOURCE[0]}")/.."
folder=$PWD/build/tsan-tbb
library=$folder/build/lib_relwithdebinfo # where its build puts it, by TBB_OUTPUT_DIR_BASE
mkdir -p "$folder"

# Package sources are often not in apt's lists: lists of our own have them, and change no settings of the machine.
fetch_tbb() {
  local sources=$folder/apt
  mkdir -p "$sources/lists/partial" "$sources/parts"
  # The two forms of these files have names of their own.
  if [[ -e /etc/apt/sources.list.d/debian.sources ]]; then
    sed 's/^Types: deb$/Types: deb-src/' /etc/apt/sources.list.d/debian.sources >"$sources/parts/tbb.sources"
  else
    sed -n 's/^deb /deb-src /p' /etc/apt/sources.list >"$sources/parts/tbb.list"
  fi
  local apt=(apt-get -o Dir::Etc::sourcelist=/dev/null -o "Dir::Etc::sourceparts=$sources/parts"
    -o "Dir::State::lists=$sources/lists" -o APT::Sandbox::User=root)
  "${apt[@]}" -qq update || exit 1
  (cd "$folder" && "${apt[@]}" -qq source --download-only onetbb) || exit 1
  mkdir -p "$folder/source"
  tar -xf "$folder"/onetbb_*.orig.tar.* -C "$folder/source" --strip-components=1
}

if [[ ! -e $library/libtbb.so.12 ]]; then
  if [[ -z $tbb_source ]]; then
    tbb_source=$folder/source
    [[ -e $tbb_source/CMakeLists.txt ]] || fetch_tbb
  fi
  cmake -S "$tbb_source" -B "$folder/build" -G Ninja -DCMAKE_BUILD_TYPE=RelWithDebInfo -DTBB_SANITIZE=thread \
    -DTBB_TEST=OFF -DTBB_STRICT=OFF -DTBBMALLOC_BUILD=OFF -DTBB_OUTPUT_DIR_BASE=lib
  cmake --build "$folder/build" --target tbb
  [[ -e $library/libtbb.so.12 ]] || { printf 'tsan.sh: the build of TBB made no %s\n' "$library/libtbb.so.12" >&2; exit 1; }
fi

# The tests of what runs on several threads: labels, meshes, the Morse engine, the C API, renders and their files.
programs=(topology_test morse_test topology_mesh_test c_api_test cache_store_test progressive_test integrator_test
  render_test hypertexture_test)
if [[ ${#options[@]} -eq 0 ]]; then
  options=(-R '^(.*/)?(CApi|Certified|Determinism|Engine|Checkpoint|CacheStore|Verify|Morse|RegionGrowing|Mesh\.SphereAtEveryError|Progressive|Render|TracePixel|Mis|Hypertexture)')
fi
cmake --preset tsan >build/tsan.log 2>&1 || { cat build/tsan.log >&2; exit 1; }
# Without address randomisation, here too, since the build asks the programs for their tests: the sanitizer's own map of
# memory does not fit some kernels' choices.
setarch -R cmake --build build/tsan --target "${programs[@]}"

LD_LIBRARY_PATH=$library${LD_LIBRARY_PATH:+:$LD_LIBRARY_PATH} \
  TSAN_OPTIONS="suppressions=$PWD/tools/tsan.supp:halt_on_error=0:exitcode=66:second_deadlock_stack=1" \
  setarch -R ctest --test-dir build/tsan -j "$(nproc)" --output-on-failure --no-tests=error -LE '^slow$' -E _NOT_BUILT "${options[@]}" || exit 1
