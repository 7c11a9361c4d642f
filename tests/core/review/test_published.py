"""The review of a result folder: applied once, in order, from hostile files too, and the files of the result stay."""

from __future__ import annotations

import hashlib
import json
import shutil
import threading
from pathlib import Path
from typing import Any

import pytest
from filelock import FileLock

from core.errors import BadInput
from core.outputs import DEFECTS
from core.report.csv_form import csv_line
from core.review.published import LOCK, REVIEW, apply_records, read_review, review_document, reviewed_result
from core.review.record import ReviewRecord
from core.review.tables import REVIEW_COLUMNS, review_cells
from core.review.target import Target
from tests.core.making_results import RESULTS


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    return Path(shutil.copytree(RESULTS / "two_models", tmp_path / "result"))


def target(folder: Path, number: int = 0) -> dict[str, Any]:
    return Target.of_defect(json.loads((folder / DEFECTS).read_text("utf-8"))[number]).to_dict()


def record(folder: Path, name: str, action: str = "accept", **more: Any) -> dict[str, Any]:
    row = {"id": name, "revision": 1, "target": target(folder), "action": action, "value": None, "reason": ""}
    return {**row, "time": "2026-01-01T10:00:00Z", "by": "", **more}


def parsed(*rows: dict[str, Any]) -> list[ReviewRecord]:
    return [ReviewRecord.parse({**row, "revision": number}, "record") for number, row in enumerate(rows, 1)]


def hashes(folder: Path) -> dict[str, str]:
    files = (path for path in folder.rglob("*") if path.is_file() and path.name not in (REVIEW, LOCK))
    return {str(path): hashlib.sha256(path.read_bytes()).hexdigest() for path in files}


def test_a_result_without_a_review_is_open(folder: Path) -> None:
    found = reviewed_result(folder)
    defects = json.loads((folder / DEFECTS).read_text("utf-8"))
    assert defects
    assert [one.name for one in found.reviewed.findings] == [f"D{one['id']}" for one in defects]
    assert {one.review.state for one in found.reviewed.findings} == {"open"}
    assert found.records == ()


def test_records_are_added_once_and_the_result_stays_as_it_is(folder: Path) -> None:
    before = hashes(folder)
    first = parsed(record(folder, "a"), record(folder, "b", "note", value="=1+1"))
    assert apply_records(folder, first).added == 2
    more = parsed(record(folder, "c", "relabel", value="nick"), record(folder, "b", "note", value="=1+1"))
    assert (apply_records(folder, more).added, apply_records(folder, more).known) == (1, 2)
    kept = reviewed_result(folder)
    assert [(one.id, one.revision) for one in kept.records] == [("a", 1), ("b", 2), ("c", 3)]
    review = kept.reviewed.findings[0].review
    assert (review.state, review.label, len(review.notes)) == ("accepted", "nick", 1)
    assert hashes(folder) == before
    cells = review_cells(kept.reviewed.findings[0])
    assert tuple(cells) == REVIEW_COLUMNS
    assert csv_line([cells["notes"]]) == "'=1+1\r\n", "no spreadsheet runs a note"


def test_what_the_page_saved_before_records_had_ids_is_read(folder: Path, tmp_path: Path) -> None:
    own = {name: value for name, value in target(folder).items() if name != "sigma"}
    old = {"revision": 1, "target": own, "action": "accept", "value": None, "reason": None, "time": "2026-01-01"}
    undo = {**old, "revision": 2, "action": "undo", "value": 1}
    reject = {**old, "revision": 3, "action": "reject", "reason": "duplicate"}
    saved = tmp_path / "saved.json"
    document = {"schema_version": 1, "title": "t", "fingerprint": None, "model": 0, "records": [old, undo, reject]}
    saved.write_text(json.dumps(document), encoding="utf-8")
    apply_records(folder, read_review(saved))
    apply_records(folder, read_review(saved))
    found = reviewed_result(folder)
    assert len(found.records) == 3
    assert (found.reviewed.findings[0].review.state, found.reviewed.findings[0].review.reason) == (
        "rejected",
        "duplicate",
    )


