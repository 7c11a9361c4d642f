"""What the soak takes for equal, and what it does not."""

from __future__ import annotations

import json
import shutil
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from plyfile import PlyData, PlyElement

from bench.soak.compare import differences
from bench.soak.run import unknown_files
from tests.api.conftest import Backend, backend  # noqa: F401  (a fixture)

CASES = [{"name": "seg_000", "status": "succeeded", "points3D": 100, "seconds": 1.0}]
DETECTIONS: list[dict[str, Any]] = [
    {"id": 0, "outcome": "mapped", "x": 0.0, "y": 0.0, "z": 0.0},
    {"id": 1, "outcome": "unplaced", "x": None, "y": None, "z": None},
]


def write_mesh(path: Path, shift: float = 0.0) -> None:
    corners = np.array([(0, 0, 0), (3 + shift, 0, 0), (0, 4, 0)], dtype=[("x", "f8"), ("y", "f8"), ("z", "f8")])
    PlyData([PlyElement.describe(corners, "vertex")]).write(path)


@pytest.fixture
def pair(tmp_path: Path) -> tuple[Path, Path]:
    """Two equal downloads whose mesh has a diagonal of 5."""
    one = tmp_path / "one"
    for name in ("sparse", "mapping", "dense"):
        (one / name).mkdir(parents=True)
    (one / "sparse/points3D.bin").write_bytes(b"points")
    (one / "cases.json").write_text(json.dumps(CASES))
    for name, rows in (("detections", DETECTIONS), ("timeline", []), ("defects", [])):
        (one / f"mapping/{name}.json").write_text(json.dumps(rows))
    write_mesh(one / "dense/mesh_poisson.ply")
    shutil.copytree(one, tmp_path / "other")
    return one, tmp_path / "other"


def test_equal_downloads_and_other_times_are_equal(pair: tuple[Path, Path]) -> None:
    (pair[1] / "cases.json").write_text(json.dumps([{**CASES[0], "seconds": 9.0}]))
    assert differences(*pair) == []


def test_models_and_cases_must_be_the_same_and_no_file_may_be_missing(pair: tuple[Path, Path]) -> None:
    (pair[1] / "sparse/points3D.bin").write_bytes(b"point5")
    (pair[1] / "cases.json").write_text(json.dumps([{**CASES[0], "points3D": 101}]))
    (pair[1] / "dense/extra.ply").write_bytes(b"")
    assert differences(*pair) == ["dense/extra.ply is new", "sparse/points3D.bin differs", "cases.json differs"]


@pytest.mark.parametrize(("moved", "equal"), [(4e-4, True), (6e-4, False)])
def test_places_and_meshes_may_move_by_a_share_of_the_diagonal(
    pair: tuple[Path, Path], moved: float, equal: bool
) -> None:
    rows = [{**DETECTIONS[0], "x": moved}, DETECTIONS[1]]
    (pair[1] / "mapping/detections.json").write_text(json.dumps(rows))
    write_mesh(pair[1] / "dense/mesh_poisson.ply", moved)
    found = differences(*pair)
    assert len(found) == (0 if equal else 2)
    assert all("apart" in difference for difference in found)


def test_an_outcome_or_a_place_that_appears_is_a_difference(pair: tuple[Path, Path]) -> None:
    path = pair[1] / "mapping/detections.json"
    path.write_text(json.dumps([DETECTIONS[0], {**DETECTIONS[1], "outcome": "mapped"}]))
    assert differences(*pair) == ["mapping/detections.json differs"]
    path.write_text(json.dumps([DETECTIONS[0], {**DETECTIONS[1], "x": 0.0, "y": 0.0, "z": 0.0}]))
    assert "inf apart" in differences(*pair)[0]


def test_a_file_that_nothing_names_is_found_and_the_gzipped_form_of_a_page_is_none(
    backend: Backend,  # noqa: F811
) -> None:
    one = backend.finished("one", {"viewer/data.js": b"data"})
    store = backend.services.settings.folder("artifacts")
    page = store / "published" / one / "viewer"
    (page / "data.js.gz").write_bytes(b"packed")
    assert [name for name in unknown_files(backend.db, store) if "viewer" in name] == []
    (page / "other.js.gz").write_bytes(b"packed")
    (page / "other.js").write_bytes(b"nobody's")
    names = [f"published/{one}/viewer/{name}" for name in ("other.js", "other.js.gz")]
    assert [name for name in unknown_files(backend.db, store) if "viewer" in name] == names
