#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Figures 3 and 7: a scene with the network of its first hypertexture laid over its picture.

Usage: network_scene.py SCENE PART=FILE.ply... OUTPUT.json
PART is maxima, saddles or separatrices, FILE of `morsel cache export --ply --parts PART`, in OUTPUT's folder.

The network lies inside the solid. Shrunk towards the camera it keeps its place in the picture and comes to stand in
front of everything: by 1/4, so that the object has to be farther from the camera than a quarter of its far side."""
import json
import pathlib
import sys

scene_file, *parts, output = sys.argv[1:]
scene = json.loads(pathlib.Path(scene_file).read_text())
scene["geometries"][0]["keep"] = "all"
shrink = 0.25
eye = scene["camera"]["position"]
colours = {"maxima": [0.85, 0.1, 0.02], "saddles": [0.02, 0.2, 0.75], "separatrices": [0.01, 0.01, 0.01]}
for part in parts:
    name, _, file = part.partition("=")
    scene["materials"].append({"name": name, "type": "diffuse", "color": colours[name]})
    scene["geometries"].append({"name": name, "type": "mesh", "file": file})
    scene["instances"].append({"geometry": name, "material": name, "scale": shrink,
                               "translate": [(1 - shrink) * x for x in eye],
                               "casts_shadow": False, "visible_to_bounces": False})
pathlib.Path(output).write_text(json.dumps(scene, indent=1))
