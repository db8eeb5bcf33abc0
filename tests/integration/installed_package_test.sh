#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Installs a build into a fresh folder, builds a third party's viewer in C against what is there and nothing else, by
# CMake and by pkg-config, runs it and looks at its pictures.
# Usage: installed_package_test.sh BUILD_FOLDER [--valgrind]
set -euo pipefail

build=$1 valgrind=${2:-}
here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
fail() {
  printf 'Failed: %s\n' "$*"
  exit 1
}
quietly() {
  "$@" >"$folder/log" 2>&1 || {
    cat "$folder/log"
    fail "$*"
  }
}

quietly cmake --install "$build" --prefix "$folder/installed"

# Where the library is not built, as after tools/quickstart.sh: nothing is copied, and the message says what can be done.
mkdir "$folder/unbuilt"
sed "s#EXISTS \"$build/[^\"]*libmorsel[^\"]*\"#EXISTS \"$folder/missing.so\"#" "$build/cmake_install.cmake" >"$folder/unbuilt/cmake_install.cmake"
grep -q "$folder/missing.so" "$folder/unbuilt/cmake_install.cmake" || fail "the installer does not look whether the library is built"
if cmake -DCMAKE_INSTALL_PREFIX="$folder/none" -P "$folder/unbuilt/cmake_install.cmake" >"$folder/log" 2>&1; then
  fail "a library that is not built was installed"
fi
grep -q -- '--component program' "$folder/log" || fail "unclear: $(cat "$folder/log")"
[[ ! -e $folder/none ]] || fail "a part was installed in spite of the error"
quietly cmake -DCMAKE_INSTALL_PREFIX="$folder/none" -DCMAKE_INSTALL_COMPONENT=program -P "$folder/unbuilt/cmake_install.cmake"
[[ -x $folder/none/bin/morsel && ! -e $folder/none/include ]] || fail "the program alone: $(cat "$folder/log")"
# A copy, so that no path into the repository can help.
cp -r "$here" "$folder/viewer"
quietly cmake -G Ninja -S "$folder/viewer" -B "$folder/build" -DCMAKE_BUILD_TYPE=Release \
  -DCMAKE_PREFIX_PATH="$folder/installed"
quietly cmake --build "$folder/build"
cd "$folder"
viewer=build/viewer

if [[ $valgrind == --valgrind ]]; then
  quietly "$viewer" main rock.topo main.ppm 8 6 # the cache, at full speed
  # What the loader, TBB's workers and Embree keep to the end is reachable; anything lost is a leak.
  valgrind --quiet --error-exitcode=9 --leak-check=full --show-leak-kinds=definite \
    --errors-for-leak-kinds=definite "$viewer" main rock.topo main.ppm 24 18 2>"$folder/valgrind" ||
    {
      cat "$folder/valgrind"
      # Highway's library reads the processor's clock when it is loaded, by an instruction that valgrind knows only on
      # machines that announce it (rdtscp in /proc/cpuinfo; virtual ones may not).
      if grep -q 'SIGILL' "$folder/valgrind" && grep -q 'TimerResolution' "$folder/valgrind"; then exit 77; fi
      fail "valgrind complains"
    }
  exit 0
fi

# describe PICTURE KEY -> its value as check_picture prints it.
describe() { build/check_picture "$1" | grep -oE "$2 [0-9.]+" | cut -d' ' -f2; }
at_least() { awk -v a="$1" -v b="$2" 'BEGIN { exit !(a >= b) }'; }

said=$("$viewer" main rock.topo main.ppm 2>progress) || fail "viewer: $(cat progress)"
[[ -s rock.topo ]] || fail "no cache was written"
grep -q '100%' progress || fail "no progress was reported: $(cat progress)"
[[ $said == *"certified 1 kept 1 "* && $said == *"step_limits 0" ]] || fail "viewer said: $said"
for part in "rock 0.15" "triangles 0.2" "background 0.1" "shadow 0.02"; do
  read -r key least <<<"$part"
  at_least "$(describe main.ppm "$key")" "$least" || fail "$key below $least: $(build/check_picture main.ppm)"
done
# What is connected in space is connected in the picture.
[[ $(describe main.ppm islands) == 1 ]] || fail "the rock is in pieces: $(build/check_picture main.ppm)"

# A second run reads the cache, and with everything kept the debris is there.
said=$("$viewer" all rock.topo all.ppm 2>progress) || fail "viewer: $(cat progress)"
! grep -q labelling progress || fail "the cache was built again: $(cat progress)"
at_least "$(describe all.ppm islands)" 5 || fail "no debris: $(build/check_picture all.ppm)"

# Errors reach the third party.
if "$viewer" nonsense rock.topo bad.ppm 2>error; then fail "a bad keep rule is accepted"; fi
grep -q 'MORSEL_ERROR_INVALID_ARGUMENT.*nonsense.*choices' error || fail "unclear error: $(cat error)"
head -c 1000 rock.topo >short.topo
if "$viewer" main short.topo bad.ppm 2>error; then fail "a truncated cache is accepted"; fi
grep -q 'MORSEL_ERROR_FILE.*short.topo' error || fail "unclear error: $(cat error)"
[[ ! -e bad.ppm ]] || fail "a picture was written in spite of an error"

# The same by pkg-config; the results are the same to the last bit.
export PKG_CONFIG_PATH=$folder/installed/lib/pkgconfig
[[ -f $PKG_CONFIG_PATH/morsel.pc ]] || PKG_CONFIG_PATH=$(dirname "$(find installed -name morsel.pc)")
embree=$(pkg-config --variable=embree morsel)
libraries=$(pkg-config --libs --cflags morsel)
# shellcheck disable=SC2086
quietly cc ${CFLAGS:-} -std=c99 -O2 -DEMBREE_MAJOR="$embree" viewer/viewer.c $libraries "-lembree$embree" -lm -o plain_viewer
LD_LIBRARY_PATH=$(pkg-config --variable=libdir morsel) ./plain_viewer main rock.topo plain.ppm >/dev/null ||
  fail "the viewer that pkg-config made does not run"
cmp main.ppm plain.ppm || fail "CMake's and pkg-config's viewers differ"
