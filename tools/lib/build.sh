# SPDX-License-Identifier: Apache-2.0
# shellcheck shell=bash
# Configuring and building the preset `release`. Sourced, after steps.sh.

# The configuration goes by this preset; its files are in build/release.
BUILD_DIR=build/release

# Compilations that run side by side: one a processor, but not more than memory has room for (the
# largest translation units take about 1 GiB). CMAKE_BUILD_PARALLEL_LEVEL overrides.
build_jobs() {
  if [[ -n ${CMAKE_BUILD_PARALLEL_LEVEL:-} ]]; then
    echo "$CMAKE_BUILD_PARALLEL_LEVEL"
    return
  fi
  local jobs kibibytes
  jobs=$(nproc)
  kibibytes=$(awk '$1 == "MemAvailable:" { print $2 }' /proc/meminfo)
  local room=$((${kibibytes:-0} / 1200000))
  if ((room < jobs)); then jobs=$room; fi
  echo "$((jobs > 0 ? jobs : 1))"
}

# True when the build directory must be configured: it never was, the presets changed since, or
# MORSEL_WARNINGS_AS_ERRORS is set and the directory has another value. Ninja itself configures
# again when a CMake file changes.
needs_configuring() {
  [[ -f $BUILD_DIR/build.ninja && $BUILD_DIR/.configured -nt CMakePresets.json ]] || return 0
  [[ -n ${MORSEL_WARNINGS_AS_ERRORS:-} ]] &&
    ! grep -q "^MORSEL_WARNINGS_AS_ERRORS:[A-Z]*=$MORSEL_WARNINGS_AS_ERRORS\$" \
      "$BUILD_DIR/CMakeCache.txt"
}

# configure_and_build [TARGET]...: everything when no target is named.
configure_and_build() {
  local targets=()
  if (($# > 0)); then targets=(--target "$@"); fi
  begin_step "Configure"
  if needs_configuring; then
    local settings=()
    if [[ -n ${MORSEL_WARNINGS_AS_ERRORS:-} ]]; then
      settings+=("-DMORSEL_WARNINGS_AS_ERRORS=$MORSEL_WARNINGS_AS_ERRORS")
    fi
    run_logged build/logs/configure.log cmake --preset release "${settings[@]}"
    touch "$BUILD_DIR/.configured"
    end_step "$BUILD_DIR is ready"
  else
    end_step "$BUILD_DIR is up to date"
  fi

  begin_step "Build"
  if [[ ! -e $BUILD_DIR/bin/morsel && ${#targets[@]} -gt 0 ]]; then
    echo "The programs have to be compiled: about twelve minutes on two processors."
  fi
  cmake --build --preset release --parallel "$(build_jobs)" "${targets[@]}"
  end_step
}
