# SPDX-License-Identifier: Apache-2.0
# shellcheck shell=bash
# The default scene's cache and picture. Sourced, after build.sh.

MORSEL=$BUILD_DIR/bin/morsel

# build_topology_cache SCENE: morsel itself leaves a cache alone whose fingerprint is right.
build_topology_cache() {
  begin_step "Topology cache"
  "$MORSEL" cache build "$1"
  end_step
}

# Prints the files that the picture of a scene is made from and that are newer than the picture.
newer_inputs() {
  local scene=$1 picture=$2
  find "$BUILD_DIR/bin" "$(dirname "$scene")" -type f -newer "$picture" \
    \( -path "$MORSEL" -o -path "$MORSEL-render" -o -path "$scene" -o -path '*/assets/*' -o -name '*.topo' \)
}

# render_picture SCENE FILE.exr [FLAG]...: unless the picture is newer than everything it is made from.
render_picture() {
  local scene=$1 picture=$2
  shift 2
  begin_step "Render"
  if [[ -f $picture && -z $(newer_inputs "$scene" "$picture") ]]; then
    end_step "$picture is up to date"
    return
  fi
  mkdir -p "$(dirname "$picture")"
  "$MORSEL" render "$scene" -o "$picture" "$@"
  end_step
}

# list_pictures FILE.exr: the picture and the PNG preview beside it.
list_pictures() {
  printf '\nThe pictures:\n'
  local file
  for file in "$1" "${1%.exr}.png"; do
    if [[ -f $file ]]; then printf '  %s\n' "$PWD/$file"; fi
  done
}
