#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Writes meshes.json: a crowd of textured bunnies and balls on tiles.

    python3 scenes/bench/make_meshes.py > scenes/bench/meshes.json
"""
import json
import random

random.seed(3)


def image(name, file, **more):
    return {"name": name, "type": "image", "file": "../assets/" + file, **more}


def principled(name, **more):
    return {"name": name, "type": "principled", "color": [1, 1, 1], **more}


instances = [{"name": "floor", "geometry": "floor", "material": "tiles"}]
for i in range(1400):
    x, z = random.uniform(-9, 9), 3.5 - 18 * random.random()
    if i % 4:
        size = round(random.uniform(0.05, 0.085), 3)
        what = {"geometry": "bunny", "material": random.choice(["marble", "marble", "bronze"]), "scale": size, "rotate": [0, random.randrange(360), 0], "translate": [round(x, 2), 0, round(z, 2)]}
    else:
        size = round(random.uniform(0.12, 0.3), 2)
        what = {"geometry": "ball", "material": random.choice(["tiled", "veined", "lacquer"]), "scale": size, "rotate": [random.randrange(360) for _ in range(3)], "translate": [round(x, 2), size, round(z, 2)]}
    instances.append({"name": f"{what['geometry']} {i}", **what})

scene = {
    "morsel": 1,
    "description": "Meshes alone, every one of them textured, under an environment: what `morsel bench` measures the share of Embree in. Made by make_meshes.py.",
    "camera": {"position": [0, 2.2, 7.2], "look_at": [0, 0.2, -1.2], "vertical_fov": 34},
    "render": {"resolution": [960, 540], "spp": 64, "max_depth": 6, "filter": "blackman_harris", "exposure": 0.2},
    "textures": [
        image("tiles_color", "tiles_color.jpg", scale=[10, 10]),
        image("tiles_roughness", "tiles_roughness.jpg", scale=[10, 10]),
        image("tiles_normal", "tiles_normal.jpg", scale=[10, 10]),
        image("ball_color", "tiles_color.jpg", scale=[2, 1]),
        image("ball_normal", "tiles_normal.jpg", scale=[2, 1]),
        image("veins", "marble_color.jpg", scale=[2, 1]),
        image("marble", "marble_color.jpg", mapping="triplanar", size=7),
    ],
    "materials": [
        principled("tiles", color_texture="tiles_color", roughness=1, roughness_texture="tiles_roughness", normal_texture="tiles_normal"),
        principled("tiled", color_texture="ball_color", roughness=0.4, normal_texture="ball_normal"),
        principled("veined", color_texture="veins", roughness=0.15),
        {**principled("lacquer", color_texture="veins", roughness=0.5, clearcoat=1, clearcoat_roughness=0.05), "color": [0.7, 0.12, 0.08]},
        principled("marble", color_texture="marble", roughness=0.3),
        {**principled("bronze", color_texture="marble", metallic=1, roughness=0.45), "color": [0.75, 0.5, 0.3]},
    ],
    "geometries": [
        {"name": "floor", "type": "rectangle", "size": [20, 20]},
        {"name": "ball", "type": "sphere", "radius": 1, "segments": 256},
        {"name": "bunny", "type": "mesh", "file": "../assets/bunny.obj"},
    ],
    "instances": instances,
    "lights": [{"type": "environment", "file": "../assets/courtyard.exr", "rotation": 40}],
}
# One element a line.
print("{")
for n, (key, value) in enumerate(scene.items()):
    comma = "," if n < len(scene) - 1 else ""
    if isinstance(value, list):
        print(f'  "{key}": [\n    ' + ",\n    ".join(json.dumps(e) for e in value) + "\n  ]" + comma)
    else:
        print(f'  "{key}": {json.dumps(value)}{comma}')
print("}")
