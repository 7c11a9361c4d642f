"""Sizes against the truth: errors, whether two standard deviations hold the true value, true sizes of scenes."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

from bench.accuracy.score import score_result
from bench.accuracy.table import format_score
from bench.scenes.blades import build_row, pitch_rad
from bench.scenes.render import defects_at
from bench.scenes.spec import Scene
from bench.scenes.suite import MIDDLE
from bench.scenes.true_size import true_size
from tests.bench import synthetic


@pytest.fixture
def truth_folder(tmp_path: Path) -> Path:
    folder = tmp_path / "truth"
    folder.mkdir()
    return synthetic.write_truth(folder)


def record(number: int, place: list[float], **size: object) -> dict[str, Any]:
    centroid = synthetic.to_model(np.array(place)).tolist()
    return {"id": number, "model": 0, "centroid": centroid, "size_from": "box", **size}


def test_sizes_are_scored_in_mm_whatever_their_unit(truth_folder: Path, tmp_path: Path) -> None:
    """True diameters are 8 mm; one unit of the model is 20 mm."""
    text = (truth_folder / "defects.json").read_text().replace('"radius_m"', '"kind": "dent", "radius_m"')
    (truth_folder / "defects.json").write_text(text)
    places = [row["surface_center"] for row in synthetic.defects()[:2]]
    folder = tmp_path / "result"
    folder.mkdir()
    rows = [
        record(0, places[0], length=0.44, length_sigma=0.03, length_unit="model"),
        record(1, places[1], length=10.4, length_sigma=0.5, length_unit="mm"),
    ]
    score = score_result(synthetic.write_result(folder, defects=rows), truth_folder)
    length = score["sizes"]["box"]["length"]
    assert length["count"] == 2
    assert length["median"] == pytest.approx((0.1 + 0.3) / 2, abs=1e-3)
    assert length["within_2_sigma"] == 0.5
    assert "width" not in score["sizes"]["box"]
    assert score["sizes"]["mask"] == {}
    assert "length by box" in format_score(score)


def test_the_true_size_of_a_scene_is_that_of_what_was_seen() -> None:
    scene = Scene("sizes", 11, MIDDLE)
    row = build_row(scene)
    dent = next(one for one in row.defects if one.kind == "dent")
    vertices, faces = row.vertices, row.faces[np.linalg.norm(row.vertices[row.faces[:, 0]] - dent.center, axis=1) < 4]
    rng = np.random.default_rng(0)
    weights = rng.dirichlet((1.0, 1.0, 1.0), 40 * len(faces))
    points = np.einsum("nk,nki->ni", weights, vertices[np.tile(faces, (40, 1))])
    own = defects_at(points, np.ones(len(points), bool), (dent,), pitch_rad(scene)) == dent.number
    size = true_size(scene, dent, points[own], row)
    assert 1.7 * dent.radius_mm < 1000 * size["length_m"] <= 2.01 * dent.radius_mm
    assert 0.1 * dent.radius_mm < 1000 * size["depth_m"] <= 0.35 * dent.radius_mm
    assert size["area_m2"] > 0.5 * np.pi * (dent.radius_mm / 1000) ** 2
    assert true_size(scene, dent, points[:0], row)["length_m"] is None
