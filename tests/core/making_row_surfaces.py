"""Small surfaces that cameras saw of a hub and of one, two and three blades.

``python -m tests.core.making_row_surfaces`` makes them: the true surfaces of the row bench's scenes as far as their
frames show them, thinned to a few thousand faces.
"""

from __future__ import annotations

import tempfile
from pathlib import Path

import cv2  # noqa: F401  (before pycolmap)
import numpy as np
import open3d as o3d
import pycolmap

from core.scene.views import Views
from core.surface.ply import Mesh, read_mesh, write_mesh

FOLDER = Path(__file__).parents[1] / "data" / "rows"
NAMES = ("hub", "one-blade", "two-blades", "three-blades")
FACES = 5000
VIEWS = 5


def read_surface(name: str) -> tuple[Mesh, Views]:
    """A committed surface, and some of the cameras that saw it."""
    poses = np.load(FOLDER / f"{name}.npy").astype(np.float64)
    camera = pycolmap.Camera(model="PINHOLE", width=240, height=180, params=[140.0, 140.0, 120.0, 90.0], camera_id=1)
    return read_mesh(FOLDER / f"{name}.ply"), Views(np.arange(len(poses)), poses[:, :, :3], poses[:, :, 3], camera)


def _make(name: str, work: Path) -> None:
    from bench.row.cases import SPECIAL, halved
    from bench.row.true_result import make_true_result
    from core.io.sparse import open_model
    from core.scene.views import views_of

    case = next(case for case in SPECIAL if case.name == name)
    make_true_result(halved(case), work / "truth", work / "result")
    mesh, views = read_mesh(work / "result/dense/mesh_poisson.ply"), views_of(open_model(work / "result/sparse"))
    utility = o3d.utility
    corners, triangles = utility.Vector3dVector(mesh.vertices), utility.Vector3iVector(mesh.faces)
    whole = o3d.geometry.TriangleMesh(corners, triangles)
    small = whole.simplify_quadric_decimation(FACES)
    FOLDER.mkdir(exist_ok=True)
    write_mesh(FOLDER / f"{name}.ply", Mesh(np.asarray(small.vertices), np.asarray(small.triangles, np.int32)))
    taken = np.linspace(0, len(views) - 1, VIEWS).round().astype(int)
    poses = np.concatenate([views.R[taken], views.t[taken, :, None]], axis=2)
    np.save(FOLDER / f"{name}.npy", poses.astype(np.float32))


if __name__ == "__main__":
    for one in NAMES:
        with tempfile.TemporaryDirectory() as folder:
            _make(one, Path(folder))