@pytest.mark.parametrize(
    ("change", "where"),
    [
        ({"action": "explode"}, "action"),
        ({"action": "reject", "reason": "because"}, "reason"),
        ({"action": "note", "value": "x" * 2001}, "value"),
        ({"action": "note", "value": "a\0b"}, "value"),
        ({"action": "note", "value": "\ud800"}, "value"),
        ({"action": "relabel", "value": "  "}, "value"),
        ({"action": "move", "value": {"point": [0, 0, float("inf")]}}, "value.point"),
        ({"action": "move", "value": {"point": [0, 0, True]}}, "value.point"),
        ({"action": "add", "value": {"label": "x", "frame": -1, "box": [0, 0, 1, 1]}}, "value.frame"),
        ({"action": "add", "value": {"label": "x", "frame": 1, "box": [0.5, 0, 0.5, 1]}}, "value.box"),
        ({"action": "add", "value": {"label": "x", "frame": 1, "box": [0, 0, 1, 2]}}, "value.box"),
        ({"action": "split", "value": {"detections": []}}, "value.detections"),
        ({"action": "split", "value": {"detections": [1, "2"]}}, "value.detections"),
        ({"action": "merge", "value": {"kind": "defect", "id": "1", "label": "x"}}, "value.id"),
        ({"action": "measure", "value": {"length": -1, "unit": "mm", "points": [[0, 0, 0], [0, 0, 1]]}}, "length"),
        ({"target": {"kind": "defect", "id": 2**31, "label": "x"}}, "target.id"),
        ({"target": {"kind": "person", "id": 1, "label": "x"}}, "target.kind"),
        ({"target": {"kind": "added", "id": "a b", "label": "x"}}, "target.id"),
        ({"id": "../../etc"}, "id"),
        ({"extra": 1}, "extra"),
        ({"revision": 0}, "revision"),
    ],
)
def test_what_is_no_record_is_refused_by_its_member(folder: Path, change: dict[str, Any], where: str) -> None:
    with pytest.raises(BadInput, match=r".") as caught:
        ReviewRecord.parse({**record(folder, "a"), **change}, "record")
    assert caught.value.code == "bad_review"
    assert where in f"{caught.value.where} {caught.value.message}"


@pytest.mark.parametrize("text", ["", "[]", "{", "[" * 100_000, '{"schema_version": 3, "records": []}', "null"])
def test_what_is_no_review_is_refused(tmp_path: Path, text: str) -> None:
    path = tmp_path / "review.json"
    path.write_text(text, encoding="utf-8")
    with pytest.raises(BadInput):
        read_review(path)


def test_a_document_comes_back(folder: Path, tmp_path: Path) -> None:
    records = parsed(record(folder, "a"), record(folder, "b", "set_blade", value=""))
    path = tmp_path / "review.json"
    path.write_text(json.dumps(review_document(records)), encoding="utf-8")
    assert read_review(path) == records


def test_a_folder_that_is_no_result_is_said(tmp_path: Path) -> None:
    with pytest.raises(BadInput, match="finished result"):
        reviewed_result(tmp_path)


def test_two_who_add_at_once_lose_nothing(folder: Path) -> None:
    apply_records(folder, parsed(record(folder, "a")))
    other = threading.Thread(target=lambda: apply_records(folder, parsed(record(folder, "c"))))
    with FileLock(folder / LOCK):
        other.start()
        other.join(0.3)
        assert other.is_alive(), "it waits for who adds"
        both = [*parsed(record(folder, "a")), *parsed(record(folder, "b"), record(folder, "b"))[1:]]
        (folder / REVIEW).write_text(json.dumps(review_document(both)), encoding="utf-8")
    other.join(10)
    assert [one.id for one in reviewed_result(folder).records] == ["a", "b", "c"]
