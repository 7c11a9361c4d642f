from __future__ import annotations

import csv
import json
from pathlib import Path

import pytest

from core.json_files import write_json
from core.report.tables import write_csv


def test_csv_is_rfc_4180(tmp_path: Path) -> None:
    rows: list[dict[str, object]] = [
        {"name": 'say "hi", now', "value": 0.1, "flag": True},
        {"name": "two\nlines", "value": None, "flag": False},
        {"name": "ü", "value": 1e-7, "flag": 3},
    ]
    write_csv(tmp_path / "t.csv", ("name", "value", "flag"), rows)
    raw = (tmp_path / "t.csv").read_bytes()
    assert raw.startswith(b'name,value,flag\r\n"say ""hi"", now",0.1,1\r\n')
    assert "ü,1e-07,3\r\n".encode() in raw
    with (tmp_path / "t.csv").open(encoding="utf-8", newline="") as stream:
        read = list(csv.reader(stream))
    assert read[2] == ["two\nlines", "", "0"]


@pytest.mark.parametrize("value", [float("nan"), float("inf"), float("-inf")])
def test_numbers_must_be_finite(tmp_path: Path, value: float) -> None:
    with pytest.raises(ValueError):
        write_csv(tmp_path / "t.csv", ("a",), [{"a": value}])
    with pytest.raises(ValueError):
        write_json(tmp_path / "t.json", {"a": [value]})


def test_a_row_without_a_column_is_refused(tmp_path: Path) -> None:
    with pytest.raises(ValueError, match="b"):
        write_csv(tmp_path / "t.csv", ("a", "b"), [{"a": 1}])


def test_json_keeps_order_and_text(tmp_path: Path) -> None:
    write_json(tmp_path / "deep" / "t.json", {"b": "ü", "a": 0.1})
    text = (tmp_path / "deep" / "t.json").read_text(encoding="utf-8")
    assert "ü" in text
    assert list(json.loads(text)) == ["b", "a"]
