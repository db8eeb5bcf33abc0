#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Writes fur.json: a ball of fur, made of instances of one tuft of fine noise that are drawn out along its normals.

    python3 scenes/gallery/make_fur.py > scenes/gallery/fur.json
"""
import json
import math
import random

random.seed(5)

TUFTS = 420
# The tuft is noise of one cell a unit, 11 wide and 2.4 high: so many hairs stand on it.
WIDTH, LENGTH = 0.026, 0.17


def direction(i):
    """Fibonacci's points on a sphere, a little out of place."""
    y = 1 - (2 * i + 1) / TUFTS
    angle = i * math.pi * (3 - math.sqrt(5))
    r = math.sqrt(1 - y * y)
    d = [r * math.cos(angle), y, r * math.sin(angle)]
    d = [x + random.gauss(0, 0.04) for x in d]
    d[1] -= 0.02
    length = math.hypot(*d)
    return [x / length for x in d]


def tuft(i):
    n = direction(i)
    # Hair hangs: what leans is turned downwards.
    lean = [n[0], n[1] - 0.35 * math.hypot(n[0], n[2]), n[2]]
    lean = [x + random.gauss(0, 0.1) for x in lean]
    length = math.hypot(*lean)
    lean = [x / length for x in lean]
    return {
        "name": f"tuft {i}",
        "geometry": "tuft",
        "material": "fur",
        "scale": [WIDTH, round(LENGTH * random.uniform(0.85, 1.2), 4), WIDTH],
        "rotate": [
            round(math.degrees(math.acos(lean[1])), 2),
            round(math.degrees(math.atan2(lean[0], lean[2])), 2),
            0,
        ],
        "translate": [round(0.97 * x, 4) for x in n],
    }


scene = {
    "morsel": 1,
    "description": "A ball of fur: one tuft of fine noise, drawn out to hairs, in instances all over a sphere.",
    "camera": {"position": [0, 0.6, 6.3], "look_at": [0, 0.02, 0], "vertical_fov": 31},
    "render": {"resolution": [720, 720], "spp": 96, "max_depth": 5, "filter": "blackman_harris", "exposure": 0.5},
    "textures": [
        {
            "name": "strands", "type": "ramp", "input": "density", "low": -0.75, "high": 0.55,
            "stops": [[0, [0.7, 0.46, 0.24]], [0.5, [0.4, 0.19, 0.08]], [1, [0.07, 0.03, 0.015]]],
        }
    ],
    "materials": [
        {
            "name": "fur", "type": "principled", "color": [1, 1, 1], "color_texture": "strands", "roughness": 0.45,
            "sheen_color": [0.3, 0.24, 0.18], "sheen_roughness": 0.4,
        },
        {"name": "skin", "type": "diffuse", "color": [0.09, 0.05, 0.03]},
        {"name": "ground", "type": "diffuse", "color": [0.32, 0.33, 0.36]},
    ],
    "geometries": [
        {
            "name": "tuft", "type": "hypertexture",
            "field": {
                "density": {"type": "ellipsoid", "radii": [5.5, 1.2, 5.5]},
                "modulations": [
                    {"type": "fbm", "noise": "perlin", "amplitude": 2.6, "frequency": 0.9, "layers": 1, "seed": 3}
                ],
            },
        },
        {"name": "ball", "type": "sphere", "radius": 1, "segments": 128},
        {"name": "floor", "type": "rectangle", "size": [40, 40]},
    ],
    "instances": [
        {"name": "skin", "geometry": "ball", "material": "skin", "scale": 0.99},
        {"name": "ground", "geometry": "floor", "material": "ground", "translate": [0, -1.2, 0]},
    ]
    + [tuft(i) for i in range(TUFTS)],
    "lights": [
        {"type": "environment", "radiance": [0.35, 0.4, 0.5]},
        {"type": "rectangle", "name": "key", "position": [-4, 5, 3], "look_at": [0, 0, 0], "size": [3, 3], "radiance": [11, 10, 8.6], "visible_to_camera": False},
        {"type": "rectangle", "name": "rim", "position": [3.5, 3, -4], "look_at": [0, 0, 0], "size": [1.5, 1.5], "radiance": [14, 15, 18], "visible_to_camera": False},
    ],
}

# One line for each of what there are many of.
text = json.dumps({**scene, "instances": "INSTANCES"}, indent=2)
lines = ",\n".join("    " + json.dumps(i) for i in scene["instances"])
print(text.replace('"INSTANCES"', "[\n" + lines + "\n  ]"))
