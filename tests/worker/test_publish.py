"""The published folder: the contract's names, nothing stale, nothing half."""

from __future__ import annotations

import gzip
import json
import threading
from dataclasses import replace
from pathlib import Path

import pytest
from sqlalchemy import select

from core.outputs import TABLES
from core.report.record import RunRecord
from core.settings import make_settings
from core.states import RunState
from core.task_key import stage_of
from core.viewer.deliver import bundle
from store.db import Database, open_sqlite
from store.files import ArtifactStore
from store.inspections import Inspections
from store.models import Base, CaseRow, DefectRow, DetectionRow, EventRow
from store.publishing import Publishing, Ticket
from tests.core.making_record import failed_record, full_record
from tests.store.small_plan import FILES, GRAPH
from worker.publish import Publisher, collected, publish, report_rows
from worker.results import ResultFolders

FILES_OF = {
    "confirm": ["model/cameras.bin"],
    "extend": ["model/cameras.bin", "model/images.bin", "registered.json"],
    "fuse": ["fused.ply"],
    "mesh": ["mesh_poisson.ply", "mesh_full.ply", "mesh.json"],
    "map_defects": ["defect_points.ply", "support.npz"],
    "timeline": ["mesh_defects.ply", "mesh_defects.glb", "timeline.json"],
    "gallery": ["index.html", "0001.jpg", "mesh_1.png"],
}
PUBLISHED = {
    "sparse/cameras.bin",
    "sparse/images.bin",
    "dense/fused.ply",
    "dense/mesh_poisson.ply",
    "dense/mesh_full.ply",
    "mapping/defect_points.ply",
    "mapping/mesh_defects.ply",
    "mapping/mesh_defects.glb",
    "gallery/index.html",
    "gallery/0001.jpg",
    "gallery/mesh_1.png",
}
PAGE = {f"viewer/{name}" for name in (*bundle(), "viewer.json", "data.js")}
"""Of a run that has frames to show."""
WRITTEN = PAGE | set(TABLES)


@pytest.fixture
def hidden(tmp_path: Path) -> Path:
    folder = tmp_path / "out" / ".bladeatlas"
    folder.mkdir(parents=True)
    return folder


def results(hidden: Path, run: str, stages: list[str]) -> dict[str, Path]:
    """Result folders whose files say which run made them."""
    folders = {}
    for stage in stages:
        folders[stage] = hidden / "results" / stage / run
        for name in (*FILES_OF[stage_of(stage)], "result.json"):
            path = folders[stage] / name
            path.parent.mkdir(parents=True, exist_ok=True)
            path.write_text(f"{run} {stage} {name}")
    return folders


def published(hidden: Path) -> set[str]:
    out = hidden.parent
    names = {path.relative_to(out).as_posix() for path in out.rglob("*") if path.is_file()}
    return {name for name in names if not name.startswith(".bladeatlas/")}


def test_a_whole_run_publishes_every_name_of_the_contract(hidden: Path) -> None:
    publish(full_record(), results(hidden, "a", list(FILES_OF)), hidden.parent, hidden)
    assert published(hidden) == PUBLISHED | WRITTEN
    assert (hidden.parent / "sparse/cameras.bin").read_text() == "a extend model/cameras.bin"
    assert json.loads((hidden.parent / "summary.json").read_text())["state"] == "succeeded"
    assert [path.name for path in hidden.iterdir() if path.name != "results"] == ["published.json"]


def test_further_models_lie_beside_the_first_when_they_came_to_their_end(hidden: Path) -> None:
    own = ["extend", "fuse", "mesh", "map_defects", "timeline"]
    folders = results(hidden, "a", [*FILES_OF, *(f"{stage}@1" for stage in own), "extend@2", "mesh@2"])
    publish(full_record(), folders, hidden.parent, hidden)
    further = {name for name in PUBLISHED if name.startswith(("sparse/", "dense/", "mapping/"))}
    assert published(hidden) == PUBLISHED | WRITTEN | {f"models/1/{name}" for name in further}
    assert (hidden.parent / "models/1/dense/fused.ply").read_text() == "a fuse@1 fused.ply"


def test_what_is_no_longer_there_is_taken_away(hidden: Path) -> None:
    publish(full_record(), results(hidden, "a", list(FILES_OF)), hidden.parent, hidden)
    (hidden.parent / "mine.txt").write_text("of the user")
    publish(failed_record(), {}, hidden.parent, hidden)
    assert published(hidden) == {*WRITTEN, "mine.txt"}
    assert not (hidden.parent / "gallery").exists()


