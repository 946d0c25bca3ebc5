"""Types of the arrays that all rooms pass on: real and complex numbers, truth values."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
Complex = NDArray[np.complex128]
Truths = NDArray[np.bool_]
