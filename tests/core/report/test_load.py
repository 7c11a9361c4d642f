from __future__ import annotations

from pathlib import Path

from core.json_files import write_json
from core.report.load import load_tables


def test_reads_what_is_there(tmp_path: Path) -> None:
    write_json(tmp_path / "a" / "detections.json", [{"id": 0}])
    write_json(tmp_path / "m" / "detections.json", [{"id": 0, "outcome": "mapped"}])
    tables = load_tables({"annotations": tmp_path / "a", "map_defects": tmp_path / "m"})
    assert tables.detections == [{"id": 0}]
    assert tables.mapped_rows == [{"id": 0, "outcome": "mapped"}]
    assert list(tables.timeline) == []


def test_rows_with_defects_win_over_those_without(tmp_path: Path) -> None:
    write_json(tmp_path / "m" / "detections.json", [{"id": 0, "defect_id": None}])
    write_json(tmp_path / "t" / "detections.json", [{"id": 0, "defect_id": 4}])
    tables = load_tables({"timeline": tmp_path / "t", "map_defects": tmp_path / "m"})
    assert tables.mapped_rows == [{"id": 0, "defect_id": 4}]


def test_mapping_that_was_not_reached_is_told_from_one_without_detections(tmp_path: Path) -> None:
    assert load_tables({}).mapped_rows is None
    write_json(tmp_path / "m" / "detections.json", [])
    assert load_tables({"map_defects": tmp_path / "m"}).mapped_rows == []
