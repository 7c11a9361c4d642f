"""The defects on the surface: which vertices and faces each one covers."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

I32 = NDArray[np.int32]
I64 = NDArray[np.int64]


def defect_of_vertices(detection: I32, defect_of_detection: Mapping[int, int]) -> I32:
    """(n,) defect of each vertex from its strongest detection; -1 = none."""
    if not len(detection) or not defect_of_detection:
        return np.full(len(detection), -1, np.int32)
    table = np.full(max(max(defect_of_detection), int(detection.max())) + 2, -1, np.int32)
    for detection_id, defect in defect_of_detection.items():
        table[detection_id] = defect
    defects: I32 = table[detection]  # -1 reads the last entry, which stays -1
    return defects


def faces_of_defects(faces: I32, vertex_defect: I32, n_defects: int) -> list[I64]:
    """Per defect the sorted faces with at least two vertices of it."""
    if not n_defects or not len(faces):
        return [np.zeros(0, np.int64) for _ in range(n_defects)]
    a, b, c = (vertex_defect[faces[:, i]] for i in range(3))
    of_face = np.where((a == b) | (a == c), a, np.where(b == c, b, -1))
    order = np.argsort(of_face, kind="stable")
    bounds = np.searchsorted(of_face[order], np.arange(n_defects + 1))
    return [order[bounds[k] : bounds[k + 1]] for k in range(n_defects)]
