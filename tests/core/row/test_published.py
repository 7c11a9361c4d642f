"""`bladeatlas row` on a published folder: row.json, the column `blade`, and nothing else changed."""

from __future__ import annotations

import json
from dataclasses import asdict, replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import trimesh

from bench.scenes.blades import surface_point
from cli.main import main
from cli.row import told_row
from core.errors import BadInput
from core.io.timeline import read_defects
from core.report.csv_form import read_csv
from core.report.limits import limits_document
from core.report.tables import write_csv
from core.row import estimate
from core.row.estimate import describe_row
from core.row.model import NoRow, UnknownRow
from core.row.overlap import Hypothesis
from core.row.published import _flag, write_row
from core.row.regular import Irregularity
from core.row.rescaled import changed_scale
from core.row.turn import Axis
from core.scene.detection import DETECTION_COLUMNS
from core.scene.on_row import ROW_COLUMNS
from core.scene.size import LengthUnit, Measure, Scale, Size
from core.settings.limits import parse_limits
from core.surface.ply import write_mesh
from tests.core.making_blades import PITCH_RAD, SCENE, blades, sparse_of, walk
from tests.core.making_rows import defect, mapped, unplaced

pytestmark = pytest.mark.slow

TRUE_BLADES = (0, 1, 2, 2)
SPANS = (0.3, 0.5, 0.7, 0.5)


def published(folder: Path) -> Path:
    """A result with a surface of three blades and a finding on each, the last two on one."""
    for name in ("dense", "mapping", "sparse"):
        (folder / name).mkdir(parents=True)
    write_mesh(folder / "dense" / "mesh_poisson.ply", blades(3))
    sparse_of(walk(5)).write_binary(folder / "sparse")
    places = [surface_point(SCENE, b, s, 0.3, 1) for b, s in zip(TRUE_BLADES, SPANS, strict=True)]
    rows = [mapped(k, (float(p[0]), float(p[1]), float(p[2]))).to_dict() for k, p in enumerate(places)]
    rows.append(unplaced(4).to_dict())
    records = [replace(defect(k), centroid=(float(p[0]), float(p[1]), float(p[2]))) for k, p in enumerate(places)]
    (folder / "mapping" / "detections.json").write_text(json.dumps(rows))
    write_csv(folder / "mapping" / "detections.csv", DETECTION_COLUMNS, rows)
    (folder / "mapping" / "defects.json").write_text(json.dumps([record.to_dict() for record in records]))
    (folder / "summary.json").write_text("{}")
    return folder


