"""`map_defects` and `timeline` by casting, as stages: files in, files out, the same bytes twice."""

from __future__ import annotations

import hashlib
import json
import re
from dataclasses import replace
from pathlib import Path
from typing import Any

import cv2  # noqa: F401  (before pycolmap)
import numpy as np
import pytest

from core.flags import Flag, Severity
from core.gallery.defects import defect_lines
from core.gallery.page import gallery_page
from core.gallery.palette import label_colors
from core.io.annotations import read_rows
from core.io.timeline import read_defects, read_events
from core.mapping.observations import read_observations
from core.products.contract import Facts
from core.products.search import ExtendProduct
from core.report.build import build_report, write_tables
from core.report.record import RunRecord, RunTables, TaskRecord
from core.settings import make_settings
from core.stage import StageTask
from core.stages import map_defects, timeline
from core.states import RunState, TaskState
from core.surface.ply import Mesh, read_mesh, write_cloud, write_mesh
from core.videos import Recording
from core.viewgraph import make_table, write_database, write_table
from tests.core import making_plates as plates
from tests.core.making_plates import NEAR, detection
from tests.core.making_products import facts_of
from tests.core.making_rows import run_frames

pytestmark = pytest.mark.slow

A, B = (-0.8, 0.2, NEAR), (-1.4, -0.3, NEAR)
FRAMES = range(8)


@pytest.fixture(scope="module")
def inputs(tmp_path_factory: pytest.TempPathFactory) -> Path:
    root = tmp_path_factory.mktemp("inputs")
    for name in ("annotations", "frames", "extend", "graph", "mesh", "fuse", "probe"):
        (root / name).mkdir()
    found = [detection(2 * i + k, place, i) for i in FRAMES for k, place in enumerate((A, B))]
    rows = [{**one.__dict__, "polygon": None} for one in found]
    _write(root / "annotations" / "detections.json", rows)
    _write(root / "annotations" / "looked_at.json", list(FRAMES))
    frames = [
        {"index": i, "source_index": i, "pts": i, "time_s": 0.1 * i, "sha256": "", "role": "both"} for i in FRAMES
    ]
    _write(root / "frames" / "frames.json", frames)
    _write(root / "frames" / "crop.json", plates.CROP.to_dict())
    plates.write_model(root / "extend" / "model", FRAMES)
    table = make_table([], [])
    write_table(root / "graph" / "graph.npz", table)
    write_database(
        root / "graph" / "database.db", plates.camera(), [np.zeros((1, 2), np.float32) for _ in FRAMES], table
    )
    mesh = plates.plates()
    support = np.ones(len(mesh.vertices), np.float32)
    write_mesh(root / "mesh" / "mesh_poisson.ply", Mesh(mesh.vertices, mesh.faces, extra={"support": support}))
    write_cloud(root / "fuse" / "fused.ply", Mesh(mesh.vertices))
    return root


def _write(path: Path, value: object) -> None:
    path.write_text(json.dumps(value), encoding="utf-8")


def run_both(
    inputs: Path,
    out: Path,
    codes: tuple[str, ...] = (),
    told: dict[str, list[tuple[float, str]]] | None = None,
    options: dict[str, object] | None = None,
) -> dict[str, Facts]:
    """With warnings of the checks of the model; what the stages report goes to `told`."""
    folders = {path.name: path for path in inputs.iterdir()}
    checks = [Flag(code, Severity.WARNING) for code in codes]
    facts: dict[str, Facts] = {"extend": facts_of(ExtendProduct, checks=checks)}
    for name, stage in (("map_defects", map_defects), ("timeline", timeline)):
        folders[name] = out / name
        folders[name].mkdir(parents=True)
        settings = make_settings("default", options or {})
        task = StageTask(name, {}, settings, dict(folders), dict(facts), (Recording(inputs / "none"),), folders[name])
        own: list[tuple[float, str]] = [] if told is None else told.setdefault(name, [])

        def note(share: float, message: str, own: list[tuple[float, str]] = own) -> None:
            own.append((share, message))

        facts[name] = stage.run(replace(task, progress=note)).facts
    return facts


