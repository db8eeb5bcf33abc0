#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Writes the textures tiles_*.jpg and marble_color.jpg, which repeat without seams.

    /usr/bin/python3 scenes/assets/make_textures.py scenes/assets
"""
import sys

import numpy as np
import OpenImageIO as oiio

N = 512
random = np.random.default_rng(5)


def noise(exponent):
    """Periodic noise with a spectrum 1 / f^exponent, in [0, 1]."""
    f = np.hypot(*np.meshgrid(np.fft.fftfreq(N) * N, np.fft.fftfreq(N) * N))
    f[0, 0] = 1e9
    field = np.fft.ifft2(np.fft.fft2(random.standard_normal((N, N))) / f**exponent).real
    return (field - field.min()) / (field.max() - field.min())


def write(name, image, srgb):
    """8-bit JPEG of values in [0, 1]."""
    out = oiio.ImageOutput.create(name)
    spec = oiio.ImageSpec(N, N, image.shape[2], "uint8")
    spec.attribute("Compression", "jpeg:88")
    spec.attribute("oiio:ColorSpace", "sRGB" if srgb else "Linear")
    out.open(name, spec)
    out.write_image((np.clip(image, 0, 1) * 255 + 0.5).astype(np.uint8))
    out.close()


def mix(a, b, t):
    return np.asarray(a) * (1 - t[..., None]) + np.asarray(b) * t[..., None]


folder = sys.argv[1] + "/"
y, x = np.mgrid[0:N, 0:N] / N
# Four by four tiles, each with a tone of its own, and joints.
tones = random.uniform(0, 1, (4, 4))[(4 * y).astype(int), (4 * x).astype(int)]
u, v = (4 * x) % 1, (4 * y) % 1
edge = np.minimum(np.minimum(u, 1 - u), np.minimum(v, 1 - v))
joint = np.clip(1 - (edge - 0.02) / 0.03, 0, 1)
cloud, grain = noise(1.6), noise(0.6)
color = mix(mix([0.62, 0.4, 0.28], [0.78, 0.58, 0.42], 0.6 * tones + 0.4 * cloud), [0.36, 0.34, 0.32], joint)
write(folder + "tiles_color.jpg", color * (0.9 + 0.2 * grain[..., None]), True)
write(folder + "tiles_roughness.jpg", np.clip(0.25 + 0.25 * cloud + 0.6 * joint, 0, 1)[..., None], False)
height = 6 * (1 - joint) + 2.5 * cloud + 0.8 * grain
dx = (np.roll(height, -1, 1) - np.roll(height, 1, 1)) / 2
dy = (np.roll(height, 1, 0) - np.roll(height, -1, 0)) / 2
normal = np.stack([-dx, -dy, np.ones_like(dx) * 1.5], -1)
normal /= np.linalg.norm(normal, axis=-1, keepdims=True)
write(folder + "tiles_normal.jpg", normal * 0.5 + 0.5, False)
# Veins where a warped field passes the middle.
warp, base = noise(1.9), noise(1.5)
vein = np.exp(-((base + 0.6 * warp - 0.8) ** 2) / 0.0009)
write(folder + "marble_color.jpg", mix(mix([0.86, 0.84, 0.8], [0.72, 0.72, 0.73], warp), [0.2, 0.24, 0.28], 0.8 * vein), True)
