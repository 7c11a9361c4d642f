"""The defects on the surface: which vertices and faces each one covers, and its sample points."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

F64 = NDArray[np.float64]
I32 = NDArray[np.int32]
I64 = NDArray[np.int64]

MAX_SAMPLES = 64
"""Sample points of a defect that are tested for visibility."""


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


def sample_points(support: F64) -> F64:
    """At most `MAX_SAMPLES` of the support points, evenly picked in their order."""
    if len(support) <= MAX_SAMPLES:
        return support
    sampled: F64 = support[np.linspace(0, len(support) - 1, MAX_SAMPLES).round().astype(int)]
    return sampled


def mean_normal(normals: F64, vertex_defect: I32, weight: NDArray[np.float32], defect: int) -> F64:
    """(3,) unit normal of a defect's vertices weighted by influence; zero when it covers none."""
    own = np.flatnonzero(vertex_defect == defect)
    total: F64 = (normals[own] * weight[own, None]).sum(axis=0)
    length = float(np.linalg.norm(total))
    unit: F64 = total / length if length > 0 else np.zeros(3)
    return unit