def test_files_and_facts(inputs: Path, tmp_path: Path) -> None:
    facts = run_both(inputs, tmp_path)
    assert facts["map_defects"]["outcomes"] == {"mapped": 16}
    assert facts["map_defects"]["support_min"] > 0
    assert (facts["timeline"]["n_defects"], facts["timeline"]["n_events"]) == (2, 2)
    rows = json.loads((tmp_path / "timeline" / "detections.json").read_text())
    for row in rows:
        assert (row["x"], row["y"], row["z"]) == pytest.approx(A if row["defect_id"] == 0 else B, abs=0.02)
        assert 0.5 < row["confidence"] < 1.0
    parts = json.loads((tmp_path / "timeline" / "confidence.json").read_text())
    assert [part["id"] for part in parts] == list(range(16))
    assert parts[0]["parts"]["views_support"] == 7
    mesh = read_mesh(tmp_path / "timeline" / "mesh_defects.ply")
    for number, place in enumerate((A, B)):
        near = np.linalg.norm(mesh.vertices - place, axis=1) < 0.1
        assert (mesh.extra["defect_id"][near] == number).all()
    away = np.linalg.norm(mesh.vertices[:, None] - np.array([A, B]), axis=2).min(axis=1) > 0.5
    assert (mesh.extra["defect_id"][away] == -1).all()
    points = read_mesh(tmp_path / "map_defects" / "defect_points.ply")
    assert len(points.vertices) == facts["map_defects"]["unique_support_points"] > 4


def test_confidence_knows_what_the_checks_say_of_the_model(inputs: Path, tmp_path: Path) -> None:
    for name, codes in (("sure", ()), ("doubted", ("lens_unsettled", "coverage_low"))):
        run_both(inputs, tmp_path / name, codes)
        rows = json.loads((tmp_path / name / "timeline" / "confidence.json").read_text())
        assert {row["parts"]["model_doubts"] for row in rows} == {len(codes)}


def test_observations_come_back_as_they_were(inputs: Path, tmp_path: Path) -> None:
    run_both(inputs, tmp_path)
    read = read_observations(tmp_path / "map_defects")
    assert [one.row.id for one in read] == list(range(16))
    assert all(one.parts is not None and one.sigma and len(one.points) > 20 for one in read)
    assert np.linalg.norm(read[0].points.mean(axis=0) - A) < 0.05


def test_the_same_input_gives_the_same_bytes(inputs: Path, tmp_path: Path) -> None:
    digests = []
    for name in ("one", "two"):
        run_both(inputs, tmp_path / name)
        files = sorted(path for path in (tmp_path / name).rglob("*") if path.is_file())
        digests.append([hashlib.sha256(path.read_bytes()).hexdigest() for path in files])
    assert digests[0] == digests[1]


def test_a_stage_says_what_it_does_and_how_far_it_is(inputs: Path, tmp_path: Path) -> None:
    told: dict[str, list[tuple[float, str]]] = {}
    run_both(inputs, tmp_path, told=told)
    for name, first in (("map_defects", 0.0), ("timeline", 0.25)):
        shares, messages = zip(*told[name], strict=True)
        assert (shares[0], shares[-1]) == (first, 1.0)
        assert len(shares) == 4
        assert list(shares) == sorted(set(shares)), "every step is further than the one before"
        assert len(set(messages) - {""}) == 4, "and has its own words"


def every_text(folder: Path) -> str:
    """Everything that a stage wrote which people or programs read as text; of GLB its JSON."""
    found = []
    for path in sorted(folder.iterdir()):
        if path.suffix == ".json":
            found.append(path.read_text(encoding="utf-8"))
        elif path.suffix == ".glb":
            found.append(json.dumps(glb_document(path)))
        elif path.suffix == ".ply":
            found.append(path.read_bytes().split(b"end_header")[0].decode())
    return "\n".join(found)


