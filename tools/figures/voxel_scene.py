#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Figure 2: finds two certified components that region growing over voxels takes for one, and writes the scenes
that show them: FOLDER/voxels.json (the voxels of that region) and FOLDER/certified.json (the components).

Usage: voxel_scene.py SCENE SAMPLES.npy POINTS.csv FOLDER
SAMPLES of `morsel field sample`, POINTS of `morsel cache export --csv`. A voxel is solid when one of its corners
is, and voxels that share a face belong together, as in `morsel cache compare`."""
import array
import ast
import csv
import json
import math
import pathlib
import sys

scene_file, samples_file, points_file, folder = sys.argv[1:5]
folder = pathlib.Path(folder)
scene = json.loads(pathlib.Path(scene_file).read_text())
rock = next(g for g in scene["geometries"] if g["type"] == "hypertexture")
low, high = rock["bounds"]["min"], rock["bounds"]["max"]

with open(samples_file, "rb") as file:
    assert file.read(6) == b"\x93NUMPY", samples_file
    file.read(2)
    header = ast.literal_eval(file.read(int.from_bytes(file.read(2), "little")).decode())
    samples = array.array("d", file.read())
corners = header["shape"][0]
n = corners - 1
size = [(high[i] - low[i]) / n for i in range(3)]


def solid(x, y, z):
    at = (z * corners + y) * corners + x
    return any(samples[at + i] > 0 for i in OFFSETS)


OFFSETS = [(z * corners + y) * corners + x for z in (0, 1) for y in (0, 1) for x in (0, 1)]
inside = {(x, y, z) for z in range(n) for y in range(n) for x in range(n) if solid(x, y, z)}


def faces(v):
    for axis in range(3):
        for step in (-1, 1):
            yield axis, step, tuple(v[i] + (step if i == axis else 0) for i in range(3))


region_of, regions = {}, []
for start in sorted(inside):
    if start in region_of:
        continue
    region, frontier = [], [start]
    region_of[start] = len(regions)
    while frontier:
        v = frontier.pop()
        region.append(v)
        for _, _, w in faces(v):
            if w in inside and w not in region_of:
                region_of[w] = len(regions)
                frontier.append(w)
    regions.append(region)

# The components whose maxima lie in each region; and where those maxima are.
held, maxima = {}, {}
for row in csv.DictReader(open(points_file)):
    if row["type"] != "maximum" or row["component"] == "":
        continue
    p = [float(row[axis]) for axis in "xyz"]
    voxel = tuple(min(n - 1, max(0, int((p[i] - low[i]) / size[i]))) for i in range(3))
    maxima.setdefault(int(row["component"]), []).append(p)
    if voxel in region_of:
        held.setdefault(region_of[voxel], set()).add(int(row["component"]))
joined = sorted((len(regions[r]), r) for r, ids in held.items() if len(ids) > 1)
missed = len(maxima) - len(set().union(*held.values()))
print(f"{n}^3 voxels: {len(regions)} regions, {len(maxima)} certified components: {len(joined)} regions hold several, "
      f"{missed} components hold no sample")
if not joined:
    sys.exit("voxel_scene.py: no region holds two components: take fewer samples")
# The smallest one can see. A pair, and enough voxels for a picture, where there is one.
voxels, chosen = next(((c, r) for c, r in joined if len(held[r]) == 2 and c > 8), joined[0])
ids = sorted(held[chosen])
print(f"drawn: a region of {voxels} voxels, which joins the components {', '.join(map(str, ids))}")

# Its voxels as boxes with gaps between them.
vertices, quads = [], []
for v in regions[chosen]:
    at = len(vertices)
    vertices += [[low[i] + (v[i] + (0.96 if corner >> i & 1 else 0.04)) * size[i] for i in range(3)] for corner in range(8)]
    quads += [[at + i for i in q] for q in
              ((0, 2, 3, 1), (4, 5, 7, 6), (0, 1, 5, 4), (2, 6, 7, 3), (0, 4, 6, 2), (1, 3, 7, 5))]
with open(folder / "voxels.ply", "w") as file:
    file.write(f"ply\nformat ascii 1.0\nelement vertex {len(vertices)}\nproperty float x\nproperty float y\nproperty float z\n"
               f"element face {len(quads)}\nproperty list uchar uint vertex_indices\nend_header\n")
    for p in vertices:
        file.write("%.7g %.7g %.7g\n" % tuple(p))
    for q in quads:
        file.write("4 %d %d %d %d\n" % tuple(q))

# A camera that looks across the line from one component to the other, so that the gap shows.
least = [min(p[i] for p in vertices) for i in range(3)]
most = [max(p[i] for p in vertices) for i in range(3)]
center = [(a + b) / 2 for a, b in zip(least, most)]
radius = math.dist(least, most) / 2


def mean(points):
    return [sum(p[i] for p in points) / len(points) for i in range(3)]


def normalized(v):
    length = math.hypot(*v)
    return [x / length for x in v] if length > 0 else [0, 0, 1]


line = normalized([b - a for a, b in zip(mean(maxima[ids[0]]), mean(maxima[ids[1]]))])
up = [0, 1, 0] if abs(line[1]) < 0.8 else [1, 0, 0]
across = normalized([line[1] * up[2] - line[2] * up[1], line[2] * up[0] - line[0] * up[2], line[0] * up[1] - line[1] * up[0]])
up = normalized([across[1] * line[2] - across[2] * line[1], across[2] * line[0] - across[0] * line[2], across[0] * line[1] - across[1] * line[0]])
view = normalized([across[i] + 0.35 * up[i] for i in range(3)])
eye = [center[i] + 3.4 * radius * view[i] for i in range(3)]


def light(direction, strength):
    return {"type": "rectangle", "position": [center[i] + 6 * radius * direction[i] for i in range(3)], "look_at": center,
            "size": [4 * radius, 4 * radius], "radiance": strength, "visible_to_camera": False}


colours = [[0.75, 0.42, 0.12], [0.1, 0.35, 0.65], [0.2, 0.55, 0.2], [0.5, 0.2, 0.5]]
common = {
    "morsel": 1,
    "camera": {"position": eye, "look_at": center, "up": up, "vertical_fov": 32},
    "render": {"resolution": [480, 400], "spp": 64, "max_depth": 5},
    "lights": [{"type": "environment", "radiance": [0.5, 0.52, 0.56]},
               light(normalized([view[i] + 0.8 * up[i] - 0.6 * line[i] for i in range(3)]), 3)],
}
grey = [{"name": "voxel", "type": "diffuse", "color": [0.5, 0.5, 0.48]}]
boxes = {**common, "materials": grey, "geometries": [{"name": "voxels", "type": "mesh", "file": "voxels.ply", "smooth": False}],
         "instances": [{"geometry": "voxels", "material": "voxel"}]}
pieces = {**common,
          "materials": [{"name": f"piece {i}", "type": "diffuse", "color": colours[k % 4]} for k, i in enumerate(ids)],
          "geometries": [{**rock, "name": f"piece {i}", "keep": f"ids:{i}"} for i in ids],
          "instances": [{"geometry": f"piece {i}", "material": f"piece {i}"} for i in ids]}
(folder / "voxels.json").write_text(json.dumps(boxes, indent=1))
(folder / "certified.json").write_text(json.dumps(pieces, indent=1))
