"""PLY round trips: properties, comments, foreign files."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from core.errors import StageFailed
from core.surface.ply import Mesh, read_mesh, write_cloud, write_mesh


def _tetrahedron() -> Mesh:
    vertices = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]], float)
    return Mesh(
        vertices,
        np.array([[0, 2, 1], [0, 1, 3], [1, 2, 3], [0, 3, 2]], np.int32),
        colors=np.arange(12, dtype=np.uint8).reshape(4, 3),
        normals=vertices - 0.25,
        extra={"support": np.array([0, 0.25, 0.5, 1], np.float32), "defect_id": np.array([-1, 0, 7, -1], np.int32)},
        comments=("world frame: model 0", "unit: model"),
    )


def test_everything_survives_a_round_trip(tmp_path: Path) -> None:
    mesh = _tetrahedron()
    write_mesh(tmp_path / "m.ply", mesh)
    back = read_mesh(tmp_path / "m.ply")
    np.testing.assert_array_equal(back.vertices, mesh.vertices)
    np.testing.assert_array_equal(back.faces, mesh.faces)
    assert back.colors is not None
    np.testing.assert_array_equal(back.colors, mesh.colors)
    assert back.normals is not None
    np.testing.assert_array_equal(back.normals, mesh.normals)
    np.testing.assert_array_equal(back.extra["support"], mesh.extra["support"])
    np.testing.assert_array_equal(back.extra["defect_id"], mesh.extra["defect_id"])
    assert back.extra["defect_id"].dtype == np.int32
    assert back.comments == mesh.comments
    assert back.diagonal == pytest.approx(np.sqrt(3))


def test_cloud_has_no_faces_and_given_comments(tmp_path: Path) -> None:
    write_cloud(tmp_path / "c.ply", _tetrahedron(), ["unit: mm"])
    back = read_mesh(tmp_path / "c.ply")
    assert back.faces.shape == (0, 3)
    assert back.comments == ("unit: mm",)


def test_mesh_without_vertices_is_valid(tmp_path: Path) -> None:
    write_mesh(tmp_path / "e.ply", Mesh(np.zeros((0, 3))))
    back = read_mesh(tmp_path / "e.ply")
    assert back.vertices.shape == (0, 3)
    assert back.faces.shape == (0, 3)
    assert back.diagonal == 0.0


@pytest.mark.parametrize(
    "text",
    [
        "not a ply",
        "ply\nformat ascii 1.0\nelement vertex 1\nproperty float q\nend_header\n1\n",
        "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\n"
        "element face 1\nproperty list uchar int vertex_indices\nend_header\n"
        "0 0 0\n1 0 0\n1 1 0\n0 1 0\n4 0 1 2 3\n",
    ],
)
def test_files_that_are_no_mesh_are_refused(tmp_path: Path, text: str) -> None:
    (tmp_path / "bad.ply").write_text(text)
    with pytest.raises(StageFailed) as caught:
        read_mesh(tmp_path / "bad.ply")
    assert caught.value.where == "bad.ply"
