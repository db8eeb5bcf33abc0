# SPDX-License-Identifier: Apache-2.0
"""Scenes by chance for tools/soak.sh: small, valid, and different in all that a scene can have."""
import random

DENSITIES = [
    lambda r: {"type": "sphere", "radius": r.uniform(0.6, 1.2)},
    lambda r: {"type": "ellipsoid", "radii": [r.uniform(0.5, 1.2) for _ in range(3)]},
    lambda r: {"type": "torus", "major_radius": r.uniform(0.7, 1.0), "minor_radius": r.uniform(0.25, 0.45)},
    lambda r: {"type": "rounded_box", "half_size": [r.uniform(0.5, 0.9) for _ in range(3)], "rounding": 0.2},
    lambda r: {"type": "metaballs", "level": 0.4,
               "balls": [{"center": [r.uniform(-0.8, 0.8) for _ in range(3)], "radius": 1.2, "weight": 1} for _ in range(3)]},
]
MATERIALS = [
    lambda r: {"type": "diffuse", "color": [r.random() for _ in range(3)]},
    lambda r: {"type": "conductor", "roughness": r.random()},
    lambda r: {"type": "dielectric", "ior": r.uniform(1.1, 1.8), "roughness": r.choice([0, 0.3])},
    lambda r: {"type": "principled", "color": [r.random() for _ in range(3)], "roughness": r.random(), "metallic": r.random(),
               "clearcoat": r.random(), "transmission": r.choice([0, 0.5])},
]
SKIES = [  # of which a scene has at most one
    lambda r: {"type": "environment", "radiance": [r.uniform(0.1, 1) for _ in range(3)]},
    lambda r: {"type": "sky", "sun_elevation": r.uniform(5, 80)},
]
LIGHTS = [
    lambda r: {"type": "rectangle", "position": [-4, 5, 4], "look_at": [0, 0, 0], "size": [2, 2], "radiance": r.uniform(1, 10)},
    lambda r: {"type": "sphere", "position": [3, 4, 3], "radius": 0.5, "radiance": r.uniform(1, 20)},
    lambda r: {"type": "point", "position": [2, 3, 4], "intensity": r.uniform(1, 30)},
]


def scene(seed):
    r = random.Random(seed)
    extent = [[-3] * 3, [3] * 3]
    rock = {
        "name": "rock", "type": "hypertexture",
        "bounds": {"min": extent[0], "max": extent[1]},
        "keep": r.choice(["main", "all", "largest:3", "detached"]),
        "solver": r.choice(["model", "segment", "sphere"]),
        "field": {"density": r.choice(DENSITIES)(r), "modulations": [{
            "type": r.choice(["fbm", "fbm", "ridged", "turbulence"]),
            "noise": r.choice(["perlin", "sparse_convolution"]),
            "amplitude": r.uniform(0.05, 0.5), "frequency": r.uniform(0.8, 2.0), "layers": 1, "seed": r.randrange(1000)}]},
    }
    materials = [{**r.choice(MATERIALS)(r), "name": f"m{i}"} for i in range(3)]
    return {
        "morsel": 1,
        "camera": {"position": [r.uniform(-2, 2), r.uniform(0.5, 2), 6], "look_at": [0, 0, 0], "vertical_fov": r.uniform(30, 50)},
        "render": {"resolution": [r.randrange(16, 97), r.randrange(16, 97)], "spp": r.randrange(1, 17), "max_depth": r.randrange(1, 9),
                   "seed": r.randrange(1000), **r.choice([{}, {}, {"noise_target": 0.05}])},
        "materials": materials,
        "geometries": [rock, {"name": "floor", "type": "rectangle", "size": [8, 8]}, {"name": "ball", "type": "sphere", "radius": 0.4}],
        "instances": [
            {"geometry": "rock", "material": "m0", **r.choice([{}, {"detached_material": "m2"}, {"scale": 0.7, "rotate": [10, 20, 30]}])},
            {"geometry": "floor", "material": "m1", "translate": [0, -1.8, 0]},
            {"geometry": "ball", "material": "m2", "translate": [1.8, -1, 1]}],
        "lights": [r.choice(SKIES)(r)] + [light(r) for light in r.sample(LIGHTS, r.randrange(0, 3))],
    }
