#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Writes splash.json: a crown of liquid metal about the drop that made it.

    python3 scenes/gallery/make_splash.py > scenes/gallery/splash.json
"""
import json
import math
import random

random.seed(2)

JETS = 13
balls = []


def ball(x, y, z, radius, weight=1.0):
    balls.append({"center": [round(x, 3), round(y, 3), round(z, 3)], "radius": round(radius, 3), "weight": weight})


def ring(radius, y, count, size):
    for i in range(count):
        a = 2 * math.pi * i / count
        ball(radius * math.cos(a), y, radius * math.sin(a), size)


# The sheet of the crown widens as it rises, and a rim runs around the pool that it left.
ring(0.80, 0.02, 30, 0.34)
ring(0.83, 0.16, 30, 0.30)
ring(0.88, 0.30, 32, 0.26)
ring(0.95, 0.43, 34, 0.24)
ring(1.35, -0.10, 40, 0.34)
# Jets grow out of its edge and end in drops.
for i in range(JETS):
    a = 2 * math.pi * (i + random.uniform(-0.22, 0.22)) / JETS
    reach, height = random.uniform(0.3, 0.5), random.uniform(0.3, 0.62)
    steps = 7
    for k in range(steps):
        t = k / (steps - 1)
        r = 0.97 + reach * t
        y = 0.46 + height * (t - 0.25 * t * t)
        size = 0.22 - 0.09 * t if k < steps - 1 else random.uniform(0.2, 0.26)
        ball(r * math.cos(a), y, r * math.sin(a), size)
# What rises in the middle after it, about to part from its drop.
for y, size in [(-0.1, 0.5), (0.08, 0.36), (0.24, 0.28), (0.38, 0.23), (0.5, 0.22), (0.66, 0.34)]:
    ball(0, y, 0, size)

scene = {
    "morsel": 1,
    "description": "A crown of liquid metal: jets grow out of its edge, ripples of noise run over it, and only what hangs together is kept.",
    "camera": {"position": [0.5, 1.9, 5.4], "look_at": [0, 0.22, 0], "vertical_fov": 29, "aperture_radius": 0.03, "blades": 6},
    "render": {"resolution": [960, 720], "spp": 96, "max_depth": 8, "filter": "blackman_harris", "exposure": 0.3, "regularization": 0.8},
    "materials": [
        {"name": "metal", "type": "principled", "color": [0.95, 0.8, 0.5], "metallic": 1, "roughness": 0.14},
        {"name": "ground", "type": "principled", "color": [0.1, 0.12, 0.16], "roughness": 0.45},
    ],
    "geometries": [
        {
            "name": "crown", "type": "hypertexture", "max_depth": 15,
            "field": {
                "density": {"type": "metaballs", "level": 0.3, "balls": "BALLS"},
                "modulations": [
                    {"type": "warp", "noise": "perlin", "amplitude": 0.09, "frequency": 2.2, "layers": 1, "seed": 4},
                    {"type": "fbm", "noise": "perlin", "amplitude": 0.16, "frequency": 3.1, "layers": 2, "hurst": 1, "seed": 9},
                ],
            },
        },
        {"name": "drop", "type": "sphere", "radius": 0.11, "segments": 128},
        {"name": "floor", "type": "rectangle", "size": [40, 40]},
    ],
    "instances": [
        {"name": "crown", "geometry": "crown", "material": "metal"},
        {"name": "drop", "geometry": "drop", "material": "metal", "translate": [0.02, 1.22, 0], "translate_end": [0.02, 1.27, 0]},
        {"name": "pool", "geometry": "floor", "material": "ground", "translate": [0, -0.14, 0]},
    ],
    "lights": [
        {"type": "environment", "file": "../assets/sunset.exr", "radiance": 0.8, "rotation": 60},
        {"type": "rectangle", "name": "window", "position": [3, 5, 3], "look_at": [0, 0, 0], "size": [4, 4], "radiance": [4, 3.8, 3.4], "visible_to_camera": False},
    ],
}
text = json.dumps(scene, indent=2)
lines = ",\n".join("          " + json.dumps(b) for b in balls)
print(text.replace('"BALLS"', "[\n" + lines + "\n        ]"))
