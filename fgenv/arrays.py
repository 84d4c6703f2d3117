"""Array types that the package shares. Shapes are in the docstrings of each function."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]
Floats32 = NDArray[np.float32]  # observations and colors
Flags = NDArray[np.bool_]
Ints = NDArray[np.int64]
Ints32 = NDArray[np.int32]
Indices = NDArray[np.intp]

Vertices = NDArray[np.float64]  # (n, 3), meters
Faces = NDArray[np.int64]  # (n, 3), indices of vertices
Poses = NDArray[np.float64]  # (..., 4, 4), homogeneous transforms
