"""Columns of the published tables: declared once; files, database, HTTP interface and documentation agree with them."""

from __future__ import annotations

import csv
import json
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import pytest
from sqlalchemy import Double, Integer, String
from sqlalchemy.orm import Mapped, mapped_column

from core.flags import Verdict
from core.report.build import build_report, write_tables
from core.scene.case import CaseRow
from core.scene.columns import Column, columns_of
from core.scene.defect import EventRow
from core.scene.detection import DetectionRow
from core.scene.frame import FrameRow
from scripts import reference_pages
from store.columns import Base, with_columns_of
from store.tables import CASES, DETECTIONS, TIMELINE, Table
from tests.core.making_record import full_record

DECLARED: Mapping[str, type] = {
    "frames": FrameRow,
    "cases": CaseRow,
    "mapping/detections": DetectionRow,
    "mapping/timeline": EventRow,
}
"""Rows of each published table, by its file without the suffix."""
STORED = [(CASES, CaseRow), (DETECTIONS, DetectionRow), (TIMELINE, EventRow)]
SCHEMAS = [("Case", *STORED[0]), ("Detection", *STORED[1]), ("Event", *STORED[2])]
OUTPUTS = (Path(__file__).parents[1] / "docs" / "outputs.md").read_text(encoding="utf-8")
JSON_TYPES = {int: "integer", float: "number", str: "string"}


def documented(columns: tuple[Column, ...]) -> str:
    """The table of the page: one line for each column."""
    rows = [(f"`{column.name}`", column.kind_in_words, column.meaning) for column in columns]
    return reference_pages.table(("column", "type", "meaning"), rows)


@pytest.mark.parametrize("name", DECLARED)
def test_every_column_is_explained_in_a_sentence_on_the_page(name: str) -> None:
    columns = columns_of(DECLARED[name])
    assert all(column.meaning.endswith(".") for column in columns)
    expected = documented(columns)
    assert expected in OUTPUTS, f"docs/outputs.md needs this table:\n{expected}"


def test_the_files_have_the_declared_columns(tmp_path: Path) -> None:
    write_tables(build_report(full_record()), tmp_path)
    for name, declared in DECLARED.items():
        names = [column.name for column in columns_of(declared)]
        with (tmp_path / f"{name}.csv").open(newline="", encoding="utf-8") as stream:
            assert next(csv.reader(stream)) == names
        if name != "frames":
            rows = json.loads((tmp_path / f"{name}.json").read_text(encoding="utf-8"))
            assert all(list(row) == names for row in rows)


@pytest.mark.parametrize(("table", "declared"), STORED, ids=lambda one: getattr(one, "name", ""))
def test_the_database_has_the_declared_columns(table: Table, declared: type) -> None:
    columns = {column.name: column for column in columns_of(declared)}
    stored = {c.name: c for c in table.model.__table__.columns if c.name not in ("inspection_id", "task_key")}
    assert stored.keys() == columns.keys()
    assert table.columns == tuple(columns)
    for name, column in columns.items():
        assert stored[name].type.python_type is column.kind, name
        known_when_stored = name == "seconds"  # a row is written when its case has ended
        assert stored[name].nullable or not column.nullable or known_when_stored, (
            f"{name} may be empty, and the database refuses that"
        )


@pytest.fixture(scope="module")
def schemas() -> dict[str, Any]:
    found: dict[str, Any] = reference_pages.openapi_document()["components"]["schemas"]
    return found


@pytest.mark.parametrize(("name", "table", "declared"), SCHEMAS, ids=lambda one: one if isinstance(one, str) else "")
def test_the_interface_describes_the_declared_columns(
    schemas: dict[str, Any], name: str, table: Table, declared: type
) -> None:
    columns, shown = columns_of(declared), schemas[name]["properties"]
    names = [column.name for column in columns]
    assert list(shown) == schemas[name]["required"] == names
    missing = set(names) ^ set(schemas[name]["example"])
    assert missing <= {column.name for column in columns if column.nullable}, "FastAPI leaves out what is null"
    for column in columns:
        kinds = {one["type"] for one in shown[column.name].get("anyOf", [shown[column.name]])}
        nullable = table.model.__table__.columns[column.name].nullable
        assert kinds == {JSON_TYPES[column.kind], *(["null"] if nullable else [])}, column.name
        assert shown[column.name]["description"] == column.meaning


@dataclass(frozen=True)
class Widened:
    """A table with a column more than its class names."""

    id: int
    """Number."""
    verdict: Verdict | None
    """An enumeration,
    explained over two lines."""
    share: float
    """Share."""
    size: int
    unexplained: str


def test_a_new_column_is_in_the_database_without_being_written_again() -> None:
    @with_columns_of(Widened, also_null=("size",))
    class WidenedTable(Base):
        __tablename__ = "widened_for_a_test"
        id: Mapped[int] = mapped_column(primary_key=True)

    try:
        made = WidenedTable.__table__.columns
        kinds = {"id": Integer, "verdict": String, "share": Double, "size": Integer, "unexplained": String}
        assert {name: type(made[name].type) for name in kinds} == kinds
        assert [made[name].nullable for name in kinds] == [False, True, False, True, False]
    finally:
        Base.metadata.remove(Base.metadata.tables["widened_for_a_test"])


def test_columns_are_read_from_the_class() -> None:
    columns = columns_of(Widened)
    assert columns[1] == Column("verdict", str, True, "An enumeration, explained over two lines.")
    assert columns[4].meaning == ""
    assert "| `verdict` | text or empty | An enumeration, explained over two lines. |\n" in documented(columns)


@dataclass(frozen=True)
class Longer(Widened):
    """A table that begins with the columns of another."""

    name: str
    """Name."""


def test_the_columns_of_a_base_class_come_first() -> None:
    assert columns_of(Longer) == (*columns_of(Widened), Column("name", str, False, "Name."))


def test_a_column_that_no_table_can_hold_is_refused() -> None:
    @dataclass
    class Nested:
        places: list[float]

    with pytest.raises(TypeError, match="column places"):
        columns_of(Nested)
