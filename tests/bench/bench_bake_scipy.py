# SPDX-License-Identifier: MIT
"""distance_transform_edt of a raw volume: bench_bake_scipy.py IN X Y Z OUT

Prints the seconds that the transform took, and writes float32 squares."""
import sys
import time

import numpy
from scipy import ndimage

path, x, y, z, out = sys.argv[1], *map(int, sys.argv[2:5]), sys.argv[5]
empty = numpy.fromfile(path, dtype=numpy.uint8).reshape(z, y, x) == 0
start = time.perf_counter()
distance = ndimage.distance_transform_edt(empty)
seconds = time.perf_counter() - start
numpy.rint(distance * distance).astype(numpy.float32).tofile(out)
print(seconds)
