#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Draws the operators of implicit skinning and their curves, as the library itself evaluates them.

    plot_implicit.py LIBSPHMESH.so OUT.png
"""
import ctypes
import math
import struct
import sys
import zlib

SIZE, GAP, BANDS = 220, 16, 20
COLOURS = {1: (40, 90, 170), 2: (190, 60, 40)}


class Curve(ctypes.Structure):
    _fields_ = [("angles", ctypes.c_double * 3), ("thetas", ctypes.c_double * 3), ("exponents", ctypes.c_double * 2)]


def main(library, out):
    sph = ctypes.CDLL(library)
    sph.sph_theta_curve_at.restype = ctypes.c_double
    sph.sph_theta_curve_at.argtypes = [ctypes.POINTER(Curve), ctypes.c_double]
    sph.sph_operation_compose.argtypes = [ctypes.c_int32, ctypes.c_double, ctypes.c_double, ctypes.c_double * 2,
                                          ctypes.POINTER(ctypes.c_double), ctypes.c_void_p]

    def compose(operation, theta, f, g):
        result = ctypes.c_double()
        status = sph.sph_operation_compose(operation, 0.5, theta, (ctypes.c_double * 2)(f, g), ctypes.byref(result), None)
        assert status == 0, status
        return result.value

    width, height = 4 * SIZE + 5 * GAP, 2 * SIZE + 3 * GAP
    pixels = [[(255, 255, 255)] * width for _ in range(height)]

    def panel(column, row, colour_at):
        left, top = GAP + column * (SIZE + GAP), GAP + row * (SIZE + GAP)
        for y in range(SIZE):
            for x in range(SIZE):
                pixels[top + y][left + x] = colour_at(x / (SIZE - 1), 1 - y / (SIZE - 1))

    def field(operation, theta):
        def colour(f, g):
            c = compose(operation, theta, f, g)
            step = 1 / (SIZE - 1)  # where a multiple of 1 / BANDS lies between this pixel and the next there is a line
            right = compose(operation, theta, min(f + step, 1), g)
            above = compose(operation, theta, f, min(g + step, 1))
            if min(c, right, above) < 0.5 <= max(c, right, above):
                return (0, 0, 0)
            if len({int(v * BANDS) for v in (c, right, above)}) > 1:
                return (120, 120, 120)
            return (255 - int(90 * c), 255 - int(70 * c), 255 - int(20 * c))
        return colour

    for row, operation in enumerate((1, 2)):  # blend, bulge
        for column, theta in enumerate((0, math.pi / 8, math.pi / 4)):
            panel(column, row, field(operation, theta))
        curve = Curve()
        sph.sph_theta_curve_preset(ctypes.byref(curve), ctypes.c_int32(operation))
        values = [sph.sph_theta_curve_at(ctypes.byref(curve), math.pi * x / (SIZE - 1)) / (math.pi / 4) for x in range(SIZE)]

        def plot(u, v):
            x = round(u * (SIZE - 1))
            near = [values[x], values[min(x + 1, SIZE - 1)]]
            if min(near) - 0.012 <= v * 1.1 - 0.05 <= max(near) + 0.012:
                return COLOURS[operation]
            return (225, 225, 225) if x % (SIZE // 4) == 0 else (246, 246, 246)
        panel(3, row, plot)
    rows = b"".join(b"\0" + bytes(c for p in row for c in p) for row in pixels)

    def chunk(kind, data):
        return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))
    with open(out, "wb") as f:
        f.write(b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", struct.pack(">2I5B", width, height, 8, 2, 0, 0, 0)) +
                chunk(b"IDAT", zlib.compress(rows, 9)) + chunk(b"IEND", b""))


if __name__ == "__main__":
    if len(sys.argv) != 3:
        sys.exit(__doc__)
    main(*sys.argv[1:])
