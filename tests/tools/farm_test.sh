#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# The Slurm script of tools/README.md, run as it stands there, with fewer samples: a task for each index of its
# array, with what Slurm sets; then the merge. The picture is that of one render. So are the commands of the OpenCue job.
# Usage: farm_test.sh MORSEL SOURCE_FOLDER
set -euo pipefail
morsel=$1 source=$2
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
mkdir bin slurm opencue
printf '#!/bin/sh\nexec "$@"\n' >bin/srun
ln -s "$morsel" bin/morsel
chmod +x bin/srun
export PATH=$folder/bin:$PATH SLURM_CPUS_PER_TASK=1

cat >rock.json <<'TEXT'
{ "morsel": 1, "camera": { "position": [0, 0, 6] }, "render": { "resolution": [24, 16], "max_depth": 2 },
  "materials": [{ "name": "grey", "type": "diffuse" }],
  "geometries": [{ "name": "ball", "type": "sphere", "radius": 1 }],
  "instances": [{ "geometry": "ball", "material": "grey" }], "lights": [{ "type": "environment" }] }
TEXT
sed -n '/^    #!\/bin\/bash/,/^$/s/^    //p' "$source/tools/README.md" | sed 's/--spp 4096/--spp 32/' >rock.sh
merge=$(sed -n "s/.*--wrap '\(.*\)'$/\1/p" "$source/tools/README.md")
read -r first last < <(sed -n 's/^#SBATCH .*--array=\([0-9]*\)-\([0-9]*\).*/\1 \2/p' rock.sh)
[[ -s rock.sh && -n $merge && $last -gt $first ]] || { echo "tools/README.md has no Slurm array"; exit 1; }

morsel render rock.json --spp 32 --quiet --progress none --no-png -o whole.exr >/dev/null
cp rock.json slurm && cd slurm
for ((i = first; i <= last; ++i)); do SLURM_ARRAY_TASK_ID=$i bash ../rock.sh >>log 2>&1 || { cat log; exit 1; }; done
bash -c "$merge" >log 2>&1 || { cat log; exit 1; }
# same A B: bit by bit, but for what headers say of times.
same() {
  oiiotool "$1" --ch R,G,B "$2" --ch R,G,B --fail 0 --warn 0 --diff >log || { cat log; echo "$1 is another picture"; exit 1; }
}
same rock.exr ../whole.exr
cd ..

# The commands in the OpenCue job, frame by frame.
cp rock.json opencue && cd opencue
python=$(sed -n '/shards = Shell(/,/)$/p' "$source/tools/README.md" | tr -d '\n')
read -r first last < <(sed -n 's/.*range="\([0-9]*\)-\([0-9]*\)".*/\1 \2/p' <<<"$python")
words=$(sed -n 's/.*command=\[\([^]]*\)\].*/\1/p' <<<"$python" | grep -o '"[^"]*"' | tr -d '"' | sed 's/^4096$/32/')
[[ -n $words && $last -gt $first ]] || { echo "tools/README.md has no OpenCue job"; exit 1; }
for ((i = first; i <= last; ++i)); do
  mapfile -t command <<<"${words//#IFRAME#/$i}"
  "${command[@]}" >>log 2>&1 || { cat log; exit 1; }
done
bash -c "$merge" >log 2>&1 || { cat log; exit 1; }
same rock.exr ../whole.exr
