"""Tensors, as far as they carry arrays in and out."""

from typing import Any

import numpy as np
from numpy.typing import NDArray

class Tensor:
    """An array of Open3D on the CPU."""

    def __init__(self, np_array: NDArray[np.generic]) -> None: ...
    @staticmethod
    def from_numpy(array: NDArray[np.generic]) -> Tensor: ...
    # The type of the values is known at run time alone: it follows from the name under which a query gives them.
    def numpy(self) -> NDArray[Any]: ...
