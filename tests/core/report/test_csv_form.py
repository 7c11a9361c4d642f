"""CSV that a spreadsheet opens without running it, and that gives back every text."""

from __future__ import annotations

import csv
import io
from dataclasses import replace
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from core.io.annotations import read_detections
from core.json_files import read_json
from core.report.build import build_report, write_tables
from core.report.csv_form import csv_line, escaped, read_csv, unescaped
from core.scene.detection import Detection
from core.settings import make_settings
from core.stage import StageTask
from core.stages import annotations as annotations_stage
from core.stages import probe
from core.thesis.grouping import cluster_detections, event_rows, with_defect_ids
from core.videos import Recording
from tests.core.making_record import full_record
from tests.core.making_rows import mapped
from tests.labels import LABELS, SAMPLE

NASTY = (*"=+-@\t\r", "=1+1", "'=1+1", "''-2", "'", "'quoted'", "'''", "", "a=1", "\n=1", "-3.5", "\0", "a\0b")


@pytest.mark.parametrize("text", ["=1+1", "+1", "-2+3", "@SUM(1)", "\t=1", "\r=1", "-"])
def test_a_text_that_would_run_gets_an_apostrophe(text: str) -> None:
    assert escaped(text) == f"'{text}"


@pytest.mark.parametrize("text", ["dent", "a=1", "'quoted'", "'", "", " =1", "<script>"])
def test_any_other_text_stays_as_it_is(text: str) -> None:
    assert escaped(text) == text == unescaped(text)


@given(st.text() | st.text("'=+-@\t\r\n a", max_size=6) | st.sampled_from(NASTY))
def test_every_text_comes_back_and_none_runs(text: str) -> None:
    cell = escaped(text)
    assert unescaped(cell) == text
    assert cell[:1] not in tuple("=+-@\t\r")


@given(st.lists(st.text(st.characters(exclude_categories=["Cs"])) | st.sampled_from(NASTY), min_size=2, max_size=4))
def test_a_record_is_read_back_by_a_strict_reader(texts: list[str]) -> None:
    line = csv_line(texts)
    assert line.endswith("\r\n")
    (read,) = csv.reader(io.StringIO(line, newline=""), strict=True)
    assert [unescaped(cell) for cell in read] == texts


def test_numbers_are_no_text() -> None:
    assert csv_line([-3.5, -2, True, None, 1e-7, "-3.5"]) == "-3.5,-2,1,,1e-07,'-3.5\r\n"
    assert unescaped("-3.5") == "-3.5"
    with pytest.raises(ValueError, match="finite"):
        csv_line([float("nan")])


@pytest.fixture(scope="module")
def detections(tmp_path_factory: pytest.TempPathFactory) -> list[Detection]:
    """What the stages make of the labels."""
    root = tmp_path_factory.mktemp("stages")
    folders: dict[str, Path] = {}
    for key, run in (("probe", probe.run), ("annotations", annotations_stage.run)):
        (root / key).mkdir()
        run(StageTask(key, {}, make_settings(), dict(folders), {}, (Recording(SAMPLE, LABELS),), root / key))
        folders[key] = root / key
    return read_detections(root / "annotations")


def test_every_table_of_a_run_holds_the_exact_labels(tmp_path: Path, detections: list[Detection]) -> None:
    full = full_record()
    rows = [mapped(d.id, (10.0 * d.id, 0, 0), d.time_s, d.label, frame=d.id) for d in detections]
    clusters = cluster_detections(rows, 1.0)
    tables = replace(
        full.tables,
        detections=detections,
        mapped_rows=with_defect_ids(rows, clusters),
        timeline=event_rows(clusters),
    )
    write_tables(build_report(replace(full, tables=tables)), tmp_path)
    exact = {entry["label"] for key in read_json(LABELS).values() for entry in key.get("detections", [])}
    assert {"=1+1|dent", "-2+3", "two\nlines", "\x1b[31mred\x1b[0m"} <= exact
    for name in ("mapping/detections", "mapping/timeline", "cases"):
        data = (tmp_path / f"{name}.csv").read_bytes().decode("utf-8")
        cells = [cell for record in csv.reader(io.StringIO(data, newline=""), strict=True) for cell in record]
        assert not [cell for cell in cells if cell.startswith(tuple("=+-@\t\r")) and not _is_number(cell)]
        shown = [
            {k: "" if v is None else str(v) for k, v in row.items()} for row in read_json(tmp_path / f"{name}.json")
        ]
        assert list(read_csv(tmp_path / f"{name}.csv")) == shown
        if name != "cases":
            assert {row["label"] for row in shown} == exact


def _is_number(cell: str) -> bool:
    try:
        float(cell)
    except ValueError:
        return False
    return True
