#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Samples of every kind of field, as other programs read them.

Samples each field to .npy and .vti with the command, reads the one with NumPy and the other with
VTK, and compares shape, place, axis order and values with each other and with `morsel field eval`.
Usage: read_samples.py MORSEL. Run by an interpreter without NumPy or VTK's Python modules, it hands
over to the first of `python3` in PATH and /usr/bin/python3 that has them. Exit code 77 (skipped) if
none has.
"""

import json
import os
import shutil
import subprocess
import sys
import tempfile

try:
    import numpy
    from vtkmodules.util.numpy_support import vtk_to_numpy
    from vtkmodules.vtkIOXML import vtkXMLImageDataReader
except ImportError as missing:
    TRIED = "MORSEL_TRIED_PYTHON"  # interpreters that handed over, so that none does so twice
    tried = [p for p in os.environ.get(TRIED, "").split(os.pathsep) if p]
    if sys.executable not in tried:
        tried.append(sys.executable)
    for other in (shutil.which("python3"), "/usr/bin/python3"):
        if other and other not in tried and os.access(other, os.X_OK):
            os.environ[TRIED] = os.pathsep.join(tried + [other])
            os.execv(other, [other] + sys.argv)
    print(f"skipped: none of {', '.join(tried)} has NumPy and VTK's Python modules (Debian: "
          f"python3-numpy, python3-vtk9); the last one says: {missing}")
    sys.exit(77)

RESOLUTION = 11

PARTS = [{"type": "sphere", "radius": 0.8}, {"type": "torus"}]
DENSITIES = [
    {"type": "sphere"},
    {"type": "ellipsoid", "radii": [1, 0.5, 0.7]},
    {"type": "rounded_box", "half_size": 0.8},
    {"type": "torus", "axis": [1, 2, 3]},
    {"type": "capsule"},
    {"type": "slab", "axis": [0, 1, 1]},
    {"type": "metaballs", "balls": [{"center": [0.2, 0, 0]}, {"center": [-0.5, 0, 0.3]}]},
    {"type": "union", "densities": PARTS},
    {"type": "intersection", "densities": PARTS},
    {"type": "difference", "densities": PARTS},
]
NOISES = ["sparse_convolution", "perlin"]
MODULATIONS = [
    {"type": kind, "noise": noise, "amplitude": 0.2, "layers": 2}
    for kind in ("fbm", "turbulence", "ridged", "warp")
    for noise in NOISES
] + [
    {"type": "bias", "bias": 0.7},
    {"type": "gain", "gain": 0.7},
    {"type": "scale_offset", "scale": 2},
    {"type": "fbm", "mask": {"type": "height", "axis": "x"}},
    {"type": "fbm", "mask": {"type": "density", "density": {"type": "slab"}}},
]
FIELDS = [{"density": d} for d in DENSITIES] + [
    {"density": {"type": "sphere"}, "modulations": [m]} for m in MODULATIONS
]
# No symmetry, so that exchanged axes are noticed.
LOW, HIGH = [-1.0, -0.5, -2.0], [1.5, 1.25, 0.5]


def run(*arguments, text=None):
    result = subprocess.run(arguments, input=text, capture_output=True, text=True, check=False)
    if result.returncode != 0:
        sys.exit(f"{arguments}: exit code {result.returncode}\n{result.stderr}")
    return result.stdout


def check(morsel, folder, field):
    scene = os.path.join(folder, "scene.json")
    geometry = {
        "name": "thing",
        "type": "hypertexture",
        "field": field,
        "bounds": {"min": LOW, "max": HIGH},
    }
    with open(scene, "w", encoding="utf-8") as file:
        json.dump({"morsel": 1, "geometries": [geometry]}, file)
    npy, vti = os.path.join(folder, "a.npy"), os.path.join(folder, "a.vti")
    for output in (npy, vti):
        info = json.loads(
            run(morsel, "field", "sample", scene, "--resolution", str(RESOLUTION), "-o", output,
                "--json"))
    low, high = numpy.array(info["box"]["min"]), numpy.array(info["box"]["max"])
    assert (low <= LOW).all() and (high >= HIGH).all(), (low, high)

    samples = numpy.load(npy)
    n = RESOLUTION
    assert samples.shape == (n, n, n) and samples.dtype == numpy.float64, samples.shape
    assert numpy.isfinite(samples).all()

    reader = vtkXMLImageDataReader()
    reader.SetFileName(vti)
    reader.Update()
    image = reader.GetOutput()
    assert image.GetDimensions() == (n, n, n), image.GetDimensions()
    assert numpy.allclose(image.GetOrigin(), low), image.GetOrigin()
    assert numpy.allclose(image.GetSpacing(), (high - low) / (n - 1)), image.GetSpacing()
    scalars = image.GetPointData().GetScalars()
    assert scalars is not None and scalars.GetNumberOfTuples() == n**3
    # VTK's points go x fastest, as the .npy, indexed [z][y][x], does.
    assert (vtk_to_numpy(scalars).reshape(n, n, n) == samples).all()

    places = [(0, 0, 0), (3, 7, 2), (n - 1, 1, 5), (4, n - 1, 9), (n - 1, n - 1, n - 1)]
    points = [image.GetPoint(image.ComputePointId(p)) for p in places]
    text = "".join("{:.17g} {:.17g} {:.17g}\n".format(*p) for p in points)
    lines = run(morsel, "field", "eval", scene, "--points", "-", text=text).split("\n")
    for (i, j, k), line in zip(places, lines):
        value = float(line.split()[0])
        assert abs(value - samples[k][j][i]) <= 1e-12 * (1 + abs(value)), (field, (i, j, k))


def main():
    with tempfile.TemporaryDirectory() as folder:
        for field in FIELDS:
            check(sys.argv[1], folder, field)
    print(f"{len(FIELDS)} fields")


main()