def test_row_of_a_published_result(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(estimate, "FIT_POINTS", 3000)  # quicker; `test_estimate` asks how well all of them fit
    folder = published(tmp_path / "result")
    before = json.loads((folder / "mapping" / "detections.json").read_text())
    assert main(["row", str(folder), "--set", "count=64"]) == 0
    row = json.loads((folder / "row.json").read_text())
    assert (row["status"], row["count"], row["pitch_deg"]) == ("user", [64, 64], 5.625)
    spans = [one["span"] for one in row["findings"]]
    assert spans == pytest.approx(SPANS, abs=0.05)
    after = json.loads((folder / "mapping" / "detections.json").read_text())
    told = [one.pop("blade") for one in after]
    assert told[4] is None
    numbers = [int(one) for one in told[:4]]
    assert numbers in ([1, 2, 3, 3], [3, 2, 1, 1])
    assert [record.blade for record in read_defects(folder / "mapping")] == told[:4]
    assert [one["blade"] for one in read_csv(folder / "mapping" / "detections.csv")] == [*told[:4], ""]
    assert [_without_row(one) for one in after] == [_without_row(one) for one in before]
    assert [one["side"] for one in after] == ["convex"] * 4 + [None]
    assert [one["length_unit"] for one in after] == ["model"] * 4 + [None]
    assert not list(folder.rglob("*.new"))
    assert "3 blades seen; findings on blade 1:" in capsys.readouterr().out


def _without_row(row: dict[str, Any]) -> dict[str, Any]:
    return {name: value for name, value in row.items() if name not in ("blade", "length_unit", *ROW_COLUMNS)}


def test_a_result_without_a_surface_has_no_row(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (tmp_path / "summary.json").write_text("{}")
    found = write_row(tmp_path)
    assert found == NoRow(UnknownRow.NO_SURFACE)
    assert json.loads((tmp_path / "row.json").read_text())["reason"] == "no_surface"
    assert main(["row", str(tmp_path)]) == 0
    assert "unknown: there is no supported surface" in capsys.readouterr().out


def test_a_folder_that_is_no_result_is_refused(tmp_path: Path) -> None:
    with pytest.raises(BadInput, match="is no result"):
        write_row(tmp_path)


@pytest.mark.parametrize("pair", ["count=three", "count=6", "count=181", "blades=64", "count"])
def test_what_a_row_cannot_be_told(pair: str) -> None:
    with pytest.raises(BadInput):
        told_row([pair])


def test_an_irregular_row_is_flagged_in_quality_and_the_flag_goes_with_it(tmp_path: Path) -> None:
    folder = published(tmp_path / "result")
    mild = {"code": "gap_spanned", "severity": "info", "value": None, "threshold": None, "where": ""}
    quality = {"verdict": "ok", "state": "succeeded", "flags": [{**mild, "meaning": "text"}]}
    (folder / "quality.json").write_text(json.dumps(quality))
    pair = Irregularity(0.3, (2, 3), 4)
    _flag(folder, {1: NoRow(UnknownRow.PITCH_NOT_CONSTANT, 0.4, pair).flags})
    after = json.loads((folder / "quality.json").read_text())
    assert [flag["code"] for flag in after["flags"]] == ["row_irregular", "gap_spanned"]
    assert after["flags"][0]["where"].startswith("model 1, blades 2 and 3 of the 4 seen")
    assert (after["verdict"], json.loads((folder / "summary.json").read_text())["verdict"]) == ("suspect", "suspect")
    _flag(folder, {1: []})
    again = json.loads((folder / "quality.json").read_text())
    assert [flag["code"] for flag in again["flags"]] == ["gap_spanned"]
    assert again["verdict"] == "ok"


def measured(folder: Path) -> None:
    """Give the first finding and its detection sizes in units of the model."""
    size = Size(length=Measure(4.0, 0.3, 0.0, 0.4), area=Measure(8.0, 1.0, 0.0, 0.0))
    for name in ("defects", "detections"):
        path = folder / "mapping" / f"{name}.json"
        rows = json.loads(path.read_text())
        columns = size.to_dict() if name == "defects" else asdict(size.columns())
        rows[0] |= {key: value for key, value in columns.items() if name == "defects" or key in rows[0]}
        path.write_text(json.dumps(rows))


def test_a_radius_gives_every_length_its_millimetres_and_another_one_others(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    true = Hypothesis(Axis(np.array([0.0, 0.0, 1.0]), np.zeros(3)), PITCH_RAD)
    known = describe_row(blades(3), walk(5), 0, true)
    # The search takes many seconds; what follows from a row is asked here.
    monkeypatch.setattr("core.row.published.estimate_row", lambda *_: known)
    folder = published(tmp_path / "result")
    measured(folder)
    write_mesh(folder / "mapping" / "mesh_defects.ply", replace(blades(3), comments=("unit: model",)))
    (folder / "limits.json").write_text(json.dumps(limits_document(parse_limits("length_mm\n8.5\n"), [])))
    assert main(["row", str(folder)]) == 0
    before = json.loads((folder / "row.json").read_text())
    distances = [one["root_distance"] for one in before["findings"]]
    assert before["scale"]["unit"] == "model"
    assert json.loads((folder / "limits.json").read_text())["findings"][0]["verdict"] == "cannot_tell"
    for factor in (2.0, 3.0):
        radius = factor * before["root_radius"]
        assert main(["row", str(folder), "--set", f"radius_mm={radius}"]) == 0
        row = json.loads((folder / "row.json").read_text())
        scale = row["scale"]
        assert (scale["unit"], scale["source"]) == ("mm", "row")
        assert scale["value"] == pytest.approx(factor, rel=1e-5)
        assert json.loads((folder / "summary.json").read_text())["scale"] == scale
        assert [one["root_distance"] for one in row["findings"]] == pytest.approx(
            [factor * d for d in distances], abs=1e-4
        )
        record = read_defects(folder / "mapping")[0]
        assert record.size is not None
        assert record.size.unit == LengthUnit.MM
        length = record.size.measures["length"]
        share = scale["sigma"] / scale["value"]
        assert (length.value, length.outline) == pytest.approx((factor * 4.0, factor * 0.3))
        assert length.sigma == pytest.approx(factor * np.hypot(0.5, 4.0 * share))
        assert record.size.measures["area"].value == pytest.approx(factor**2 * 8.0)
        detection = json.loads((folder / "mapping" / "detections.json").read_text())[0]
        assert (detection["length"], detection["length_unit"]) == (pytest.approx(factor * 4.0), "mm")
        assert detection["length_sigma"] == pytest.approx(length.sigma)
        assert detection["area_sigma"] == pytest.approx(record.size.measures["area"].sigma)
        told = json.loads((folder / "limits.json").read_text())["findings"][0]
        assert told["verdict"] == ("cannot_tell" if factor < 3 else "beyond")
    scene = trimesh.load(folder / "mapping" / "mesh_defects.glb", process=False)
    assert {"blade_1", "blade_2", "blade_3"} <= set(scene.geometry)
    assert np.abs(scene.bounds).max() == pytest.approx(np.abs(blades(3).vertices).max() * 0.003, rel=1e-4)


def test_a_scale_that_was_joined_with_a_radius_cannot_be_taken_apart() -> None:
    points, of_row = Scale(2.0, 0.1, "points"), Scale(2.1, 0.1, "row")
    joined = changed_scale(points, of_row)
    assert joined.new is not None
    assert joined.new.value == pytest.approx(2.05)
    assert joined.new.source == "points+row"
    assert changed_scale(points, None).new == points
    assert changed_scale(of_row, points).new == points
    assert [flag.code for flag in changed_scale(points, Scale(3.0, 0.1, "row")).flags] == ["scale_disagrees"]
    with pytest.raises(BadInput, match="points\\+row together"):
        changed_scale(joined.new, of_row)
