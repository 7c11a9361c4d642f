from __future__ import annotations

from dataclasses import replace
from pathlib import Path

from core.io.annotations import write_annotations, write_rows
from core.report.load import load_tables
from core.scene.frame import SourceFrame
from tests.core.making_rows import detection, mapped


def folder(tmp_path: Path, name: str) -> Path:
    made = tmp_path / name
    made.mkdir()
    return made


def test_reads_what_is_there(tmp_path: Path) -> None:
    read, placed = folder(tmp_path, "a"), folder(tmp_path, "m")
    write_annotations(read, [detection()], {}, [SourceFrame(0, 10)])
    write_rows(placed, [mapped(0, (1.0, 2.0, 3.0))])
    tables = load_tables({"annotations": read, "map_defects": placed})
    assert tables.detections == [detection()]
    assert tables.mapped_rows == [mapped(0, (1.0, 2.0, 3.0))]
    assert list(tables.timeline) == []


def test_rows_with_defects_win_over_those_without(tmp_path: Path) -> None:
    placed, grouped = folder(tmp_path, "m"), folder(tmp_path, "t")
    row = mapped(0, (1.0, 2.0, 3.0))
    write_rows(placed, [row])
    write_rows(grouped, [replace(row, defect_id=4)])
    tables = load_tables({"timeline": grouped, "map_defects": placed})
    assert tables.mapped_rows == [replace(row, defect_id=4)]


def test_mapping_that_was_not_reached_is_told_from_one_without_detections(tmp_path: Path) -> None:
    assert load_tables({}).mapped_rows is None
    placed = folder(tmp_path, "m")
    write_rows(placed, [])
    assert load_tables({"map_defects": placed}).mapped_rows == []
