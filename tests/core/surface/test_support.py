"""Support by distance to the cloud, trimming, components, and the mesh stage on a sphere."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest

from core.errors import StageFailed
from core.settings import make_settings
from core.stage import StageTask
from core.stages import mesh as mesh_stage
from core.surface.ply import Mesh, read_mesh, write_cloud
from core.surface.poisson import supported_surface
from core.surface.support import keep_vertices, largest_component, point_spacing, support


def _grid(n: int = 21, step: float = 0.1) -> Mesh:
    """A flat square of (n - 1)^2 cells at z = 0."""
    y, x = np.mgrid[0:n, 0:n]
    vertices = np.column_stack([x.ravel() * step, y.ravel() * step, np.zeros(n * n)])
    a = (np.arange(n - 1)[:, None] * n + np.arange(n - 1)).ravel()
    faces = np.concatenate([np.stack([a, a + 1, a + n], 1), np.stack([a + 1, a + n + 1, a + n], 1)])
    return Mesh(vertices, faces.astype(np.int32), colors=np.full((n * n, 3), 9, np.uint8))


def test_spacing_of_a_grid_is_its_step() -> None:
    assert point_spacing(_grid().vertices) == pytest.approx(0.1)
    assert point_spacing(np.zeros((1, 3))) == 0.0


def test_support_falls_from_one_to_zero_and_is_half_at_the_limit() -> None:
    values = support(np.array([0.0, 0.1, 0.75, 1.5, 9.0]), 0.1, 7.5)
    np.testing.assert_allclose(values, [1, 1, 0.5, 0, 0], atol=1e-6)
    assert not support(np.zeros(3), 0.0, 7.5).any()


def test_only_what_the_cloud_supports_is_kept() -> None:
    mesh = _grid()
    cloud = Mesh(mesh.vertices[mesh.vertices[:, 0] < 0.65])
    settings = make_settings("default", {"mesh.support_spacings": 2.0}).mesh
    surface = supported_surface(mesh, cloud, settings)
    # Cloud up to x = 0.6, spacing 0.1, limit 2 spacings: vertices up to x = 0.8.
    assert surface.kept.vertices[:, 0].max() == pytest.approx(0.8)
    assert len(surface.kept.faces) == 2 * 8 * 20
    assert (surface.kept.extra["support"] >= 0.5).all()
    assert len(surface.full.vertices) == len(mesh.vertices)
    assert surface.supported_share == pytest.approx(9 / 21)
    assert surface.kept.colors is not None


def test_keep_unsupported_keeps_all_with_the_same_property() -> None:
    mesh = _grid()
    cloud = Mesh(mesh.vertices[:63])
    settings = make_settings("default", {"mesh.keep_unsupported": True}).mesh
    surface = supported_surface(mesh, cloud, settings)
    assert len(surface.kept.faces) == len(mesh.faces)
    assert surface.kept.extra["support"].min() < 0.5


def test_largest_component_drops_the_others() -> None:
    mesh = _grid()
    gap = np.abs(mesh.vertices[:, 0] - 0.6) > 0.05
    parts = keep_vertices(mesh, gap)
    kept = keep_vertices(parts, largest_component(parts))
    assert kept.vertices[:, 0].min() == pytest.approx(0.7)
    surface = supported_surface(parts, parts, make_settings("default", {"mesh.keep_largest_component": True}).mesh)
    assert len(surface.kept.faces) == len(kept.faces)


def test_cloud_far_away_supports_nothing() -> None:
    mesh = _grid()
    far = Mesh(np.add(mesh.vertices, [0, 0, 50.0]))
    with pytest.raises(StageFailed) as caught:
        supported_surface(mesh, far, make_settings().mesh)
    assert caught.value.code == "empty_mesh"


def test_mesh_stage_meets_the_sphere_and_cuts_what_is_invented(tmp_path: Path) -> None:
    rng = np.random.default_rng(0)
    normals = rng.normal(size=(30000, 3))
    normals /= np.linalg.norm(normals, axis=1, keepdims=True)
    normals = normals[normals[:, 2] < 0.3]
    fuse = tmp_path / "fuse"
    out = tmp_path / "mesh"
    fuse.mkdir()
    out.mkdir()
    colors = np.tile(np.array([[10, 200, 30]], np.uint8), (len(normals), 1))
    write_cloud(fuse / "fused.ply", Mesh(2 * normals, colors=colors, normals=normals), ("unit: model units",))
    settings = make_settings("default", {"mesh.poisson_depth": 7, "mesh.poisson_trim": 0})
    task = StageTask("mesh", {}, settings, {"fuse": fuse}, {}, (), out)
    facts = mesh_stage.run(task).facts
    kept, full = read_mesh(out / "mesh_poisson.ply"), read_mesh(out / "mesh_full.ply")
    assert sorted(path.name for path in out.iterdir()) == ["mesh.json", "mesh_full.ply", "mesh_poisson.ply"]
    assert json.loads((out / "mesh.json").read_text()) == facts
    assert facts["n_faces"] == len(kept.faces) < len(full.faces) == facts["n_full_faces"]
    assert kept.comments == ("unit: model units",)
    error = np.abs(np.linalg.norm(kept.vertices, axis=1) - 2)
    assert np.median(error) < 0.005
    assert kept.vertices[:, 2].max() < 1.1 < full.vertices[:, 2].max()
    assert kept.colors is not None
    assert np.abs(kept.colors.astype(int) - [10, 200, 30]).max() <= 2
    assert full.extra["support"].min() < 0.5 <= kept.extra["support"].min()
