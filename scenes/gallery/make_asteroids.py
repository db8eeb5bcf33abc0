#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Writes asteroids.json: a belt of hypertexture rocks, and mesh pebbles between them.

    python3 scenes/gallery/make_asteroids.py > scenes/gallery/asteroids.json
"""
import json
import math
import random

random.seed(7)


def place(name, geometry, material, size, spread):
    """One instance somewhere in the belt, turned at random."""
    angle = random.uniform(0.1 * math.pi, 0.9 * math.pi)
    radius = 34 + random.gauss(0, spread)
    turn = [round(random.uniform(0, 360), 1) for _ in range(3)]
    at = [radius * math.cos(angle), random.gauss(0, 1.6), 24 - radius * math.sin(angle)]
    return {
        "name": name,
        "geometry": geometry,
        "material": material,
        "scale": round(size, 3),
        "rotate": turn,
        "translate": [round(x, 3) for x in at],
    }


def rock(name, seed, amplitude):
    """A hypertexture of two layers."""
    return {
        "name": name,
        "type": "hypertexture",
        "max_depth": 9,
        "field": {
            "density": {"type": "sphere", "radius": 1},
            "modulations": [
                {
                    "type": "fbm",
                    "noise": "sparse_convolution",
                    "amplitude": amplitude,
                    "frequency": 1.4,
                    "layers": 2,
                    "hurst": 0.8,
                    "seed": seed,
                }
            ],
        },
    }


rocks = ["rock_a", "rock_b", "rock_c"]
instances = []
for i in range(320):
    size = min(2.6, 0.25 + random.expovariate(2.2))
    instances.append(place(f"rock {i}", random.choice(rocks), "stone", size, 7))
for i in range(2600):
    size = 0.03 + random.expovariate(18)
    instances.append(place(f"pebble {i}", "pebble", "dust", size, 9))

scene = {
    "morsel": 1,
    "description": "An asteroid field: 320 instances of three hypertextures among 2600 of a mesh; made by make_asteroids.py.",
    "camera": {"position": [0, 3.2, 8], "look_at": [0, 0.2, -10], "vertical_fov": 38},
    "render": {"resolution": [1280, 720], "spp": 64, "max_depth": 4, "filter": "blackman_harris", "exposure": 0.4},
    "textures": [
        {
            "name": "crust",
            "type": "ramp",
            "input": "noise",
            "low": -0.35,
            "high": 0.35,
            "stops": [[0, [0.16, 0.13, 0.11]], [0.5, [0.36, 0.31, 0.27]], [1, [0.6, 0.55, 0.5]]],
        }
    ],
    "materials": [
        {"name": "stone", "type": "principled", "color": [1, 1, 1], "color_texture": "crust", "roughness": 0.8, "diffuse_roughness": 0.9, "specular": 0.3},
        {"name": "dust", "type": "diffuse", "color": [0.3, 0.27, 0.24], "diffuse_roughness": 0.9},
    ],
    "geometries": [rock("rock_a", 3, 0.6), rock("rock_b", 8, 0.5), rock("rock_c", 15, 0.7), {"name": "pebble", "type": "sphere", "radius": 1, "segments": 10}],
    "lights": [
        {"type": "environment", "radiance": [0.012, 0.014, 0.02]},
        {"type": "distant", "name": "sun", "direction": [0.75, -0.35, -0.45], "angular_diameter": 0.6, "irradiance": [4.2, 3.9, 3.5]},
    ],
}
text = json.dumps(scene, indent=2)
print(text[:-2] + ',\n  "instances": [\n    ' + ",\n    ".join(json.dumps(i) for i in instances) + "\n  ]\n}")
