"""Which way the faces of a surface are turned."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from core.mapping.facing import oriented
from core.mapping.scene import face_normals
from core.scene.views import Views
from tests.core import making_plates as plates
from tests.core.making_plates import NEAR


def from_both_sides(before: int, behind: int) -> Views:
    """So many cameras before the near plate, and so many behind it that look back at it."""
    turned = np.diag([-1.0, 1.0, -1.0])
    R = np.array([np.eye(3)] * before + [turned] * behind)
    centers = np.array([[0.1 * i, 0.0, 0.0] for i in range(before)] + [[0.1 * i, 0.0, 9.0] for i in range(behind)])
    t = -np.einsum("nij,nj->ni", R, centers)
    return Views(np.arange(before + behind), R, t, plates.camera())


@pytest.mark.parametrize(
    ("before", "behind", "turned"), [(3, 0, False), (0, 3, True), (1, 2, True), (2, 1, False), (2, 2, False)]
)
def test_a_mesh_is_turned_when_most_cameras_see_its_back(before: int, behind: int, turned: bool) -> None:
    mesh = plates.plate((-2.0, 2.0), (-1.0, 1.0), NEAR)
    with_normals = replace(mesh, normals=np.tile([0.0, 0.0, -1.0], (len(mesh.vertices), 1)))
    found = oriented(with_normals, from_both_sides(before, behind))
    assert face_normals(found)[:, 2] == pytest.approx(1.0 if turned else -1.0)
    assert found.normals is not None
    assert found.normals[:, 2] == pytest.approx(1.0 if turned else -1.0)
    assert (found.vertices == mesh.vertices).all()


def test_a_mesh_that_no_camera_meets_stays_as_it_is() -> None:
    mesh = plates.plate((40.0, 41.0), (0.0, 1.0), NEAR)
    assert oriented(mesh, from_both_sides(0, 2)) is mesh
    assert oriented(mesh, plates.views([])) is mesh
