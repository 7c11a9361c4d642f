"""Ray casting on triangle meshes."""

import numpy as np
from numpy.typing import NDArray
from open3d.core import Tensor

class RaycastingScene:
    """Triangle meshes that rays are cast upon; arrays are float32 for places and rays, uint32 for vertex numbers."""

    INVALID_ID: int
    """The face of a ray that hits nothing."""

    def __init__(self, nthreads: int = 0) -> None: ...
    def add_triangles(
        self,
        vertex_positions: Tensor | NDArray[np.float32],
        triangle_indices: Tensor | NDArray[np.uint32],
    ) -> int: ...
    def cast_rays(self, rays: Tensor, nthreads: int = 0) -> dict[str, Tensor]: ...
    def compute_closest_points(self, query_points: Tensor, nthreads: int = 0) -> dict[str, Tensor]: ...
    def compute_distance(self, query_points: Tensor, nthreads: int = 0) -> Tensor: ...