def test_the_confirmed_model_is_served_when_it_was_not_extended(hidden: Path) -> None:
    record = replace(full_record(), state=RunState.PARTIAL, failed_stage="extend")
    publish(record, results(hidden, "a", ["confirm"]), hidden.parent, hidden)
    assert (hidden.parent / "sparse/cameras.bin").read_text() == "a confirm model/cameras.bin"


def test_a_refused_run_keeps_its_model_and_places_nothing(hidden: Path) -> None:
    record = replace(full_record(), state=RunState.FAILED, reason="no_reconstruction")
    publish(record, results(hidden, "a", list(FILES_OF)), hidden.parent, hidden)
    found = published(hidden)
    assert "sparse/cameras.bin" in found
    assert not {"mapping/mesh_defects.ply", "mapping/mesh_defects.glb", "mapping/defect_points.ply"} & found


def test_unchanged_files_are_left_alone_and_edited_ones_put_right(hidden: Path) -> None:
    folders = results(hidden, "a", list(FILES_OF))
    publish(full_record(), folders, hidden.parent, hidden)
    mesh, cloud = hidden.parent / "dense/mesh_full.ply", hidden.parent / "dense/fused.ply"
    cloud.write_text("edited")
    before = mesh.stat()
    publish(full_record(), folders, hidden.parent, hidden)
    assert (mesh.stat().st_ino, mesh.stat().st_mtime_ns) == (before.st_ino, before.st_mtime_ns)
    assert cloud.read_text() == "a fuse fused.ply"
    assert (folders["fuse"] / "fused.ply").read_text() == "a fuse fused.ply"
    publish(full_record(), results(hidden, "b", list(FILES_OF)), hidden.parent, hidden)
    assert mesh.read_text() == "b mesh mesh_full.ply"


@pytest.mark.parametrize("record", [full_record(), failed_record()], ids=["full", "failed"])
def test_rows_in_the_database_say_what_the_files_say(hidden: Path, record: RunRecord) -> None:
    database = open_sqlite(hidden / "plan.db")
    inspections = Inspections(database, GRAPH)
    inspections.create("local", FILES, make_settings(), str(hidden.parent))
    report = publish(record, {}, hidden.parent, hidden)
    inspections.put_rows("local", report_rows(report))
    tables = {
        "cases.json": (CaseRow, "name"),
        "mapping/detections.json": (DetectionRow, "id"),
        "mapping/timeline.json": (EventRow, "event_id"),
    }
    for name, (table, key) in tables.items():
        rows = sorted(json.loads((hidden.parent / name).read_text()), key=lambda row: row[key])
        stored = [{column: row[column] for column in (rows[0] if rows else ())} for row in read(database, table, key)]
        assert stored == rows
    defects = [row["record"] for row in read(database, DefectRow, "id")]
    assert defects == json.loads((hidden.parent / "mapping/defects.json").read_text())
    database.close()


def read(database: Database, table: type[Base], key: str) -> list[dict[str, object]]:
    with database.read() as session:
        columns = table.__table__.columns
        return [dict(row) for row in session.execute(select(*columns).order_by(columns[key])).mappings()]


def test_files_of_pages_lie_in_the_store_compressed_too(hidden: Path, tmp_path: Path) -> None:
    store, results = ArtifactStore(tmp_path / "store"), ResultFolders(tmp_path / "results")
    database = open_sqlite(hidden / "plan.db")
    inspections = Inspections(database, GRAPH)
    inspections.create("local", FILES, make_settings(), str(hidden.parent))
    publisher = Publisher(Publishing(database), inspections, results, store, tmp_path / "scratch", "me")
    ticket = Ticket("local", 1, 1)
    with collected(full_record(), {}, tmp_path / "scratch") as wanted:
        stored = publisher._store_files(ticket, wanted, threading.Event())
    keys = set(store.list())
    packed = {key for key in keys if key.endswith(".gz")}
    assert packed == {f"{ticket.prefix}/{name}.gz" for name in PAGE}
    assert keys - packed == {f"{ticket.prefix}/{one.path}" for one in stored}
    for key in packed:
        with store.open(key) as small, store.open(key.removesuffix(".gz")) as plain:
            assert gzip.decompress(small.read()) == plain.read()
    publisher._sweep(ticket, stored)
    assert set(store.list()) == keys
    publisher._sweep(ticket, [one for one in stored if one.path != "viewer/data.js"])
    assert keys - set(store.list()) == {f"{ticket.prefix}/viewer/data.js", f"{ticket.prefix}/viewer/data.js.gz"}
    database.close()
