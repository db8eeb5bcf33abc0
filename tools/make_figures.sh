#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
set -euo pipefail

usage() {
  cat <<'TEXT'
Usage: tools/make_figures.sh [OPTION]... [FIGURE]...
Makes the pictures of scenes/figures/README.md again, after figures of the paper: 1, 2, 3, 7, 8, and table1.
Without FIGURE all of them.

  --quick             small and with few samples, to see that all works
  --output FOLDER     where to (scenes/figures of this repository)
  --work FOLDER       where to keep what is computed on the way (build/figures; with --output, FOLDER/work of that)
  --morsel PROGRAM    the command to use (build/release/bin/morsel of this repository)
  --help              show this text

Needs python3 (its standard library) and oiiotool.
Exit code: 0 done, 1 a step failed, 2 wrong usage.
TEXT
}

caller=$PWD
cd "$(dirname "${BASH_SOURCE[0]}")/.."
source tools/lib/steps.sh

all=(1 2 3 7 8 table1) figures=() quick=no output= work= morsel=$PWD/build/release/bin/morsel
# here PATH: one that the caller has given, relative to where they are.
here() { if [[ $1 == /* ]]; then printf '%s' "$1"; else printf '%s' "$caller/$1"; fi; }
wrong() {
  printf 'make_figures.sh: %s\n\n' "$1" >&2
  usage >&2
  exit 2
}
while [[ $# -gt 0 ]]; do
  case $1 in
    --quick) quick=yes ;;
    --output | --work | --morsel)
      [[ $# -gt 1 && -n $2 ]] || wrong "$1 needs a value"
      case $1 in
        --output) output=$(here "$2") ;;
        --work) work=$(here "$2") ;;
        # A name without a folder is looked up in PATH.
        --morsel) if [[ $2 == */* ]]; then morsel=$(here "$2"); else morsel=$2; fi ;;
      esac
      shift
      ;;
    --help | -h) usage; exit 0 ;;
    -*) wrong "unknown option $1" ;;
    *)
      [[ " ${all[*]} " == *" $1 "* ]] || wrong "unknown figure $1: one of ${all[*]}"
      figures+=("$1")
      ;;
  esac
  shift
done
[[ ${#figures[@]} -gt 0 ]] || figures=("${all[@]}")
for program in "$morsel" python3 oiiotool; do
  command -v "$program" >/dev/null || { echo "make_figures.sh: $program is missing" >&2; exit 1; }
done

scenes=scenes/figures
work=${work:-${output:+$output/work}}
work=${work:-build/figures}
output=${output:-scenes/figures}
mkdir -p "$work" "$output"

# render SCENE NAME SPP SIZE FLAG...: a picture $work/NAME.png.
render() {
  local scene=$1 name=$2 spp=$3 size=$4
  shift 4
  if [[ $quick == yes ]]; then spp=4 size=128x128; fi
  "$morsel" render "$scene" -o "$work/$name.exr" --log-level warn --progress none --spp "$spp" --resolution "$size" "$@"
}
# mosaic COLUMNSxROWS FILE NAME...: the pictures side by side, as a JPEG.
mosaic() {
  local shape=$1 file=$2
  shift 2
  oiiotool "${@/#/$work/}" --mosaic:pad=6 "$shape" --ch R,G,B --compression jpeg:88 -o "$output/$file"
}
# build SCENE FILE: its topology with critical points and their network.
build() {
  "$morsel" cache build "$1" --engine both --audit-euler octree --progress none -o "$2"
}

figure_1() {
  local a
  for a in 01 03 08; do render "$scenes/figure1_a$a.json" "figure1_a$a" 64 400x400; done
  mosaic 3x1 figure1.jpg figure1_a{01,03,08}.png
}

figure_2() {
  build "$scenes/table1_l1.json" "$work/table1_l1.topo"
  "$morsel" cache export "$work/table1_l1.topo" --csv -o "$work/table1_l1.csv"
  "$morsel" field sample "$scenes/table1_l1.json" --resolution 65 --progress none -o "$work/table1_l1.npy"
  python3 tools/figures/voxel_scene.py "$scenes/table1_l1.json" "$work/table1_l1.npy" "$work/table1_l1.csv" "$work"
  render "$work/voxels.json" voxels 64 480x400
  render "$work/certified.json" certified 64 480x400
  mosaic 2x1 figure2.jpg voxels.png certified.png
}

# network SCENE NAME RADIUS FILE PART...: the parts of the network over the picture.
network() {
  local scene=$1 name=$2 radius=$3 part parts=()
  shift 3
  build "$scene" "$work/$name.topo"
  for part in "$@"; do
    "$morsel" cache export "$work/$name.topo" --ply --parts "$part" --radius "$radius" -o "$work/${name}_$part.ply"
    parts+=("$part=${name}_$part.ply")
  done
  python3 tools/figures/network_scene.py "$scene" "${parts[@]}" "$work/${name}_network.json"
}

figure_3() {
  network "$scenes/figure3.json" figure3 0.02 maxima saddles separatrices
  render "$work/figure3_network.json" figure3 64 512x512
  mosaic 1x1 figure3.jpg figure3.png
}

# The scenes' cameras look at the main component; among all of them some would be cut by the frame.
wide=(--set camera.vertical_fov=48)

figure_7() {
  network "$scenes/table1_l1.json" table1_l1 0.006 maxima separatrices
  render "$work/table1_l1_network.json" figure7 16 640x640 "${wide[@]}"
  mosaic 1x1 figure7.jpg figure7.png
}

figure_8() {
  local l names=()
  for l in 1 3; do
    render "$scenes/table1_l$l.json" "original_l$l" 64 480x480 "${wide[@]}" --keep all \
      --set 'materials.debris.color=[0.55, 0.5, 0.45]'
    render "$scenes/table1_l$l.json" "detached_l$l" 64 480x480 "${wide[@]}" --keep all
    render "$scenes/table1_l$l.json" "corrected_l$l" 64 480x480 "${wide[@]}"
  done
  for name in original detached corrected; do names+=("${name}_l1.png" "${name}_l3.png"); done
  mosaic 2x3 figure8.jpg "${names[@]}"
}

figure_table1() {
  local l layers=(1 2 3) rows=()
  if [[ $quick == yes ]]; then layers=(1); fi
  for l in "${layers[@]}"; do
    "$morsel" cache compare "$scenes/table1_l$l.json" --engine certified,morse --json --progress none >"$work/table1_l$l.json"
    rows+=("$l=$work/table1_l$l.json")
  done
  python3 tools/figures/table.py "${rows[@]}" | tee "$work/table1.md"
}

for figure in "${figures[@]}"; do
  begin_step "Figure $figure"
  "figure_$figure"
  end_step
done
print_times
