#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# The scripts in tools/ without installing or building anything: apt, dpkg and cmake are stood in for by
# programs that note how they were called.
set -euo pipefail

root=$(cd "$(dirname "${BASH_SOURCE[0]}")/../.." && pwd)
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
failures=0
# check WHAT COMMAND...: the command must succeed.
check() {
  local what=$1
  shift
  if ! "$@"; then
    printf 'Failed: %s\n' "$what"
    failures=$((failures + 1))
  fi
}
exit_code() {
  local status=0
  "$@" >"$folder/output" 2>&1 || status=$?
  echo "$status"
}

# Options.
for script in quickstart run_tests fuzz make_figures tsan static_analysis; do
  check "$script --help exits 0" test "$(exit_code "$root/tools/$script.sh" --help)" = 0
  check "$script --help shows the usage" grep -q "^Usage: tools/$script.sh" "$folder/output"
  check "$script: unknown option exits 2" test "$(exit_code "$root/tools/$script.sh" --frobnicate)" = 2
  check "$script names the unknown option" grep -q -- "unknown option --frobnicate" "$folder/output"
done

check "static_analysis: -j without a number exits 2" test "$(exit_code "$root/tools/static_analysis.sh" -j abc)" = 2
check "tsan: --tbb-source without a folder exits 2" test "$(exit_code "$root/tools/tsan.sh" --tbb-source)" = 2

# Packages. The stand-ins: every package but those in $MISSING is installed.
mkdir -p "$folder/bin" "$folder/clone"
cat >"$folder/bin/dpkg-query" <<'TEXT'
#!/usr/bin/env bash
[[ " $MISSING " == *" ${!#} "* ]] && exit 1
printf installed
TEXT
cat >"$folder/bin/apt-get" <<'TEXT'
#!/usr/bin/env bash
echo "$*" >>"$CALLS"
TEXT
cat >"$folder/bin/sudo" <<'TEXT'
#!/usr/bin/env bash
exit 1
TEXT
chmod +x "$folder"/bin/*
export CALLS=$folder/calls
install_with_missing() {
  : >"$CALLS"
  (
    export MISSING=$1 PATH=$folder/bin:$PATH
    cd "$folder/clone"
    exit_code bash -c "set -euo pipefail; source '$root/tools/lib/steps.sh'
      source '$root/tools/lib/packages.sh'; install_packages" </dev/null
  )
}

check "nothing missing: exit 0" test "$(install_with_missing "")" = 0
check "nothing missing: apt is not called" test ! -s "$CALLS"

status=$(install_with_missing "ninja-build libhwy-dev")
if [[ $EUID -eq 0 ]]; then
  check "as root: exit 0" test "$status" = 0
  check "as root: package lists first" grep -qE 'update$' <(head -n 1 "$CALLS")
  check "as root: only what is missing" \
    grep -qE 'install -y --no-install-recommends ninja-build libhwy-dev$' "$CALLS"
else
  check "neither root nor sudo: exit 2" test "$status" = 2
  check "neither root nor sudo: apt is not called" test ! -s "$CALLS"
  check "neither root nor sudo: the command is printed" \
    grep -q 'apt-get install -y --no-install-recommends ninja-build libhwy-dev$' "$folder/output"
fi

# Configuring: once, again when the presets or MORSEL_WARNINGS_AS_ERRORS change, and not otherwise.
cat >"$folder/bin/cmake" <<'TEXT'
#!/usr/bin/env bash
[[ $1 == --build ]] && exit 0
echo "$*" >>"$CALLS"
mkdir -p build/release
touch build/release/build.ninja
setting=OFF
for argument in "$@"; do
  [[ $argument == -DMORSEL_WARNINGS_AS_ERRORS=* ]] && setting=${argument#*=}
done
echo "MORSEL_WARNINGS_AS_ERRORS:BOOL=$setting" >build/release/CMakeCache.txt
TEXT
chmod +x "$folder/bin/cmake"
touch -d '1 hour ago' "$folder/clone/CMakePresets.json"
configure_calls() {
  : >"$CALLS"
  (
    export PATH=$folder/bin:$PATH
    cd "$folder/clone"
    bash -c "set -euo pipefail; source '$root/tools/lib/steps.sh'; source '$root/tools/lib/build.sh'
      configure_and_build" >"$folder/output" 2>&1
  )
  wc -l <"$CALLS"
}
unset MORSEL_WARNINGS_AS_ERRORS
check "a new folder is configured" test "$(configure_calls)" = 1
check "a configured folder is left alone" test "$(configure_calls)" = 0
export MORSEL_WARNINGS_AS_ERRORS=ON
check "another setting: configured again" test "$(configure_calls)" = 1
check "the setting reaches cmake" grep -q -- '-DMORSEL_WARNINGS_AS_ERRORS=ON' "$CALLS"
check "the same setting: left alone" test "$(configure_calls)" = 0
unset MORSEL_WARNINGS_AS_ERRORS
check "no setting keeps the folder's own" test "$(configure_calls)" = 0
touch -d '1 hour' "$folder/clone/CMakePresets.json"
check "changed presets: configured again" test "$(configure_calls)" = 1

# A picture is made again when the program, the scene, an asset or the cache is newer, else not.
cd "$folder/clone"
mkdir -p build/release/bin scenes/assets pictures
touch -d '2 hours ago' build/release/bin/morsel build/release/bin/morsel-render scenes/default.json scenes/assets/bunny.obj \
  scenes/README.md scenes/rock.topo
touch -d '1 hour ago' pictures/default.exr
newer() {
  bash -c "set -euo pipefail; source '$root/tools/lib/build.sh'; source '$root/tools/lib/pictures.sh'
    newer_inputs scenes/default.json pictures/default.exr"
}
check "nothing is newer than the picture" test -z "$(newer)"
for file in build/release/bin/morsel build/release/bin/morsel-render scenes/default.json \
  scenes/assets/bunny.obj scenes/rock.topo; do
  touch "$file"
  check "$file is newer than the picture" test "$(newer)" = "$file"
  touch -d '2 hours ago' "$file"
done
touch scenes/README.md
check "documents do not matter" test -z "$(newer)"

# Figures: paths are those of whoever calls, and nothing is left in the repository when the pictures go elsewhere.
for program in morsel oiiotool python3; do
  cat >"$folder/bin/$program" <<'TEXT'
#!/usr/bin/env bash
echo "$*" >>"$CALLS"
for file in "$@"; do :; done
[[ ${0##*/} != oiiotool ]] || touch "$file"
TEXT
  chmod +x "$folder/bin/$program"
done
figures() {
  : >"$CALLS"
  PATH=$folder/bin:$PATH exit_code "$root/tools/make_figures.sh" --quick "$@" 1
}
intermediate=work  # in the folder of the output, unless --work says otherwise
check "figures: exit 0" test "$(figures --output ../figures --morsel ../bin/morsel)" = 0
check "figures: the output is relative to the caller" test -f "$folder/figures/figure1.jpg"
check "figures: what is made on the way is beside it" grep -q -- "-o $folder/clone/../figures/$intermediate/figure1_a08.exr" "$CALLS"
check "figures: another folder for it" test "$(figures --output "$folder/figures" --morsel morsel --work on/the/way)" = 0
check "figures: that is relative to the caller, too" grep -q -- "-o $folder/clone/on/the/way/figure1_a08.exr" "$CALLS"

exit $((failures > 0))
