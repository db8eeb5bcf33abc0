#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Writes asteroids.json: a belt of hypertexture rocks and mesh pebbles that leads past a planet.

    python3 scenes/gallery/make_asteroids.py > scenes/gallery/asteroids.json
"""
import json
import math
import random

random.seed(11)

# The belt is part of a ring of this radius about CENTRE, in the plane y = 0.
RADIUS, CENTRE = 70, (0, 0, -70)
CAMERA, TOWARDS = (-7, 4.2, 15), (6, -0.6, -22)
HERO = (-2.6, 1.5, 3.2)


def distance(a, b):
    return math.dist(a, b)


def away_from_lines(at, size):
    """Whether a rock leaves the view free: nothing large close to the camera or before the hero."""
    if distance(at, CAMERA) < 7 + 6 * size:
        return False
    return distance(at, HERO) > 3 + 2 * size


def place(name, geometry, material, size, spread):
    """One instance somewhere in the belt, turned at random; denser further away."""
    while True:
        angle = -0.45 + 2.4 * random.random() ** 1.15
        radius = RADIUS + random.gauss(0, spread)
        at = (
            CENTRE[0] + radius * math.sin(angle),
            random.gauss(0, 0.16 * spread),
            CENTRE[2] + radius * math.cos(angle),
        )
        if away_from_lines(at, size):
            break
    turn = [round(random.uniform(0, 360), 1) for _ in range(3)]
    return {
        "name": name,
        "geometry": geometry,
        "material": material,
        "scale": round(size, 3),
        "rotate": turn,
        "translate": [round(x, 3) for x in at],
    }


def star(i):
    """A small lamp far behind everything."""
    while True:
        d = [random.gauss(0, 1) for _ in range(3)]
        length = math.hypot(*d)
        d = [x / length for x in d]
        if d[2] < -0.2:
            break
    return {
        "name": f"star {i}",
        "geometry": "star",
        "material": "starlight",
        "scale": round(0.25 + min(0.9, random.expovariate(4)), 3),
        "translate": [round(900 * x, 2) for x in d],
        "visible_to_bounces": False,
        "casts_shadow": False,
    }


def rock(name, seed, amplitude):
    """A hypertexture of two layers."""
    return {
        "name": name,
        "type": "hypertexture",
        "max_depth": 14,
        "field": {
            "density": {"type": "ellipsoid", "radii": [1.15, 0.85, 0.95]},
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
instances = [
    {"name": "hero", "geometry": "rock_b", "material": "stone", "scale": 1.9, "rotate": [20, 200, 10], "translate": list(HERO)},
    {"name": "planet", "geometry": "planet", "material": "clouds", "rotate": [18, 30, 12], "translate": [96, -6, -330]},
]
for i in range(360):
    size = min(2.4, 0.18 + random.expovariate(2.6))
    instances.append(place(f"rock {i}", random.choice(rocks), "stone", size, 6.5))
for i in range(3000):
    size = 0.02 + min(0.3, random.expovariate(22))
    instances.append(place(f"pebble {i}", "pebble", "dust", size, 8))
for i in range(500):
    instances.append(star(i))

scene = {
    "morsel": 1,
    "description": "An asteroid field: 361 instances of three hypertextures among 3000 of a mesh, before a planet and 500 lamps for stars; made by make_asteroids.py.",
    "camera": {"position": CAMERA, "look_at": TOWARDS, "vertical_fov": 36},
    "render": {"resolution": [1280, 720], "spp": 64, "max_depth": 4, "filter": "blackman_harris", "exposure": 0.2},
    "textures": [
        {
            "name": "crust",
            "type": "ramp",
            "input": "noise",
            "low": -0.3,
            "high": 0.4,
            "stops": [[0, [0.07, 0.05, 0.04]], [0.4, [0.2, 0.16, 0.13]], [0.65, [0.34, 0.29, 0.24]], [1, [0.55, 0.49, 0.43]]],
        },
        {
            "name": "bands",
            "type": "ramp",
            "input": "height",
            "low": -1,
            "high": 1,
            "stops": [
                [0, [0.2, 0.16, 0.16]], [0.2, [0.5, 0.36, 0.28]], [0.3, [0.68, 0.55, 0.42]], [0.36, [0.42, 0.27, 0.2]], [0.45, [0.75, 0.65, 0.52]],
                [0.52, [0.8, 0.7, 0.58]], [0.56, [0.5, 0.31, 0.22]], [0.64, [0.7, 0.56, 0.44]], [0.8, [0.46, 0.36, 0.32]], [1, [0.22, 0.2, 0.22]],
            ],
        },
    ],
    "materials": [
        {"name": "stone", "type": "principled", "color": [1, 1, 1], "color_texture": "crust", "roughness": 0.8, "diffuse_roughness": 0.9, "specular": 0.3},
        {"name": "dust", "type": "diffuse", "color": [0.3, 0.26, 0.22], "diffuse_roughness": 0.9},
        {"name": "clouds", "type": "principled", "color": [1, 1, 1], "color_texture": "bands", "roughness": 1, "specular": 0},
        {"name": "starlight", "type": "principled", "color": [0, 0, 0], "specular": 0, "emission": [2.2, 2.3, 2.6]},
    ],
    "geometries": [
        rock("rock_a", 3, 0.55),
        rock("rock_b", 8, 0.5),
        rock("rock_c", 15, 0.6),
        {"name": "pebble", "type": "sphere", "radius": 1, "segments": 10},
        {"name": "planet", "type": "sphere", "radius": 1, "segments": 256},
        {"name": "star", "type": "sphere", "radius": 1, "segments": 4},
    ],
    "lights": [
        {"type": "environment", "radiance": [0.006, 0.007, 0.011]},
        {"type": "distant", "name": "sun", "direction": [0.86, -0.28, -0.42], "angular_diameter": 0.6, "irradiance": [2.7, 2.5, 2.3]},
    ],
}
next(i for i in instances if i["name"] == "planet")["scale"] = 95
head = json.dumps(scene, indent=2)
print(head[:-2] + ',\n  "instances": [\n    ' + ",\n    ".join(json.dumps(i) for i in instances) + "\n  ]\n}")