def glb_document(path: Path) -> Any:
    data = path.read_bytes()
    return json.loads(data[20 : 20 + int.from_bytes(data[12:16], "little")])


def published(out: Path, facts: dict[str, Facts]) -> str:
    """CSV and JSON of the report of these results, and the page of the gallery."""
    rows, records = read_rows(out / "timeline"), read_defects(out / "timeline")
    tasks = [TaskRecord(name, TaskState.SUCCEEDED, facts=facts[name]) for name in ("extend", "map_defects", "timeline")]
    frames = run_frames(8, 0.1)
    tables = RunTables(frames=frames, mapped_rows=rows, timeline=read_events(out / "timeline"), defects=records)
    record = RunRecord(make_settings("default"), RunState.SUCCEEDED, tasks, tables)
    names = write_tables(build_report(record), out / "report")
    lines = defect_lines(records, read_events(out / "timeline"), frames)
    texts = [(out / "report" / name).read_text(encoding="utf-8") for name in names if name.startswith("mapping/")]
    summary = json.loads((out / "report" / "summary.json").read_text(encoding="utf-8"))
    del summary["parameters"]  # names of options have a unit: scale.length_mm
    page = gallery_page([], 0, rows, lines, label_colors([row.label for row in rows]), [], 1)
    return "\n".join([*texts, json.dumps(summary), page])


MILLIMETRE = re.compile(r"(?<![A-Za-z0-9])mm(?![A-Za-z0-9])|millimet", re.IGNORECASE)


def test_without_a_scale_no_millimetre_is_written_anywhere(inputs: Path, tmp_path: Path) -> None:
    facts = run_both(inputs, tmp_path)
    text = every_text(tmp_path / "timeline") + published(tmp_path, facts)
    assert not MILLIMETRE.search(text)
    assert "model units" in text
    records = read_defects(tmp_path / "timeline")
    assert all(record.size is not None and record.size.length is not None for record in records)
    assert {record.to_dict()["length_unit"] for record in records} == {"model"}
    document = glb_document(tmp_path / "timeline" / "mesh_defects.glb")
    assert document["asset"]["extras"]["unit"] == "model"


def test_with_a_scale_sizes_are_millimetres_and_the_glb_is_in_metres(inputs: Path, tmp_path: Path) -> None:
    ends = [plates.pixel((x, 0.0, NEAR), 2) + np.array([plates.CROP.x0, plates.CROP.y0]) for x in (-1.5, -0.5)]
    points = tuple(float(value) for end in ends for value in end)
    options = {"scale.points": points, "scale.length_mm": 12.0, "scale.time_s": 0.2}
    bare, told = run_both(inputs, tmp_path / "bare"), run_both(inputs, tmp_path / "told", options=options)
    assert bare["timeline"]["scale"]["value"] is None
    scale = told["timeline"]["scale"]
    assert (scale["unit"], scale["source"]) == ("mm", "points")
    assert scale["value"] == pytest.approx(12.0, rel=0.01)
    text = every_text(tmp_path / "told" / "timeline") + published(tmp_path / "told", told)
    assert MILLIMETRE.search(text)
    one, two = (read_defects(tmp_path / name / "timeline") for name in ("bare", "told"))
    for before, after in zip(one, two, strict=True):
        first, second = before.to_dict(), after.to_dict()
        assert second["length"] == pytest.approx(scale["value"] * first["length"])
        assert second["area"] == pytest.approx(scale["value"] ** 2 * first["area"])
        assert second["size_sigma"]["length"]["scale"] > 0
        assert second["centroid"] == first["centroid"]
    documents = [glb_document(tmp_path / name / "timeline" / "mesh_defects.glb") for name in ("bare", "told")]
    small, large = (np.array(document["accessors"][0]["max"]) for document in documents)
    assert large == pytest.approx(small * scale["value"] / 1000.0, rel=1e-5)
    assert documents[1]["asset"]["extras"]["unit"] == "m"
